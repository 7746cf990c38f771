//! Declarations of `procedure()` and `step()`, before names are resolved and times computed.

use protocol::Duration;

use crate::procedure::plan::{Procedure, Step};

/// A call that declares something.
#[derive(Clone, Debug)]
pub(super) enum Declaration {
    Procedure(ProcedureDraft),
    Step(StepDraft),
}

#[derive(Clone, Debug)]
pub(super) struct ProcedureDraft {
    /// The procedure without steps, path and checksum.
    pub procedure: Procedure,
    /// Sources of numbers in expectations that name none themselves.
    pub sources: Vec<String>,
}

#[derive(Clone, Debug)]
pub(super) struct StepDraft {
    /// The step without line and times; its suspect is the one that the call names.
    pub step: Step,
    pub limit: Option<Duration>,
    /// The call says which part the step suspects, or that it suspects none.
    pub says_suspect: bool,
    /// Sources of numbers that name none themselves.
    pub sources: Vec<String>,
}
