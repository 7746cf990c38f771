//! How much of what was chosen was run: what a verdict stands for where steps were skipped.

use std::collections::BTreeSet;

use btu_rig::procedure::plan::NEEDS_HARNESS;
use fault_db::{StepRecord, Verdict};

use crate::stored::{outside_of, standing};

/// Steps of scripts, each attempt at one counted once.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Coverage {
    /// Steps chosen.
    pub of: usize,
    /// Steps that were run.
    pub run: usize,
    /// Steps that were run and passed.
    pub passed: usize,
    /// Steps skipped because they need the bench harness.
    pub need_bench: usize,
    /// Folders of the procedures that do.
    pub on_bench: BTreeSet<String>,
}

impl Coverage {
    /// Of a stored run.
    pub fn of_run(steps: &[StepRecord]) -> Self {
        let mut coverage = Self::default();
        for step in standing(steps).filter(|step| outside_of(step).is_none()) {
            let (verdict, message) = (step.verdict, step.message.as_str());
            coverage.note(&step.procedure, verdict, message);
        }
        coverage
    }

    /// One more step of this procedure, and why it was skipped.
    pub fn note(&mut self, procedure: &str, verdict: Verdict, message: &str) {
        self.of += 1;
        self.run += usize::from(verdict != Verdict::Skipped);
        self.passed += usize::from(verdict == Verdict::Passed);
        if verdict == Verdict::Skipped && message.ends_with(NEEDS_HARNESS) {
            self.need_bench += 1;
            let folder = procedure.split('/').next().unwrap_or(procedure);
            self.on_bench.insert(folder.to_owned());
        }
    }

    /// Steps that were chosen and not run.
    pub fn skipped(&self) -> usize {
        self.of - self.run
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_skipped_is_no_part_of_what_was_run() {
        let mut coverage = Coverage::default();
        coverage.note("ptu/identity", Verdict::Passed, "");
        coverage.note("ptu/markers", Verdict::Failed, "");
        coverage.note("atp/overspeed", Verdict::Skipped, NEEDS_HARNESS);
        coverage.note("atp/power_up", Verdict::Skipped, NEEDS_HARNESS);
        coverage.note("ptu/identity", Verdict::Skipped, "needs an operator");
        assert_eq!((coverage.of, coverage.run, coverage.passed), (5, 2, 1));
        assert_eq!((coverage.skipped(), coverage.need_bench), (3, 2));
        assert_eq!(coverage.on_bench, BTreeSet::from(["atp".to_owned()]));
    }
}
