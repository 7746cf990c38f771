//! Changes of a fault by users and by runs: each is an event, and the newest event gives the state.

use crate::backend::{Backend, SqlResult, values};
use crate::error::StoreError;
use crate::event_graph::{heads, recompute_fault};
use crate::fault_state::{FaultAction, FaultState};
use crate::id::Id;
use crate::limits;
use crate::record::RepairRecord;
use crate::seal;
use crate::server::derived_columns;
use crate::store::Store;

/// An event about to be added.
pub(crate) struct NewEvent<'a> {
    pub id: Id,
    pub kind: &'a str,
    pub at_us: i64,
    pub who: &'a str,
    pub body: &'a str,
    /// The fault's state after it; `None` leaves the state.
    pub state: Option<FaultState>,
}

/// The event kind whose body is a [`RepairRecord`].
pub(crate) const REPAIR: &str = "repair";

impl Store {
    /// Acknowledges a fault: somebody works on it.
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

    /// Changes the state of a fault, if its current state allows it.
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

    /// Records a repair. The fault counts as repaired until a passing run verifies it.
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

    /// Adds a note; the state does not change.
    pub fn add_note(&self, fault: Id, who: &str, note: &str, at_us: i64) -> Result<(), StoreError> {
        const DOING: &str = "storing a note";
        limits::name("the name of who says it", who)?;
        limits::note("the note", note)?;
        let id = self.mint()?;
        self.change(DOING, |backend| {
            let (seq, _) = self.fault_row(fault)?;
            let event = NewEvent {
                id,
                kind: "note",
                at_us,
                who,
                body: note,
                state: None,
            };
            insert_event(backend, seq, &event).map_err(|error| self.failed(DOING, error))
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
        self.change(DOING, |backend| {
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
                insert_event(backend, seq, &event)?;
                // On a server clients may not write derived columns.
                if let Backend::Server(_) = backend {
                    return recompute_fault(backend, seq);
                }
                backend.execute(
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

/// What the author of an event knew of its fault. The columns are named `follows`, `turn` and `seen`.
pub(crate) struct EventContext {
    /// Ids of its parents in the event graph, concatenated; empty for an event that leaves the state.
    pub parents: Vec<u8>,
    /// Lamport number: one more than the greatest of the events known.
    pub lamport: i64,
    /// Occurrences known.
    pub occurrences_known: i64,
}

/// The context of an event whose author knows all that is stored here.
fn context(backend: &Backend, fault: i64, event: &NewEvent<'_>) -> SqlResult<EventContext> {
    let mut parents = Vec::new();
    if event.state.is_some() {
        let heads = concat!("SELECT e.id FROM ", heads!("?1"), " ORDER BY e.id");
        let heads = backend.select(heads, &values![fault], |row| row.get::<Id>(0))?;
        parents = heads.iter().flat_map(Id::as_bytes).copied().collect();
    }
    let found = backend.first(
        "SELECT coalesce((SELECT max(turn) FROM fault_event WHERE fault = ?1), 0) + 1, occurrences
         FROM fault WHERE seq = ?1",
        &values![fault],
        |row| Ok((row.get(0)?, row.get(1)?)),
    )?;
    let (lamport, occurrences_known) = found.unwrap_or_default();
    Ok(EventContext {
        parents,
        lamport,
        occurrences_known,
    })
}

/// Adds an event whose author knows all that is stored here.
pub(crate) fn insert_event(backend: &Backend, fault: i64, event: &NewEvent<'_>) -> SqlResult<()> {
    if event.state.is_some() && matches!(backend, Backend::File(_)) {
        let agreed = "UPDATE fault SET disputed = 0 WHERE seq = ?1 AND disputed = 1";
        backend.execute(agreed, &values![fault])?;
    }
    let context = context(backend, fault, event)?;
    insert_event_with_context(backend, fault, event, &context)
}

/// Adds an event unless its id exists.
pub(crate) fn insert_event_with_context(
    backend: &Backend,
    fault: i64,
    event: &NewEvent<'_>,
    context: &EventContext,
) -> SqlResult<()> {
    if let Backend::Server(_) = backend {
        return derived_columns::insert_event(backend, fault, event, context);
    }
    let fields = values![
        event.id,
        event.kind,
        event.at_us,
        event.who,
        event.body,
        event.state,
        context.lamport,
        &context.parents[..],
    ];
    let mut row = fields.to_vec();
    row.extend(values![fault, context.occurrences_known]);
    let added = backend.execute(
        "INSERT INTO fault_event(id, kind, at_us, who, body, state, turn, follows, fault, seen)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10) ON CONFLICT (id) DO NOTHING",
        &row,
    )?;
    match added {
        0 => Ok(()),
        _ => seal::events_and_notes::event(
            backend,
            fault,
            event.id,
            &fields,
            context.occurrences_known,
        ),
    }
}
