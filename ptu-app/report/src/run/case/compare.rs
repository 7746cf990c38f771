//! What failed before the repair, beside the same after it.

use fault_db::{MeasurementRecord, StepRecord, Verdict};

use super::CaseSheet;
use crate::run::steps::passed;

/// A check that failed before, and what became of it.
pub struct Compared<'a> {
    /// The step that failed.
    pub step: &'a StepRecord,
    /// What it measured beyond its limits; none if something else failed.
    pub before: Option<&'a MeasurementRecord>,
    /// The same step of the run after.
    pub step_after: Option<&'a StepRecord>,
    /// The same measurement there.
    pub after: Option<&'a MeasurementRecord>,
}

impl Compared<'_> {
    /// The verdict after, if it was tested again.
    pub fn verdict_after(&self) -> Option<Verdict> {
        match (self.before, self.after) {
            (Some(_), after) => after.map(|after| after.verdict),
            (None, _) => self.step_after.map(|step| step.verdict),
        }
    }
}

impl CaseSheet {
    /// The steps before that failed with a fault of the case, each once.
    pub(super) fn failed_steps(&self) -> Vec<&StepRecord> {
        let all = self.before.run.steps.iter();
        let failed = all.filter(|step| self.steps.contains(&step.index) && !passed(step.verdict));
        let mut once: Vec<&StepRecord> = Vec::new();
        for step in failed {
            if !once.iter().any(|known| is_same(known, step)) {
                once.push(step);
            }
        }
        once
    }

    /// Each measurement that was beyond its limits, and each step that failed without one.
    pub(super) fn compared(&self) -> Vec<Compared<'_>> {
        let mut all = Vec::new();
        for step in self.failed_steps() {
            let step_after = self.step_after(step);
            let failed = step.measurements.iter().filter(|m| !passed(m.verdict));
            let failed: Vec<_> = failed.map(Some).collect();
            let failed = if failed.is_empty() {
                vec![None]
            } else {
                failed
            };
            all.extend(failed.into_iter().map(|before| Compared {
                step,
                before,
                step_after,
                after: before.zip(step_after).and_then(|(before, step)| {
                    step.measurements.iter().find(|m| m.name == before.name)
                }),
            }));
        }
        all
    }

    /// The same step after; of several the one that speaks most against the repair.
    fn step_after(&self, step: &StepRecord) -> Option<&StepRecord> {
        let all = self.after.iter().flat_map(|sheet| &sheet.run.steps);
        let same = || all.clone().filter(|other| is_same(other, step));
        same()
            .find(|other| other.verdict != Verdict::Passed)
            .or_else(|| same().next())
    }
}

/// The same step, in whichever run.
pub fn is_same(one: &StepRecord, other: &StepRecord) -> bool {
    one.procedure == other.procedure && one.name == other.name
}
