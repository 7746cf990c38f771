//! What people do to a fault: each act an event, and the fault's state the last one's.

use crate::base::{Base, SqlResult, values};
use crate::error::StoreError;
use crate::fault_state::{FaultAction, FaultState};
use crate::id::Id;
use crate::limits;
use crate::record::RepairRecord;
use crate::seal;
use crate::server::said;
use crate::settle::{last_words, settle};
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
        limits::note("the note", note)?;
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
        limits::note("the note", note)?;
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
        repair.check()?;
        // Strings only: cannot fail.
        let body = serde_json::to_string(repair).unwrap_or_default();
        self.act(fault, FaultAction::Repair, Some(REPAIR), who, &body, at_us)
    }

    /// Adds a note; the state stays.
    pub fn add_note(&self, fault: Id, who: &str, note: &str, at_us: i64) -> Result<(), StoreError> {
        const DOING: &str = "storing a note";
        limits::name("the name of who says it", who)?;
        limits::note("the note", note)?;
        let id = self.mint()?;
        self.change(DOING, |base| {
            let (seq, _) = self.fault_row(fault)?;
            let event = NewEvent {
                id,
                kind: "note",
                at_us,
                who,
                body: note,
                state: None,
            };
            insert_event(base, seq, &event).map_err(|error| self.failed(DOING, error))
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
        limits::name("the name of who says it", who)?;
        let id = self.mint()?;
        self.change(DOING, |base| {
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
                insert_event(base, seq, &event)?;
                // A server does not let others say what follows from what was said.
                if let Base::Server(_) = base {
                    return settle(base, seq);
                }
                base.execute(
                    "UPDATE fault SET state = ?2, closed_at_us = ?3 WHERE seq = ?1",
                    &values![seq, to, (to == FaultState::Closed).then_some(at_us)],
                )?;
                Ok(())
            };
            work().map_err(|error| self.failed(DOING, error))?;
            Ok(to)
        })
    }

    fn fault_row(&self, fault: Id) -> Result<(i64, FaultState), StoreError> {
        let found = self.first(
            "looking up a fault",
            "SELECT seq, state FROM fault WHERE id = ?1
             UNION ALL SELECT f.seq, f.state FROM fault_alias a JOIN fault f ON f.seq = a.fault
                WHERE a.id = ?1",
            &values![fault],
            |row| Ok((row.get(0)?, row.get(1)?)),
        )?;
        found.ok_or_else(|| StoreError::not_found("fault", fault))
    }
}

/// What an event was made in knowledge of.
pub(crate) struct Known {
    /// The ids of the last words on the fault's state, one after the other; none for an event that leaves it.
    pub follows: Vec<u8>,
    /// One more than the greatest turn.
    pub turn: i64,
    /// Occurrences of the fault.
    pub seen: i64,
}

/// All that is here.
fn known(base: &Base, fault: i64, event: &NewEvent<'_>) -> SqlResult<Known> {
    let mut follows = Vec::new();
    if event.state.is_some() {
        let last_words = concat!("SELECT e.id FROM ", last_words!("?1"), " ORDER BY e.id");
        let said = base.select(last_words, &values![fault], |row| row.get::<Id>(0))?;
        follows = said.iter().flat_map(Id::as_bytes).copied().collect();
    }
    let found = base.first(
        "SELECT coalesce((SELECT max(turn) FROM fault_event WHERE fault = ?1), 0) + 1, occurrences
         FROM fault WHERE seq = ?1",
        &values![fault],
        |row| Ok((row.get(0)?, row.get(1)?)),
    )?;
    let (turn, seen) = found.unwrap_or_default();
    Ok(Known {
        follows,
        turn,
        seen,
    })
}

/// Adds an event that was made in knowledge of all that is here.
pub(crate) fn insert_event(base: &Base, fault: i64, event: &NewEvent<'_>) -> SqlResult<()> {
    if event.state.is_some() && matches!(base, Base::File(_)) {
        let agreed = "UPDATE fault SET disputed = 0 WHERE seq = ?1 AND disputed = 1";
        base.execute(agreed, &values![fault])?;
    }
    let known = known(base, fault, event)?;
    insert_knowing(base, fault, event, &known)
}

/// Adds an event, unless it is there.
pub(crate) fn insert_knowing(
    base: &Base,
    fault: i64,
    event: &NewEvent<'_>,
    known: &Known,
) -> SqlResult<()> {
    if let Base::Server(_) = base {
        return said::insert_event(base, fault, event, known);
    }
    let says = values![
        event.id,
        event.kind,
        event.at_us,
        event.who,
        event.body,
        event.state,
        known.turn,
        &known.follows[..],
    ];
    let mut row = says.to_vec();
    row.extend(values![fault, known.seen]);
    let added = base.execute(
        "INSERT INTO fault_event(id, kind, at_us, who, body, state, turn, follows, fault, seen)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10) ON CONFLICT (id) DO NOTHING",
        &row,
    )?;
    match added {
        0 => Ok(()),
        _ => seal::said::event(base, fault, event.id, &says, known.seen),
    }
}
