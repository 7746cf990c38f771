//! `ptu faults list`: the faults of the history that fit a filter.

use clap::Args;
use fault_db::{FaultFilter, FaultSummary, Store};

use super::filter::FilterArguments;
use crate::cli::output::Output;
use crate::cli::{at_least_one, print_out};
use ptu_report::words::{Words, fill};
use ptu_report::{FAULT_KEYS, fault_json};
use ptu_runs::clock::local;
use ptu_runs::failure::{Exit, Failure};
use ptu_runs::stdio;
use ptu_runs::table::Table;

/// List faults, last seen first
///
/// Examples:
///   ptu faults list --state open
///   ptu faults list --serial-no SG-0142 --when 2026-03..2026-05
///   ptu faults list --note 교체 --part eb_relay
///   ptu faults list --cause eb_relay --state open,repaired
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct ListArguments {
    #[command(flatten)]
    filter: FilterArguments,
    /// At most N faults
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = at_least_one())]
    limit: u32,
    #[command(flatten)]
    output: Output,
}

impl ListArguments {
    pub fn list(&self, store: &Store) -> Result<Exit, Failure> {
        let filter = FaultFilter {
            // One fault more than asked for tells whether there are more.
            limit: Some(self.limit.saturating_add(1)),
            ..self.filter.filter(store)?
        };
        let mut faults = store.faults(&filter)?;
        let more = faults.len() > self.limit as usize;
        faults.truncate(self.limit as usize);
        self.output.save()?;
        if faults.is_empty() {
            let said = self.filter.nothing(store)?;
            if self.output.form.is_table() {
                return print_out(&said);
            }
        }
        if more && !self.output.form.is_table() {
            let said = Words::shown().terminal.first_n;
            stdio::note(&fill(said, &[("n", &self.limit)]));
        }
        let rows: Vec<_> = faults.iter().map(fault_json).collect();
        self.output.form.print_columns(&FAULT_KEYS, &rows, || {
            let table = table(&faults);
            match more {
                true => format!("{table}\n{}", Words::shown().terminal.and_more),
                false => table,
            }
        })
    }
}

fn table(faults: &[FaultSummary]) -> String {
    let words = Words::shown();
    let (common, terminal) = (&words.common, &words.terminal);
    let headings = [
        common.fault,
        words.faults.last_seen,
        common.unit,
        common.code,
        common.part,
        words.faults.cause,
        common.severity,
        common.state,
        words.faults.seen,
        terminal.trace,
    ];
    let mut table = Table::headed(&headings).right([8]).parts([4, 5]);
    for fault in faults {
        table.row([
            fault.id.short(),
            local(fault.last_at_us),
            fault.unit_serial.clone(),
            format!("{} {}", fault.code, fault.code_name),
            fault.lru.clone(),
            fault.cause().to_owned(),
            words.severity_name(&fault.severity).to_owned(),
            words.fault_state(fault.state).to_owned(),
            fault.occurrences.to_string(),
            fault.trace_id.map_or_else(String::new, |id| id.short()),
        ]);
    }
    table.render()
}
