//! `ptu record pull`: makes traces of a unit's stored run record.

use clap::Args;
use fault_db::Store;
use serde_json::{Value, json};

use crate::cli::faults::read_of;
use crate::cli::unit_option::UnitOption;
use crate::cli::{Json, ScriptsOption};
use ptu_report::words::{Words, fill};
use ptu_runs::clock::rfc3339;
use ptu_runs::failure::{Exit, Failure};
use ptu_runs::record::{Pulled, RecordedRun, pull_reading};
use ptu_runs::stop::Stop;
use ptu_runs::unit_log::UnitReading;

/// Read a unit's stored record of automatic runs: each run that is new becomes a trace
///
/// The unit is asked for its record and its log, and is sent the time. It gets no input and no stimulus, and is not
/// armed. A run that is under way is left for the next pull. `ptu trace show ID` shows a trace,
/// `ptu record compare ID` compares it with a sound unit's run.
///
/// Examples:
///   ptu record pull --unit serial:/dev/ttyUSB0
///   ptu record pull --unit tcp:127.0.0.1:7000 && ptu record compare latest
///
/// Exit codes: 0 read, whether or not there is a new run; 2 wrong command; 3 no unit, another unit, a unit without
/// stored memory, or the link was lost (what was read is kept).
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct PullArguments {
    #[command(flatten)]
    unit: UnitOption,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    scripts: ScriptsOption,
}

impl PullArguments {
    /// Reads the record, stores its new runs as traces, and prints the result.
    pub fn run(self, store: Store) -> Result<Exit, Failure> {
        let stop = Stop::default();
        stop.listen();
        let reading = self.unit.asked().read(&self.scripts.find()?, true, &stop)?;
        let pulled = pull_reading(&store, &reading)?;
        store.close()?;
        let document = || document(&reading, &pulled);
        let told = self.json.answer(document, || text(&reading, &pulled));
        reading.complete()?;
        told
    }
}

fn document(reading: &UnitReading, pulled: &Pulled) -> Value {
    let trace = |run: &RecordedRun| {
        json!({
            "trace_id": run.id.to_string(), "power_up": run.power_up, "run": run.run,
            "at": run.date.map(|(at_us, _)| rfc3339(at_us)),
            "uncertainty_s": run.date.and_then(|(_, us)| us).map(|us| us as f64 / 1e6),
            "unit_time_s": f64::from(run.at_ms) / 1e3, "rows": run.trace.rows(),
            "begins_late": run.is_cut, "gaps": run.trace.gaps,
        })
    };
    json!({
        "unit_serial": reading.source.serial,
        "source": reading.source.endpoint,
        "run_id": pulled.run.map(|id| id.to_string()),
        "complete": reading.read.broken_off.is_none(),
        "rows": reading.read.stored.as_ref().map_or(0, |stored| stored.rows.len()),
        "pulled": pulled.new.len(),
        "known": pulled.known,
        "traces": pulled.new.iter().map(trace).collect::<Vec<_>>(),
        "warnings": reading.warnings,
    })
}

fn text(reading: &UnitReading, pulled: &Pulled) -> String {
    let rows = reading
        .read
        .stored
        .as_ref()
        .map_or(0, |stored| stored.rows.len());
    let counts = &Words::shown().counts;
    let mut lines = vec![read_of(reading, counts.record_read, rows)];
    lines.push(match pulled.run {
        Some(run) => {
            let n = pulled.new.len();
            fill(counts.pulled, &[("n", &n), ("run", &run.short())])
        }
        None => counts.nothing_new.to_owned(),
    });
    lines.extend(
        pulled
            .new
            .iter()
            .map(|run| format!("  {}  {}: {}", run.id.short(), run.name(), run.summary())),
    );
    if pulled.known > 0 {
        let of = [
            ("n", &pulled.known as _),
            ("why", &counts.known_already as _),
        ];
        lines.push(fill(counts.left_out, &of));
    }
    let warnings = reading.warnings.iter();
    lines.extend(warnings.map(|text| fill(counts.remark, &[("text", text)])));
    lines.join("\n")
}
