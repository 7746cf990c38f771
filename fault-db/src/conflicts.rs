//! Two people who did not know of each other brought a fault to different states: both events are kept,
//! and shown until somebody has looked again.

use serde::Serialize;

use crate::error::StoreError;
use crate::fault_state::FaultState;
use crate::id::Id;
use crate::settle::last_words;
use crate::store::Store;

/// A fault about whose state places disagree. It is settled by whatever is done about the fault next.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct StateConflict {
    /// The fault.
    pub fault: Id,
    /// The unit's serial number.
    pub unit: String,
    /// Stable number of the fault.
    pub code: i64,
    /// Its name.
    pub code_name: String,
    /// Replaceable part it points at.
    pub lru: String,
    /// What stands meanwhile: the state that leaves the most to do.
    pub stands: FaultState,
    /// What was done without knowledge of each other, by time.
    pub rivals: Vec<RivalEvent>,
}

/// One side of a conflict.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RivalEvent {
    /// The event.
    pub id: Id,
    /// What was done.
    pub kind: String,
    /// When, by the clock there.
    pub at_us: i64,
    /// Who did it.
    pub who: String,
    /// A note, or JSON for a repair.
    pub body: String,
    /// The state it brought the fault to.
    pub state: FaultState,
}

/// The last words on faults about which there is more than one.
const RIVALS: &str = concat!(
    "SELECT f.id, u.serial, f.code, f.code_name, f.lru, f.state, e.id, e.kind, e.at_us, e.who, e.body, e.state
     FROM fault f JOIN unit u ON u.seq = f.unit, ",
    last_words!("f.seq"),
    " AND e.kind <> 'opened' AND f.disputed = 1 ORDER BY f.id, e.at_us, e.id"
);

impl Store {
    /// Faults about whose state two places disagree, in the order of their ids.
    pub fn conflicts(&self) -> Result<Vec<StateConflict>, StoreError> {
        let mut conflicts = Vec::<StateConflict>::new();
        let take = |row: crate::base::Row<'_>| {
            let fault: Id = row.get(0)?;
            let rival = RivalEvent {
                id: row.get(6)?,
                kind: row.get(7)?,
                at_us: row.get(8)?,
                who: row.get(9)?,
                body: row.get(10)?,
                state: row.get(11)?,
            };
            match conflicts.last_mut().filter(|last| last.fault == fault) {
                Some(last) => last.rivals.push(rival),
                None => conflicts.push(StateConflict {
                    fault,
                    unit: row.get(1)?,
                    code: row.get(2)?,
                    code_name: row.get(3)?,
                    lru: row.get(4)?,
                    stands: row.get(5)?,
                    rivals: vec![rival],
                }),
            }
            Ok(())
        };
        let found = self.base().each(RIVALS, &[], take);
        found.map_err(|error| self.failed("looking for conflicts", error))?;
        Ok(conflicts)
    }
}
