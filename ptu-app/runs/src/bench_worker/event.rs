//! What the bench thread tells the window, in the order in which it happened.

use btu_rig::procedure::UnitEvent;
use btu_rig::rig::LinkTrouble;

use crate::failure::Trouble;
use crate::run::{Outcome, SessionEvent};

/// One thing that happened on the bench. What a running procedure emits is passed on as it is.
#[derive(Clone, Debug)]
pub enum BenchEvent {
    /// The unit was reached and identified.
    Connected {
        serial: String,
    },
    /// The unit could not be reached or is not the expected one: the reason.
    NotConnected(Trouble),
    Disconnected {
        /// Whether safe outputs were confirmed and the unit was disarmed.
        safe: bool,
    },
    /// The link to the unit was lost outside a run: the reason.
    LinkLost(LinkTrouble),
    UnitRestarted,
    /// Safe outputs were not confirmed before a run began, or after everything was stopped.
    NotSafe,
    /// Stopping everything has ended: outputs are safe and the unit is disarmed, or a person went on by hand before that.
    StopEnded,
    /// The bench thread panicked; the unit disarms by its own time-out.
    Broken,
    /// A manual stimulus was refused.
    NotDone {
        asked: String,
        why: String,
    },
    /// The unit or TCMS logged an event outside a run.
    Logged(UnitEvent),
    /// A running procedure emitted an event; traces and recorded stimuli go to the database only.
    Run {
        /// Procedure, as `atp/overspeed`.
        procedure: String,
        event: SessionEvent,
    },
    /// The run has ended and is recorded.
    RunEnded(Outcome),
    /// The run could not be started or recorded: the reason.
    RunFailed(Trouble),
}
