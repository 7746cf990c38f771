//! The checks that failed before a repair: a trace of them is kept in the runs after it though they pass, so that the sheet
//! shows both.

use std::collections::BTreeSet;

use fault_db::{FaultFilter, FaultState, Id, Store, StoreError};

use super::plan::Task;
use crate::failure::Failure;

/// Faults of a unit that are looked at, and occurrences of each, the latest first.
const MOST_FAULTS: u32 = 50;
const MOST_OCCURRENCES: usize = 5;

/// Keeps a trace of each step that failed with a fault of this unit which is repaired and not verified yet.
///
/// # Errors
/// The database fails.
pub fn trace_repaired(tasks: &mut [Task], store: &Store, unit: &str) -> Result<(), Failure> {
    let checks = failed_before_repair(store, unit)?;
    for task in tasks {
        let of = |name: &str| checks.contains(&(task.procedure.id.clone(), name.to_owned()));
        let steps = task.procedure.steps.iter().enumerate();
        let traced = steps.filter(|(_, step)| of(&step.name));
        task.options.traced = traced.map(|(place, _)| place).collect();
    }
    Ok(())
}

/// Procedure and step of each check that failed with such a fault.
fn failed_before_repair(store: &Store, unit: &str) -> Result<BTreeSet<(String, String)>, Failure> {
    let filter = FaultFilter {
        unit: Some(unit.to_owned()),
        states: vec![FaultState::Repaired],
        limit: Some(MOST_FAULTS),
        ..FaultFilter::default()
    };
    let faults = match store.faults(&filter) {
        // A unit that was never here has no repairs.
        Err(StoreError::NotFound { .. }) => Vec::new(),
        faults => faults?,
    };
    let mut seen: BTreeSet<(Id, u32)> = BTreeSet::new();
    for fault in faults {
        let occurrences = store.fault(fault.id)?.occurrences.into_iter();
        let of_steps = occurrences.filter_map(|seen| Some((seen.run_id, seen.step_index?)));
        seen.extend(of_steps.take(MOST_OCCURRENCES));
    }
    let runs: BTreeSet<Id> = seen.iter().map(|(run, _)| *run).collect();
    let mut checks = BTreeSet::new();
    for run in runs {
        let steps = store.run(run)?.steps.into_iter();
        let failed = steps.filter(|step| seen.contains(&(run, step.index)));
        checks.extend(failed.map(|step| (step.procedure, step.name)));
    }
    Ok(checks)
}
