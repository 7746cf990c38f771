//! An event of a fault, and its withdrawal.

use serde::Serialize;

use super::fault_state::FaultState;
use super::record::{CauseRecord, RepairRecord};
use crate::id::Id;

/// An event of a fault.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FaultEvent {
    /// The event.
    pub id: Id,
    /// opened, recurred, acknowledged, repair, repaired, passed, confirmed, verified, closed, reopened, note, cause or
    /// diagnosed. A run makes `confirmed`, a person `verified`.
    pub kind: String,
    /// Time of the event, µs since 1970.
    pub at_us: i64,
    /// Name of the person; empty for the program itself.
    pub who: String,
    /// The text; empty for a repair and for a cause.
    pub note: String,
    /// The fault's state after the event; `None` if the event did not change it.
    pub state: Option<FaultState>,
    /// The repair, if the event is one.
    pub repair: Option<RepairRecord>,
    /// The part that the fault comes from, if the event says so.
    pub cause: Option<CauseRecord>,
    /// The correction that withdraws the event.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correction: Option<Correction>,
}

/// Withdrawal of an event: by whom, when and why.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Correction {
    /// When, µs since 1970.
    pub at_us: i64,
    /// Name of the person who withdrew.
    pub who: String,
    /// Reason of the withdrawal.
    pub note: String,
}
