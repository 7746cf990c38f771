//! Reads the content of a test sheet from the database.

use fault_db::{Id, RunDetail, RunOccurrence, StepRecord, Store, StoreError, Verdict};

use super::plots::drawn_channels;
use super::{Sheet, SheetTrace};
use crate::naming::PartNames;
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::failure::Failure;
use ptu_runs::run_diagnosis::diagnose_run;

impl Sheet {
    /// Reads all that the sheet of a run says. Without a fault dictionary there is no diagnosis, and the sheet
    /// says why.
    ///
    /// # Errors
    /// There is no such run, or the database cannot be read.
    pub fn gather(store: &Store, directory: &ScriptsDirectory, id: Id) -> Result<Self, Failure> {
        let run = store.run(id)?;
        let occurrences = store.run_occurrences(id)?;
        let mut all = traces(&run, &occurrences);
        all.extend(of_passed_steps(store, &run)?);
        let more_traces = all.len().saturating_sub(Self::MOST_TRACES);
        let read = |(id, steps, faults): Traced| SheetTrace {
            samples: store
                .trace(id)
                .map(drawn_channels)
                .map_err(|error| Failure::from(error).message),
            id,
            steps,
            faults,
        };
        let diagnosis = diagnose_run(store, directory, id).map_err(|failure| failure.message);
        Ok(Self {
            traces: all.into_iter().take(Self::MOST_TRACES).map(read).collect(),
            more_traces,
            diagnosis,
            parts: PartNames::of(directory),
            run,
        })
    }
}

/// Traces that show no fault: of steps that passed and had failed before a repair. Each is triggered by the end of its step.
fn of_passed_steps(store: &Store, run: &RunDetail) -> Result<Vec<Traced>, StoreError> {
    let mut all = Vec::new();
    for listed in store.traces(run.run.id)? {
        if listed.occurrences > 0 {
            continue;
        }
        let Ok(trace) = store.trace(listed.id) else {
            continue;
        };
        let trigger = i64::from(trace.trigger_row.unwrap_or(0));
        let at_us = trace.t0_bench_us + trigger * trace.period_us;
        let begun = run
            .steps
            .iter()
            .filter(|step| step.started_bench_us < at_us);
        // The row of the trigger is that of the cycle in which the step ended.
        let ended_us = |step: &StepRecord| step.started_bench_us + step.bench_time_us;
        let of_step = begun.filter(|step| ended_us(step) <= at_us);
        let step = of_step.max_by_key(|step| ended_us(step));
        all.push((
            listed.id,
            step.map(|step| step.index).into_iter().collect(),
            Vec::new(),
        ));
    }
    Ok(all)
}

/// A trace, the steps it belongs to and the faults it shows.
type Traced = (Id, Vec<u32>, Vec<String>);

/// Every trace of the run once; those of steps that did not pass come first.
fn traces(run: &RunDetail, occurrences: &[RunOccurrence]) -> Vec<Traced> {
    let mut all: Vec<Traced> = Vec::new();
    for seen in occurrences {
        let Some(id) = seen.trace_id else { continue };
        let place = all.iter().position(|known| known.0 == id);
        let place = place.unwrap_or_else(|| {
            all.push((id, Vec::new(), Vec::new()));
            all.len() - 1
        });
        let (_, steps, faults) = &mut all[place];
        steps.extend(seen.step_index.filter(|step| !steps.contains(step)));
        if !faults.contains(&seen.code_name) {
            faults.push(seen.code_name.clone());
        }
    }
    let of_failure = |traced: &Traced| {
        let mut steps = run
            .steps
            .iter()
            .filter(|step| traced.1.contains(&step.index));
        steps.any(|step| !matches!(step.verdict, Verdict::Passed | Verdict::Skipped))
    };
    // A stable sort: otherwise they stay in the order in which they came.
    all.sort_by_key(|traced| !of_failure(traced));
    all
}
