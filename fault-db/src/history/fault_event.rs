//! Stores events of faults: each with its place in the fault's event graph, and in a file with its seal.

use crate::backend::{Backend, SqlResult, values};
use crate::history::graph_sql::heads;
use crate::id::Id;
use crate::schema::derived_columns;
use crate::seal;
use crate::values::fault_state::FaultState;

/// An event about to be added.
pub(crate) struct NewEvent<'a> {
    pub id: Id,
    pub kind: &'a str,
    pub at_us: i64,
    pub who: &'a str,
    pub body: &'a str,
    /// The fault's state after the event; `None` if the event does not change it.
    pub state: Option<FaultState>,
}

/// What an event's author knew about the fault. The columns are called `follows`, `turn` and `seen`.
pub(crate) struct EventContext {
    /// Ids of the event's parents in the event graph, concatenated; empty for an event that does not change the state.
    /// A withdrawal has the event that it takes back.
    pub parents: Vec<u8>,
    /// Lamport number: one more than the greatest of the events that the author knew.
    pub lamport: i64,
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

/// Adds an event that takes back another one.
pub(crate) fn insert_withdrawal(
    backend: &Backend,
    fault: i64,
    event: &NewEvent<'_>,
    withdrawn: Id,
) -> SqlResult<()> {
    let mut context = context(backend, fault, event)?;
    context.parents = withdrawn.as_bytes().to_vec();
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
        return insert_on_server(backend, fault, event, context);
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

/// Inserts an event made on the server itself, unless its id exists.
fn insert_on_server(
    backend: &Backend,
    fault: i64,
    event: &NewEvent<'_>,
    context: &EventContext,
) -> SqlResult<()> {
    backend.execute(
        "INSERT INTO fault_event(id, fault, kind, at_us, who, body, state, turn, follows, seen, part, words)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, CAST(?12 AS tsvector))
         ON CONFLICT (id) DO NOTHING",
        &values![
            event.id,
            fault,
            event.kind,
            event.at_us,
            event.who,
            event.body,
            event.state,
            context.lamport,
            &context.parents[..],
            context.occurrences_known,
            derived_columns::part(event.kind, event.body),
            derived_columns::event_words(event.kind, event.body)
        ],
    )?;
    Ok(())
}
