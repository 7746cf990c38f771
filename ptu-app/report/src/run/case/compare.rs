//! Failures before the repair, beside the same checks after it.

use fault_db::StepRecord;

use super::CaseSheet;
use crate::run::compare::{Compared, is_same, pair, same_step};
use crate::run::steps::passed;

impl CaseSheet {
    /// The steps of the run before that failed with a fault of the case, each once.
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
            let after = self.after.as_ref();
            let pair = pair(
                Some(step),
                after.and_then(|sheet| same_step(step, &sheet.run)),
            );
            let is_beyond = |one: &Compared<'_>| one.before.is_some_and(|m| !passed(m.verdict));
            let mut beyond = pair.measurements.into_iter().filter(is_beyond).peekable();
            if beyond.peek().is_none() {
                all.push(pair.step);
            }
            all.extend(beyond);
        }
        all
    }
}
