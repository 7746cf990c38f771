//! Stores runs of a unit's record that are new to the history, as a run without a verdict.

use fault_db::{RunWriter, StepRecord, Store, StoreError, Verdict};
use protocol::message::Mode;
use protocol::signal::Signal;

use super::{RecordedRun, Rest, recorded_runs};
use crate::failure::{Failure, FieldTrouble};
use crate::unit_log::{Source, UnitReading, run_record};

/// Result of storing the runs of a record.
#[derive(Clone, Debug, Default)]
pub struct Pulled {
    /// The run they are stored as; none when nothing is new.
    pub run: Option<fault_db::Id>,
    /// New runs, in order.
    pub new: Vec<RecordedRun>,
    /// Number of runs that were stored before.
    pub known: usize,
}

/// Stores what is new of `runs`: a trace for each, and a step that names it.
///
/// # Errors
/// The database fails; what was stored stays, and the next pull adds the rest.
pub fn pull(store: &Store, source: &Source, runs: Vec<RecordedRun>) -> Result<Pulled, StoreError> {
    let mut pulled = Pulled::default();
    for run in runs {
        if store.has_trace(run.id)? {
            pulled.known += 1;
        } else {
            pulled.new.push(run);
        }
    }
    if pulled.new.is_empty() {
        return Ok(pulled);
    }
    let mut writer = RunWriter::begin(store, &run_record(source))?;
    for (index, run) in (0..).zip(&mut pulled.new) {
        if run.date.is_none() {
            // The run is not later than the reading.
            run.trace.t0_us = source.from_us;
        }
        writer.recorded_trace(run.id, &run.trace)?;
        writer.step(step(index, run))?;
    }
    // Nothing was judged.
    writer.finish(&source.end(Verdict::Skipped))?;
    pulled.run = Some(writer.id());
    Ok(pulled)
}

/// Stores what is new of a reading.
///
/// # Errors
/// The unit has no stored memory, or the database fails.
pub fn pull_reading(store: &Store, reading: &UnitReading) -> Result<Pulled, Failure> {
    let Some(stored) = &reading.read.stored else {
        return Err(Failure::bench(FieldTrouble::NoMemory));
    };
    let rest = match (reading.source.broken_off, reading.read.mode) {
        (true, _) => Rest::Unread,
        (false, Some(Mode::AutomaticRun)) => Rest::OfUnit,
        (false, _) => Rest::Nothing,
    };
    let runs = recorded_runs(&reading.source.serial, stored, rest);
    Ok(pull(store, &reading.source, runs)?)
}

fn step(index: u32, run: &RecordedRun) -> StepRecord {
    let rows = run.trace.rows() as i64;
    StepRecord {
        verdict: Verdict::Skipped,
        started_bench_us: i64::from(run.at_ms) * 1000,
        bench_time_us: rows * run.trace.period_us,
        message: format!("trace {}: {}", run.id.short(), run.summary()),
        ..StepRecord::passed(index, "record", run.name())
    }
}

impl RecordedRun {
    /// Power-up and run.
    pub fn name(&self) -> String {
        format!("power-up {}, run {}", self.power_up, self.run)
    }

    /// Time, distance and limits of the run, in one line.
    pub fn summary(&self) -> String {
        let trace = &self.trace;
        let known = |signal: Signal| {
            let column = trace.column(signal.definition().name).unwrap_or_default();
            column.iter().copied().filter(|value| !value.is_nan())
        };
        let seconds = trace.rows() as f64 * trace.period_us as f64 / 1e6;
        let end_m = known(Signal::Position).next_back().unwrap_or(0.0);
        let most_kmh = known(Signal::Speed).fold(0.0, f64::max);
        let mut text = format!("{seconds:.1} s, to {end_m:.2} m, at most {most_kmh:.1} km/h");
        if self.is_cut {
            text += "; its beginning was overwritten";
        }
        if trace.gaps {
            text += "; rows are missing";
        }
        if trace.partial {
            text += "; what follows a stand of more than 30 min is left out";
        }
        if self.date.is_none() {
            text += &format!(
                "; not dated: {:.1} s after power-up, when the unit had not been given the time",
                f64::from(self.at_ms) / 1000.0
            );
        }
        text
    }
}
