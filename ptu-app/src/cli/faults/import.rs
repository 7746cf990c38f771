//! `ptu faults import`: a unit's own event log.

use clap::Args;
use fault_db::{FaultRecord, Store};
use protocol::message::Identity;
use serde_json::{Value, json};

use crate::cli::unit_option::UnitOption;
use crate::cli::{Json, ScriptsOption, since_argument};
use ptu_report::words::{Words, fill};
use ptu_runs::clock::{local, rfc3339};
use ptu_runs::failure::{Exit, Failure};
use ptu_runs::stop::Stop;
use ptu_runs::table::Table;
use ptu_runs::unit_log::{ImportedLog, UnitReading};

/// Read a unit's own event log: new entries become faults, stored as a run without steps
///
/// The unit is asked for its log of all power-ups, and is sent the time. It gets no input and no stimulus, and is not
/// armed. Entries are no faults if the unit logged them in runs of this history, while it was armed, or because nothing
/// was connected to it any more. Entries are dated by the times that testers sent to the unit. Entries of a power-up
/// without such a time show the power-up and the time since then; their date is the latest possible. An older unit
/// keeps the log of its present power-up alone.
///
/// Examples:
///   ptu faults import --unit serial:/dev/ttyUSB0
///   ptu faults import --unit tcp:127.0.0.1:7000 --when 7d && ptu diagnose latest
///
/// Exit codes: 0 read, whether or not the log holds faults; 2 wrong command; 3 no unit, another unit, or the link was
/// lost (what was read is kept).
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct ImportArguments {
    #[command(flatten)]
    unit: UnitOption,
    /// Only entries that are not certainly older than: 30d, 12h, 2026-03, 2026-03-21
    #[arg(long, value_name = "SPAN", value_parser = since_argument, allow_hyphen_values = true)]
    when: Option<i64>,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    scripts: ScriptsOption,
}

/// A unit's log, and the faults made of its entries.
struct Outcome {
    reading: UnitReading,
    log: ImportedLog,
}

impl ImportArguments {
    /// Reads the log, judges its entries, stores the faults, and prints the result.
    pub fn import(self, store: Store) -> Result<Exit, Failure> {
        let stop = Stop::default();
        stop.listen();
        let mut reading = self
            .unit
            .asked()
            .read(&self.scripts.find()?, false, &stop)?;
        let log = reading.import(&store, self.when)?;
        store.close()?;
        let outcome = Outcome { reading, log };
        let told = self.json.answer(|| outcome.json(), || outcome.text());
        outcome.reading.complete()?;
        told
    }
}

impl Outcome {
    fn json(&self) -> Value {
        let Identity { software, .. } = self.reading.read.identity;
        let left_out = self.log.judged.left_out;
        let faults = self.log.imported.new.iter().map(|fault| {
            json!({
                "code": fault.code, "name": fault.code_name, "part": fault.lru,
                "severity": fault.severity, "at": rfc3339(fault.at_us), "message": fault.message,
                "unit_time_s": fault.bench_us as f64 / 1e6, "freeze_frame": fault.freeze,
            })
        });
        json!({
            "unit_serial": self.reading.source.serial,
            "unit_config": self.reading.source.config_name,
            "software": software.map(|part| part.to_string()).join("."),
            "source": self.reading.source.endpoint,
            "run_id": self.log.imported.run.map(|id| id.to_string()),
            "complete": self.reading.read.broken_off.is_none(),
            "entries": self.reading.read.entries.len(),
            "imported": self.log.imported.new.len(),
            "known": self.log.imported.known,
            "left_out": {
                "information": left_out.information, "too_old": left_out.too_old,
                "under_test": left_out.under_test, "tester": left_out.tester, "alone": left_out.alone,
                "line": left_out.line,
            },
            "overwritten": self.reading.read.overwritten,
            "not_stored": self.reading.read.not_kept,
            "restarts": self.reading.read.restarts,
            "power_ups": self.reading.read.stored.as_ref().map(|stored| stored.power_up),
            "damaged": self.reading.read.stored.as_ref().map(|stored| stored.damaged),
            "faults": faults.collect::<Vec<_>>(),
            "warnings": self.reading.warnings,
        })
    }

    fn text(&self) -> String {
        let words = Words::shown();
        let counts = &words.counts;
        let n = self.reading.read.entries.len();
        let mut lines = vec![read_of(&self.reading, counts.log_read, n)];
        if self.reading.read.not_kept > 0 {
            let more = self.reading.read.not_kept;
            lines.push(fill(counts.not_kept, &[("n", &more)]));
        }
        match self.log.imported.run {
            Some(run) => {
                let n = self.log.imported.new.len();
                let of = [("n", &n as _), ("run", &run.short() as _)];
                lines.push(fill(counts.imported, &of));
                lines.push(format!("\n{}\n", table(&self.log.imported.new, words)));
            }
            None => lines.push(counts.nothing_new.to_owned()),
        }
        let left_out = self.log.judged.left_out;
        let reasons = [
            (self.log.imported.known as u32, counts.known_already),
            (left_out.information, counts.information),
            (left_out.too_old, counts.too_old),
            (left_out.under_test, counts.under_test),
            (left_out.tester, counts.of_tester),
            (left_out.alone, counts.alone),
            (left_out.line, counts.bad_line),
        ];
        let told = reasons.iter().filter(|(count, _)| *count > 0);
        lines.extend(told.map(|(n, why)| fill(counts.left_out, &[("n", n), ("why", why)])));
        let warnings = self.reading.warnings.iter();
        lines.extend(warnings.map(|text| fill(counts.remark, &[("text", text)])));
        lines.join("\n")
    }
}

/// Text that says how many entries or rows were read of which unit.
pub fn read_of(reading: &UnitReading, wording: &str, n: usize) -> String {
    let (unit, place) = (&reading.source.serial, &reading.source.endpoint);
    fill(wording, &[("unit", unit), ("place", place), ("n", &n)])
}

fn table(faults: &[FaultRecord], words: &Words) -> String {
    let common = &words.common;
    let (date, what) = (words.report.date, words.report.what);
    let mut table =
        Table::headed(&[date, common.code, common.part, common.severity, what]).parts([2]);
    for fault in faults {
        table.row([
            local(fault.at_us),
            format!("{} {}", fault.code, fault.code_name),
            fault.lru.clone(),
            words.severity_name(&fault.severity).to_owned(),
            words.found(&fault.findings, &fault.message).into_owned(),
        ]);
    }
    table.render()
}
