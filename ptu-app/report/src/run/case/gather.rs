//! Reads the content of a repair sheet from the database.

use std::collections::BTreeSet;

use btu_rig::procedure::spoken;
use fault_db::{FaultDetail, FaultEvent, FaultState, FaultSummary, Id, Store, StoreError};

use super::{CaseSheet, Repair, Standing};
use crate::run::Sheet;
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::failure::{Asked, Failure};
use ptu_runs::symptoms::{self, Symptom};

impl CaseSheet {
    /// Reads all that the repair sheet of a fault's case says.
    ///
    /// # Errors
    /// There is no such fault, no run saw it, or the database cannot be read.
    pub fn gather(
        store: &Store,
        directory: &ScriptsDirectory,
        fault: Id,
        depot: &str,
        with_annex: bool,
    ) -> Result<Self, Failure> {
        let fault = leading(store, store.fault(fault)?)?;
        let repair = fault.events.iter().rev().find_map(repair);
        let last_seen = fault.occurrences.first().map(|seen| seen.at_us);
        let is_open = matches!(
            fault.fault.state,
            FaultState::Open | FaultState::Acknowledged
        );
        let seen_since = |repair: &Repair| last_seen > Some(repair.at_us);
        let came_back = is_open && repair.as_ref().is_some_and(seen_since);
        let repaired_at = repair.as_ref().filter(|_| !came_back).map(|r| r.at_us);
        let seen_before = fault
            .occurrences
            .iter()
            .find(|seen| repaired_at.is_none_or(|at_us| seen.at_us <= at_us))
            .or(fault.occurrences.first());
        let before = seen_before
            .ok_or_else(|| Failure::usage(Asked::NoRunSaw(fault.fault.id)))?
            .run_id;
        let since = |event: &&FaultEvent| repaired_at.is_some_and(|at_us| event.at_us >= at_us);
        let later = || fault.events.iter().filter(since);
        let mut passed: Vec<Id> = Vec::new();
        for run in later().filter_map(FaultEvent::passed_run) {
            if !passed.contains(&run) {
                passed.push(run);
            }
        }
        let is_proved = later().any(FaultEvent::is_proof);
        let vouched = later()
            .rev()
            .find(|event| event.state == Some(FaultState::Verified))
            .map(|event| Standing::Vouched(event.who.clone(), event.at_us, event.note.clone()));
        let standing = match &repair {
            None => Standing::NotRepaired,
            Some(_) if came_back => Standing::CameBack,
            // Somebody has opened the fault again.
            Some(_) if is_open => Standing::Claimed,
            Some(_) if is_proved => Standing::Proved,
            Some(_) => vouched.unwrap_or(Standing::Claimed),
        };
        let of_case = std::iter::once(&fault.fault).chain(&fault.case);
        let of_case: BTreeSet<Id> = of_case.map(|fault| fault.id).collect();
        let seen = store.run_occurrences(before)?;
        let seen = seen.iter().filter(|seen| of_case.contains(&seen.fault));
        let steps: BTreeSet<u32> = seen.filter_map(|seen| seen.step_index).collect();
        let after = passed.last();
        let before = Sheet::gather(store, directory, before)?;
        Ok(Self {
            symptom: symptom(store, directory, &before, &fault)?,
            before,
            after: after
                .map(|run| Sheet::gather(store, directory, *run))
                .transpose()?,
            steps: steps.into_iter().collect(),
            depot: depot.trim().to_owned(),
            with_annex,
            repair,
            passed,
            standing,
            fault,
        })
    }
}

/// The fault of the case that names the part itself and is in the same state as the fault `asked`: the sheet is the
/// same for all faults of the case in this state.
fn leading(store: &Store, asked: FaultDetail) -> Result<FaultDetail, Failure> {
    let names_it = |fault: &FaultSummary| fault.lru.eq_ignore_ascii_case(fault.cause());
    if names_it(&asked.fault) {
        return Ok(asked);
    }
    let other = asked.case.iter();
    let mut other = other.filter(|other| names_it(other) && other.state == asked.fault.state);
    match other.next() {
        Some(other) => Ok(store.fault(other.id)?),
        None => Ok(asked),
    }
}

/// Symptom reported with the unit: in the run before, or in an earlier one that saw the fault since it was last
/// settled. A symptom that the scripts directory no longer has goes by its identifier.
fn symptom(
    store: &Store,
    directory: &ScriptsDirectory,
    before: &Sheet,
    fault: &FaultDetail,
) -> Result<Option<Symptom>, StoreError> {
    let last = &before.run.run;
    let settles = |event: &&FaultEvent| {
        let settled = [FaultState::Verified, FaultState::Closed];
        event.state.is_some_and(|state| settled.contains(&state))
            && event.at_us < last.started_at_us
    };
    let since = fault.events.iter().rev().find(settles);
    let since = since.map_or(i64::MIN, |event| event.at_us);
    let mut runs = vec![last.id];
    for seen in &fault.occurrences {
        if (since..last.started_at_us).contains(&seen.at_us) && !runs.contains(&seen.run_id) {
            runs.push(seen.run_id);
        }
    }
    for run in runs {
        let Some(id) = store.run(run)?.run.symptom else {
            continue;
        };
        let known = (directory.faults().ok())
            .and_then(|catalogue| symptoms::find(directory, &catalogue.lrus, &id).ok());
        return Ok(Some(known.unwrap_or_else(|| Symptom {
            name: spoken(&id),
            id,
            parts: Vec::new(),
        })));
    }
    Ok(None)
}

fn repair(event: &FaultEvent) -> Option<Repair> {
    Some(Repair {
        record: event.repair.clone()?,
        who: event.who.clone(),
        at_us: event.at_us,
    })
}
