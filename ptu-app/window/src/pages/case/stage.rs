//! The stages of a case, and the stage that follows a run.

use ptu_report::words::Words;
use ptu_runs::failure::Exit;

/// A stage of a case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Stage {
    /// No unit is connected.
    #[default]
    Start,
    /// The unit is connected: its history is shown, and a person chooses its symptom.
    Unit,
    /// A run looks for the part.
    Find,
    Result,
    /// The repair is recorded.
    Repair,
    /// The part is fitted, and a run shows whether the fault is gone.
    Prove,
    /// The sheet of the last run.
    Sheet,
}

impl Stage {
    /// All stages, in order.
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

    /// Stage of a case after a run that ended with `exit`; `proven` = the run proved all earlier repairs.
    pub fn after_run(self, exit: Exit, proven: bool) -> Self {
        match (self, exit) {
            (Self::Find, _) => Self::Result,
            (Self::Prove, Exit::Passed) if proven => Self::Sheet,
            // The fault is still present, or another fault is.
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
