//! Faults that a passed run has settled, as it proves their repair.

use fault_db::{RepairRecord, SettledFault};

use super::Sheet;
use super::block::{Block, Row, Table};
use crate::naming;
use crate::words::Words;

/// The faults whose repair the run has proved.
pub fn settled(sheet: &Sheet, words: &Words) -> Vec<Block> {
    let (common, report) = (&words.common, &words.report);
    if sheet.run.settled.is_empty() {
        return Vec::new();
    }
    let row = |fault: &SettledFault| {
        let repair = fault.repair.as_ref();
        let part = repair.map_or(&fault.lru, |repair| &repair.part);
        let serial = |of: fn(&RepairRecord) -> &Option<String>| {
            repair
                .and_then(|repair| of(repair).clone())
                .unwrap_or("–".into())
        };
        let cells = [
            fault.id.short(),
            naming::code(fault.code, &fault.code_name, words),
            sheet.part(part, words),
            serial(|repair| &repair.serial_old),
            serial(|repair| &repair.serial_new),
        ];
        Row::words(cells)
    };
    let columns = [
        (common.fault, 0.12),
        (common.code, 0.24),
        (common.part, 0.26),
        (words.faults.serial_old, 0.19),
        (words.faults.serial_new, 0.19),
    ];
    vec![
        Block::Heading(report.settled.into()),
        Block::Table(Table::of_words(columns, sheet.run.settled.iter().map(row))),
    ]
}
