//! What happens at a station, in order.

use btu_rig::procedure::{RunEvent, UnitEvent};

use crate::run::{FaultSeen, Outcome};

/// Something that happened.
#[derive(Clone, Debug)]
pub enum News {
    /// The unit was reached.
    Connected {
        /// Its serial number.
        serial: String,
    },
    /// It could not be reached, or is not what was expected.
    NotConnected(String),
    /// It was let go.
    Disconnected {
        /// Outputs were confirmed safe, and the unit disarmed.
        safe: bool,
    },
    /// It cannot be reached any more.
    LinkLost(String),
    /// It was started again by itself or by somebody.
    UnitRestarted,
    /// Outputs were not confirmed safe before something else was done with it.
    NotSafe,
    /// The bench's program failed; the unit disarms by itself when nothing more comes.
    Broken,
    /// The bench did not do what was asked of it by hand.
    NotDone {
        /// What was asked.
        asked: String,
        /// Why not.
        why: String,
    },
    /// The unit or TCMS logged something while no procedure ran.
    Logged(UnitEvent),
    /// A procedure says something.
    Run {
        /// Which procedure.
        procedure: String,
        /// What.
        what: RunNews,
    },
    /// The run is over and recorded.
    RunEnded(Outcome),
    /// The run could not be begun or recorded.
    RunFailed(String),
}

/// What a running procedure says.
#[derive(Clone, Debug)]
pub enum RunNews {
    /// From the runner.
    Event(RunEvent),
    /// A fault was found.
    Fault(FaultSeen),
    /// The unit cannot be reached any more.
    LinkLost(String),
    /// The procedure's bench is free again.
    Ended,
}
