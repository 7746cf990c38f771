//! `ptu faults import`: a unit's own event log.

use clap::Args;
use fault_db::{FaultRecord, Store, limits};
use protocol::Instant;
use protocol::message::Identity;
use serde_json::{Value, json};

use crate::cli::{ScriptsOption, print_json, print_out, since_argument};
use ptu_bench::clock::{local, now_us, rfc3339};
use ptu_bench::failure::{Exit, Failure};
use ptu_bench::field::{
    Imported, JudgedLog, LogRead, Source, against_history, import, judge, read_log,
};
use ptu_bench::link::{Endpoint, WireLink};
use ptu_bench::run::unit_text;
use ptu_bench::stop::Stop;
use ptu_bench::table::Table;

/// Read a unit's own event log: what is new in it becomes faults, stored as a run without steps
///
/// The unit is asked for its log, over all power-ups, and told the time: it is given no input and no
/// stimulus, and nothing is armed. What it logged in runs of this history, armed for a tester, or because
/// nothing is connected to it any more is no fault. Entries are dated by the times the unit was told; those
/// of a power-up in which nobody told it have the power-up and the time since then, and a date that they are
/// not later than. An older unit keeps the log of its present power-up alone.
///
/// Examples:
///   ptu faults import --unit serial:/dev/ttyUSB0
///   ptu faults import --unit tcp:127.0.0.1:7000 --since 7d && ptu diagnose latest
///
/// Exit codes: 0 read, whether or not it holds faults; 2 wrong command; 3 no unit, another unit, or the
/// link was lost, what was read is kept.
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct ImportArguments {
    /// The unit: serial:PATH[@BAUD] or tcp:HOST:PORT
    #[arg(long, value_name = "UNIT")]
    unit: Endpoint,
    /// Serial number expected of it
    #[arg(long, value_name = "TEXT")]
    serial_no: Option<String>,
    /// Unit configuration it has, units/NAME.toml
    #[arg(long, value_name = "NAME", default_value = "sg100")]
    unit_config: String,
    /// Line it has, lines/NAME.toml
    #[arg(long, value_name = "NAME", default_value = "line8")]
    line: String,
    /// Train the unit is in, as the depot names it
    #[arg(long, value_name = "TEXT", default_value = "")]
    train_no: String,
    /// Who reads
    #[arg(long, value_name = "TEXT", default_value = "")]
    operator: String,
    /// Only what is dated since: 30d, 12h, 2026-03, 2026-03-21
    #[arg(long, value_name = "TIME", value_parser = since_argument, allow_hyphen_values = true)]
    since: Option<i64>,
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    scripts: ScriptsOption,
}

/// A log and what became of it.
struct Outcome {
    read: LogRead,
    judged: JudgedLog,
    source: Source,
    imported: Imported,
    warnings: Vec<String>,
}

impl ImportArguments {
    /// Reads, judges, stores and tells.
    pub fn import(self, store: Store) -> Result<Exit, Failure> {
        let undatable = match &self.unit {
            Endpoint::Sim => Some("the embedded unit keeps no log from run to run"),
            Endpoint::LockStep(_) => {
                Some("the clock of a unit in lock step stands between scans, which dates no entry")
            }
            Endpoint::Serial { .. } | Endpoint::Tcp(_) => None,
        };
        if let Some(why) = undatable {
            return Err(Failure::usage(format!(
                "{why}; name a unit on a port with --unit serial:PATH or tcp:HOST:PORT"
            )));
        }
        let outcome = self.outcome(&store)?;
        store.close()?;
        let told = match self.json {
            true => print_json(&outcome.json()),
            false => print_out(&outcome.text()),
        };
        match &outcome.read.broken_off {
            None => told,
            Some(why) => Err(Failure::bench(format!(
                "{why}; the log was not read to its end, what was read is kept; read it again"
            ))),
        }
    }

    fn outcome(&self, store: &Store) -> Result<Outcome, Failure> {
        limits::name("the operator's name", &self.operator)?;
        limits::name("the train's name", &self.train_no)?;
        let directory = self.scripts.find()?;
        let config = directory.unit_config(&self.unit_config)?;
        let line = directory.line(&self.line)?;
        let stop = Stop::default();
        stop.listen();
        let from_us = now_us();
        let mut link = WireLink::open(&self.unit)?;
        let read = read_log(
            &mut link,
            Instant::ZERO,
            false,
            &mut self.unit.pace(1),
            &stop,
            &now_us,
        );
        let read = read.map_err(|why| Failure::bench(format!("{}: {why}", self.unit)))?;
        let identity = &read.identity;
        let serial = unit_text::serial(identity);
        if let Some(expected) = self.serial_no.as_ref().filter(|e| **e != serial) {
            return Err(Failure::bench(format!(
                "the unit on {} is {serial}, not {expected}; check the port or leave --serial-no out",
                self.unit
            )));
        }
        let mut warnings = Vec::new();
        if identity.tdb_crc != line.crc {
            warnings.push(format!(
                "the unit's track database is not that of {}; name its line with --line",
                line.name
            ));
        }
        let same_config = identity.config_crc == config.crc;
        if !same_config {
            warnings.push(format!(
                "the unit's configuration, {}, is not {} as it is here; name its own with --unit-config",
                unit_text::config_name(identity),
                config.name
            ));
        }
        let source = Source {
            endpoint: self.unit.to_string(),
            config_name: unit_text::config_name(identity),
            unit_config_sha256: if same_config {
                config.sha256
            } else {
                String::new()
            },
            line: line.content.name.clone(),
            train: self.train_no.clone(),
            operator: self.operator.clone(),
            from_us,
            until_us: now_us(),
            broken_off: read.broken_off.is_some(),
            serial,
        };
        let tested = store.tested_spans(&source.serial)?;
        let judged = judge(&read.entries, &tested, self.since);
        let before = read.stored.as_ref();
        let before = before.map(|stored| against_history(store, &source.serial, stored));
        let before = before.transpose()?.flatten();
        let imported = import(store, &source, &judged.faults)?;
        warnings.extend(of_reading(&read));
        if let Some(stored) = &read.stored {
            warnings.extend(before);
            warnings.extend(stored.notes.iter().cloned());
        }
        Ok(Outcome {
            read,
            judged,
            source,
            imported,
            warnings,
        })
    }
}

/// What a reader of the log should know of it.
fn of_reading(read: &LogRead) -> Vec<String> {
    let mut warnings = Vec::new();
    if read.overwritten > 0 {
        warnings.push(format!(
            "{} entries were overwritten or cleared in the unit before they could be read",
            read.overwritten
        ));
    }
    let undated = read.entries.iter().filter(|entry| entry.at_us.is_none());
    let undated = undated.count();
    if undated > 0 && read.stored.is_some() {
        warnings.push(format!(
            "{undated} entries are of power-ups in which nobody told the unit the time: they have the power-up and \
             the time since then, and stand under the date that they are not later than"
        ));
    } else if undated > 0 {
        warnings.push(format!(
            "{undated} entries are of an earlier power-up, which nothing dates: they stand under the \
             time of reading"
        ));
    }
    if read.stored.is_none() {
        warnings.push(
            "this unit has no stored log: it was read as far as it is kept since power-up"
                .to_owned(),
        );
    }
    if read.restarts > 0 {
        warnings.push("the unit was started again while its log was read".to_owned());
    }
    warnings
}

impl Outcome {
    fn json(&self) -> Value {
        let Identity { software, .. } = self.read.identity;
        let left_out = self.judged.left_out;
        let faults = self.imported.new.iter().map(|fault| {
            json!({
                "code": fault.code, "name": fault.code_name, "lru": fault.lru,
                "severity": fault.severity, "at": rfc3339(fault.at_us), "message": fault.message,
                "unit_time_s": fault.bench_us as f64 / 1e6, "freeze_frame": fault.freeze,
            })
        });
        json!({
            "unit_serial": self.source.serial,
            "unit_config": self.source.config_name,
            "software": software.map(|part| part.to_string()).join("."),
            "source": self.source.endpoint,
            "run_id": self.imported.run.map(|id| id.to_string()),
            "complete": self.read.broken_off.is_none(),
            "entries": self.read.entries.len(),
            "imported": self.imported.new.len(),
            "known": self.imported.known,
            "left_out": {
                "information": left_out.information, "too_old": left_out.too_old,
                "under_test": left_out.under_test, "tester": left_out.tester, "alone": left_out.alone,
                "line": left_out.line,
            },
            "overwritten": self.read.overwritten,
            "not_stored": self.read.not_kept,
            "restarts": self.read.restarts,
            "power_ups": self.read.stored.as_ref().map(|stored| stored.power_up),
            "damaged": self.read.stored.as_ref().map(|stored| stored.damaged),
            "faults": faults.collect::<Vec<_>>(),
            "warnings": self.warnings,
        })
    }

    fn text(&self) -> String {
        let mut lines = vec![format!(
            "unit {} on {}, {} log entries read",
            self.source.serial,
            self.source.endpoint,
            self.read.entries.len()
        )];
        if self.read.not_kept > 0 {
            lines.push(format!(
                "and {} more entries, not stored",
                self.read.not_kept
            ));
        }
        match self.imported.run {
            Some(run) => {
                lines.push(format!(
                    "{} faults imported as run {}; `ptu diagnose {}` says what they come to",
                    self.imported.new.len(),
                    run.short(),
                    run.short()
                ));
                lines.push(format!("\n{}\n", table(&self.imported.new)));
            }
            None => lines.push("nothing new".to_owned()),
        }
        let left_out = self.judged.left_out;
        let reasons = [
            (self.imported.known as u32, "known already"),
            (left_out.information, "information only"),
            (left_out.too_old, "before the time asked for"),
            (
                left_out.under_test,
                "of runs in this history, which judged them",
            ),
            (
                left_out.tester,
                "of a tester: made while it had the unit armed, or its own line",
            ),
            (left_out.alone, "silence of a unit with nothing connected"),
            (
                left_out.line,
                "of a bad line: frames of several partners refused at once, and their silence",
            ),
        ];
        let told = reasons.iter().filter(|(count, _)| *count > 0);
        lines.extend(told.map(|(count, reason)| format!("left out: {count} {reason}")));
        lines.extend(
            self.warnings
                .iter()
                .map(|warning| format!("note: {warning}")),
        );
        lines.join("\n")
    }
}

fn table(faults: &[FaultRecord]) -> String {
    let mut table = Table::new(&["DATE", "CODE", "PART", "SEVERITY", "WHAT"]);
    for fault in faults {
        table.row([
            local(fault.at_us),
            format!("{} {}", fault.code, fault.code_name),
            fault.lru.clone(),
            fault.severity.clone(),
            fault.message.clone(),
        ]);
    }
    table.render()
}
