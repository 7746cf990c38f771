//! Faults in conflict: two users, each without the other's event, brought a fault to different states.
//! Both events are kept and listed until a later event follows both.

use serde::Serialize;

use crate::backend::{Row, from_row};
use crate::error::StoreError;
use crate::history::graph_sql::heads;
use crate::id::Id;
use crate::store::Store;
use crate::values::fault_state::FaultState;

/// A fault in conflict. The next event that changes its state resolves the conflict.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct StateConflict {
    /// The fault.
    pub fault: Id,
    /// The unit's serial number.
    pub unit: String,
    /// Stable number of the fault.
    pub code: i64,
    /// Name of the fault's code.
    pub code_name: String,
    /// Part that the fault points at.
    pub lru: String,
    /// The state that counts meanwhile: the one that leaves the most work.
    pub stands: FaultState,
    /// The heads of the fault's event graph, in order of time.
    pub rivals: Vec<ConflictingEvent>,
}

/// One head of the event graph.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ConflictingEvent {
    /// The event.
    pub id: Id,
    /// Kind of the event.
    pub kind: String,
    /// Time of the event by its laptop's clock, µs since 1970.
    pub at_us: i64,
    /// Name of the event's author.
    pub who: String,
    /// A note, or JSON for a repair.
    pub body: String,
    /// The state to which the event brought the fault.
    pub state: FaultState,
}

/// SQL: the heads of the faults with several heads.
const CONFLICTING_EVENTS: &str = concat!(
    "SELECT f.id, u.serial, f.code, f.code_name, f.lru, f.state, e.id, e.kind, e.at_us, e.who, e.body, e.state
     FROM fault f JOIN unit u ON u.seq = f.unit, ",
    heads!("f.seq"),
    " AND e.kind <> 'opened' AND f.disputed = 1 ORDER BY f.id, e.at_us, e.id"
);

impl Store {
    /// Faults in conflict, in the order of their ids.
    pub fn conflicts(&self) -> Result<Vec<StateConflict>, StoreError> {
        let mut conflicts = Vec::<StateConflict>::new();
        let take = |row: Row<'_>| {
            let fault: Id = row.get(0)?;
            let rival = from_row!(row => ConflictingEvent:
                _, _, _, _, _, _, id, kind, at_us, who, body, state
            );
            match conflicts.last_mut().filter(|last| last.fault == fault) {
                Some(last) => last.rivals.push(rival),
                None => conflicts.push(from_row!(row => StateConflict:
                    fault, unit, code, code_name, lru, stands;
                    rivals: vec![rival]
                )),
            }
            Ok(())
        };
        self.ask("looking for conflicts", |backend| {
            backend.each(CONFLICTING_EVENTS, &[], take)
        })?;
        Ok(conflicts)
    }
}
