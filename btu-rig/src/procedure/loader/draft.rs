//! What `procedure()` and `step()` declare, before names are resolved and times computed.

use protocol::event::Event;
use protocol::{Duration, LruId};

use crate::procedure::origin::Origin;
use crate::procedure::plan::{Action, Condition, Connection, Expectation, Measure, OnFail};

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
    pub suspect: Option<LruId>,
    pub setup: Vec<Action>,
    pub cleanup: Vec<Action>,
    /// Of numbers in expectations that say none themselves.
    pub sources: Vec<String>,
}

#[derive(Clone, Debug)]
pub(super) struct StepDraft {
    pub name: String,
    pub actions: Vec<Action>,
    pub expectations: Vec<Expectation>,
    /// Where the numbers of its expectations come from.
    pub origin: Origin,
    pub measures: Vec<Measure>,
    pub provokes: Vec<Event>,
    pub when: Option<Condition>,
    pub repeat: u32,
    pub on_fail: OnFail,
    pub continues: bool,
    pub limit: Option<Duration>,
    /// `Some(None)`: the call says that the step suspects no part.
    pub suspect: Option<Option<LruId>>,
    pub note: Option<String>,
    /// Of numbers that say none themselves.
    pub sources: Vec<String>,
}
