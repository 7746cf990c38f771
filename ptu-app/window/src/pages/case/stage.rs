//! Where a case is on its way, and where it goes from there.

use ptu_report::words::Words;
use ptu_runs::failure::Exit;

/// A place on the way of a case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Stage {
    /// No unit is connected.
    #[default]
    Start,
    /// The unit is there: what is known of it, and its symptom.
    Unit,
    /// A run looks for the part.
    Find,
    Result,
    /// The repair is written down.
    Repair,
    /// The part is fitted, and a run shows whether the fault is gone.
    Prove,
    /// The sheet of the last run.
    Sheet,
}

impl Stage {
    /// All, in order.
    pub const ALL: [Self; 7] = [
        Self::Start,
        Self::Unit,
        Self::Find,
        Self::Result,
        Self::Repair,
        Self::Prove,
        Self::Sheet,
    ];

    pub fn name(self, words: &Words) -> &'static str {
        let words = &words.case;
        match self {
            Self::Start => words.stage_start,
            Self::Unit => words.stage_unit,
            Self::Find => words.stage_run,
            Self::Result => words.stage_result,
            Self::Repair => words.stage_repair,
            Self::Prove => words.stage_prove,
            Self::Sheet => words.stage_sheet,
        }
    }

    /// Where a case is after a run that ended so; `proven` = it proved all repairs before it.
    pub fn after_run(self, exit: Exit, proven: bool) -> Self {
        match (self, exit) {
            (Self::Find, _) => Self::Result,
            (Self::Prove, Exit::Passed) if proven => Self::Sheet,
            // The fault is still there, or another one.
            (Self::Prove, Exit::Failed) => Self::Result,
            (stage, _) => stage,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_proof_leads_to_the_sheet_and_a_failure_back_to_a_result() {
        let after = |proven, exit| Stage::Prove.after_run(exit, proven);
        assert_eq!(after(true, Exit::Passed), Stage::Sheet);
        assert_eq!(after(false, Exit::Passed), Stage::Prove, "more runs");
        assert_eq!(after(false, Exit::Failed), Stage::Result);
        assert_eq!(after(true, Exit::Aborted), Stage::Prove);
        let found = Stage::Find.after_run(Exit::Passed, false);
        assert_eq!(found, Stage::Result);
    }
}
