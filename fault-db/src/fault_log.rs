//! What people do to a fault: each act an event, and the fault's state the last one's.

use rusqlite::{Connection, params};

use crate::error::StoreError;
use crate::fault_state::{FaultAction, FaultState};
use crate::id::Id;
use crate::record::RepairRecord;
use crate::store::Store;

/// An event about to be added.
pub(crate) struct NewEvent<'a> {
    pub id: Id,
    pub kind: &'a str,
    pub at_us: i64,
    pub who: &'a str,
    pub body: &'a str,
    /// The fault's state after it; none leaves it as it was.
    pub state: Option<FaultState>,
}

/// The event kind whose body is a [`RepairRecord`].
pub(crate) const REPAIR: &str = "repair";

impl Store {
    /// Takes note of a fault: somebody is at it.
    pub fn acknowledge(
        &self,
        fault: Id,
        who: &str,
        note: &str,
        at_us: i64,
    ) -> Result<FaultState, StoreError> {
        self.act(fault, FaultAction::Acknowledge, None, who, note, at_us)
    }

    /// Brings a fault to another state, if it may go there from where it is.
    pub fn set_state(
        &self,
        fault: Id,
        state: FaultState,
        who: &str,
        note: &str,
        at_us: i64,
    ) -> Result<FaultState, StoreError> {
        self.act(fault, FaultAction::towards(state), None, who, note, at_us)
    }

    /// Records a repair and takes the fault for repaired, until a passing run verifies it.
    pub fn record_repair(
        &self,
        fault: Id,
        repair: &RepairRecord,
        who: &str,
        at_us: i64,
    ) -> Result<FaultState, StoreError> {
        // Strings only: cannot fail.
        let body = serde_json::to_string(repair).unwrap_or_default();
        self.act(fault, FaultAction::Repair, Some(REPAIR), who, &body, at_us)
    }

    /// Adds a note; the state stays.
    pub fn add_note(&self, fault: Id, who: &str, note: &str, at_us: i64) -> Result<(), StoreError> {
        const DOING: &str = "storing a note";
        let id = self.mint()?;
        self.write(DOING, |conn| {
            let (seq, _) = self.fault_row(fault)?;
            let event = NewEvent {
                id,
                kind: "note",
                at_us,
                who,
                body: note,
                state: None,
            };
            insert_event(conn, seq, &event).map_err(|error| self.failed(DOING, error))
        })
    }

    fn act(
        &self,
        fault: Id,
        action: FaultAction,
        kind: Option<&str>,
        who: &str,
        body: &str,
        at_us: i64,
    ) -> Result<FaultState, StoreError> {
        const DOING: &str = "changing a fault's state";
        let id = self.mint()?;
        self.write(DOING, |conn| {
            let (seq, from) = self.fault_row(fault)?;
            let to = from.next(action);
            let to = to.map_err(|source| StoreError::Transition { fault, source })?;
            let kind = kind.unwrap_or(action.event_kind());
            let event = NewEvent {
                id,
                kind,
                at_us,
                who,
                body,
                state: Some(to),
            };
            let work = || {
                insert_event(conn, seq, &event)?;
                conn.prepare_cached("UPDATE fault SET state = ?2 WHERE seq = ?1")?
                    .execute(params![seq, to])
            };
            work().map_err(|error| self.failed(DOING, error))?;
            Ok(to)
        })
    }

    fn fault_row(&self, fault: Id) -> Result<(i64, FaultState), StoreError> {
        self.conn
            .prepare_cached("SELECT seq, state FROM fault WHERE id = ?1")
            .and_then(|mut select| {
                select.query_row(params![fault], |row| Ok((row.get(0)?, row.get(1)?)))
            })
            .map_err(|error| self.not_found("fault", fault, error))
    }
}

pub(crate) fn insert_event(
    conn: &Connection,
    fault: i64,
    event: &NewEvent<'_>,
) -> rusqlite::Result<()> {
    conn.prepare_cached(
        "INSERT INTO fault_event(id, fault, kind, at_us, who, body, state)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)",
    )?
    .execute(params![
        event.id,
        fault,
        event.kind,
        event.at_us,
        event.who,
        event.body,
        event.state
    ])?;
    Ok(())
}
