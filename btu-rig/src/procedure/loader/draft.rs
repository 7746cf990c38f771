//! Declarations of `procedure()` and `step()`, before names are resolved and times computed.

use protocol::{Duration, LruId};

use crate::procedure::plan::{Action, Connection, Step};

/// A call that declares something.
#[derive(Clone, Debug)]
pub(super) enum Declaration {
    Procedure(ProcedureDraft),
    Step(StepDraft),
}

#[derive(Clone, Debug)]
pub(super) struct ProcedureDraft {
    pub title: String,
    pub title_ko: Option<String>,
    pub needs: Connection,
    pub on_request: bool,
    pub lacks: Option<String>,
    pub suspect: Option<LruId>,
    pub setup: Vec<Action>,
    pub cleanup: Vec<Action>,
    /// Sources of numbers in expectations that name none themselves.
    pub sources: Vec<String>,
}

#[derive(Clone, Debug)]
pub(super) struct StepDraft {
    /// Without line and times; its suspect is that of the call.
    pub step: Step,
    pub limit: Option<Duration>,
    /// The call says which part the step suspects, or that it suspects none.
    pub says_suspect: bool,
    /// Sources of numbers that name none themselves.
    pub sources: Vec<String>,
}
