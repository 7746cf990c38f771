//! Attributes the faults of a run that failed to the part that its diagnosis found.

use std::collections::BTreeMap;

use diagnosis::{Cause, CheckName, Sign};
use fault_db::{CauseRecord, Id, RunDetail, RunOccurrence, Store, Verdict};
use protocol::lru::from_stored;

use super::Answer;
use crate::clock::now_us;
use crate::failure::Failure;
use crate::run::CHECK_FAILED;

impl Answer {
    /// Stores what each fault of the run comes from. Nothing is stored of a run that did not fail, nor where the
    /// dictionary does not fit, or no part was found; a fault that a person has attributed stays as it is.
    ///
    /// # Errors
    /// The database does not take it.
    pub fn attribute(&self, store: &Store) -> Result<(), Failure> {
        if self.run.run.verdict != Some(Verdict::Failed) || !self.warnings.is_empty() {
            return Ok(());
        }
        if let Some((cause, faults)) = &self.cause {
            let record = CauseRecord {
                part: cause.lru.to_string(),
                run: Some(self.run.run.id.to_string()),
                probability: Some(cause.probability),
                note: String::new(),
            };
            store.attribute_diagnosed(faults, &record, now_us())?;
        }
        Ok(())
    }
}

/// The cause with the faults of a run that come from it: those that name its part, and those of which it explains all that
/// the run saw.
pub(super) fn with_faults(
    cause: Cause,
    run: &RunDetail,
    occurrences: &[RunOccurrence],
) -> (Cause, Vec<Id>) {
    let mut seen: BTreeMap<Id, Vec<&RunOccurrence>> = BTreeMap::new();
    for occurrence in occurrences {
        seen.entry(occurrence.fault).or_default().push(occurrence);
    }
    let is_of = |seen: &[&RunOccurrence]| {
        let lru = seen.first().and_then(|one| from_stored(&one.lru));
        lru.as_ref() == Some(&cause.lru) || seen.iter().all(|one| explains(&cause, run, one))
    };
    let faults = seen.iter().filter(|(_, seen)| is_of(seen));
    let faults = faults.map(|(fault, _)| *fault).collect();
    (cause, faults)
}

/// Whether the cause shows this: a check that failed by its step, anything else by the sign that it is.
fn explains(cause: &Cause, run: &RunDetail, seen: &RunOccurrence) -> bool {
    if seen.code != i64::from(CHECK_FAILED) {
        let sign = Sign {
            fault: seen.code_name.clone(),
            lru: from_stored(&seen.lru),
        };
        return cause.signs.contains(&sign);
    }
    let step = run
        .steps
        .iter()
        .find(|step| Some(step.index) == seen.step_index);
    step.is_some_and(|step| {
        cause.checks.contains(&CheckName {
            procedure: step.procedure.clone(),
            step: step.name.clone(),
        })
    })
}
