//! Receives the events that other laptops, and users on the server, added to the faults of a file.

use std::collections::BTreeSet;

use super::outcome::SyncOutcome;
use crate::backend::{Backend, Row, Server, SqlResult, values};
use crate::domain::{Refusals, check, check_body, shown_id};
use crate::event_graph::{fault_of, merge_faults, open_duplicates, recompute_fault};
use crate::id::Id;
use crate::seal::BY_SYNC;
use crate::seal::events_and_notes::seal_event_as_found;

/// Events of a batch at most.
const MOST_EVENTS: usize = 500;

/// An event on the server, with the fault's id in the file.
pub(super) struct Event {
    id: Id,
    fault: Id,
    kind: String,
    at_us: i64,
    who: String,
    body: String,
    state: Option<String>,
    lamport: i64,
    parents: Vec<u8>,
    occurrences_known: i64,
}

/// Which events to receive.
#[derive(Clone, Copy)]
pub(super) struct PullScope {
    /// The server's row number of the laptop.
    pub laptop: i64,
    /// The last event when the pull began. Writers exclude each other, so no event appears later with a
    /// smaller number.
    pub until: i64,
    /// Only of faults that are new to the laptop, however old the event.
    pub fresh: bool,
    /// Also those that the laptop sent itself: its file was restored from a backup.
    pub own_events: bool,
}

/// The last event on the server.
pub(super) fn last(backend: &Backend) -> SqlResult<i64> {
    let last = "SELECT coalesce(max(seq), 0) FROM fault_event";
    Ok(backend
        .first(last, &[], |row| row.get(0))?
        .unwrap_or_default())
}

/// One batch of events.
#[derive(Default)]
pub(super) struct Events {
    pub events: Vec<Event>,
    /// Events outside their columns' domain, accepted by an early version of the server.
    pub refused: Refusals,
    /// Where the next batch begins; `None` after the last.
    pub next: Option<i64>,
}

/// The columns of an event, in the order of the query.
const COLUMNS: [&str; 11] = [
    "seq", "id", "fault", "kind", "at_us", "who", "body", "state", "turn", "follows", "seen",
];

/// The next events after this one.
pub(super) fn events(backend: &Backend, scope: PullScope, after: i64) -> SqlResult<Events> {
    let fresh = if scope.fresh { "AND k.fresh > 0" } else { "" };
    let own_events = if scope.own_events {
        ""
    } else {
        "AND e.laptop IS DISTINCT FROM ?1"
    };
    // Two faults of the file may have been merged on the server: the later one is returned.
    let sql = format!(
        "SELECT DISTINCT ON (e.seq) e.seq, e.id, k.id, e.kind, e.at_us, e.who, e.body, e.state, e.turn,
            e.follows, e.seen
         FROM fault_event e JOIN laptop_fault k ON k.fault = e.fault AND k.laptop = ?1 {fresh}
         WHERE e.seq > ?2 AND e.seq <= ?3 {own_events} ORDER BY e.seq, k.id DESC LIMIT {MOST_EVENTS}"
    );
    let mut found = Events::default();
    let mut count = 0;
    backend.each(&sql, &values![scope.laptop, after, scope.until], |row| {
        count += 1;
        let seq = row.get(0)?;
        found.next = Some(seq);
        if let Err(reason) = check_event(row) {
            let id = row.get(1).map(shown_id).unwrap_or_default();
            found
                .refused
                .add(format!("event {id} on the server"), reason);
            return Ok(());
        }
        found.events.push(Event {
            id: row.get(1)?,
            fault: row.get(2)?,
            kind: row.get(3)?,
            at_us: row.get(4)?,
            who: row.get(5)?,
            body: row.get(6)?,
            state: row.get(7)?,
            lamport: row.get(8)?,
            parents: row.get(9)?,
            occurrences_known: row.get(10)?,
        });
        Ok(())
    })?;
    found.next = found.next.filter(|_| count == MOST_EVENTS);
    Ok(found)
}

/// Checks an event against its columns' domain.
fn check_event(row: Row<'_>) -> Result<(), String> {
    for (place, column) in COLUMNS.into_iter().enumerate() {
        let field = row
            .field(place)
            .map_err(|_| format!("{column} cannot be read"))?;
        check(column, field)?;
    }
    let text = |column| row.get::<&str>(column).unwrap_or_default();
    check_body(text(3), text(6))
}

/// Inserts events into the file and recomputes their faults; runs in the caller's transaction.
pub(super) fn add(file: &Backend, events: &[Event]) -> SqlResult<SyncOutcome> {
    let mut outcome = SyncOutcome::default();
    let before: i64 = file
        .first("SELECT coalesce(max(seq), 0) FROM outbox", &[], |row| {
            row.get(0)
        })?
        .unwrap_or_default();
    let mut faults = BTreeSet::new();
    for event in events {
        // The file was restored from a backup older than the fault.
        let Some(fault) = fault_of(file, event.fault)? else {
            continue;
        };
        // Occurrences on other laptops are not known in this file.
        let added = file.execute(
            "INSERT INTO fault_event(id, fault, kind, at_us, who, body, state, turn, follows, seen)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9,
                min(?10, (SELECT occurrences FROM fault WHERE seq = ?2))) ON CONFLICT (id) DO NOTHING",
            &values![
                event.id,
                fault,
                &event.kind,
                event.at_us,
                &event.who,
                &event.body,
                event.state.as_deref(),
                event.lamport,
                &event.parents[..],
                event.occurrences_known
            ],
        )?;
        if added > 0 {
            if let Some(seq) = file.first(
                "SELECT seq FROM fault_event WHERE id = ?1",
                &values![event.id],
                |row| row.get(0),
            )? {
                seal_event_as_found(file, seq, BY_SYNC)?;
            }
            outcome.events_received += 1;
            outcome.bytes += (event.body.len() + event.who.len() + 80) as u64;
            faults.insert(fault);
        }
    }
    // Received events need not be sent back.
    file.execute("DELETE FROM outbox WHERE seq > ?1", &values![before])?;
    outcome.faults_changed = faults.len() as u64;
    for fault in faults {
        recompute_fault(file, fault)?;
        merge_duplicates(file, fault)?;
    }
    Ok(outcome)
}

/// A received event may have reopened a fault of which the file has a second one by now.
fn merge_duplicates(file: &Backend, fault: i64) -> SqlResult<()> {
    let mut duplicates = open_duplicates(file, fault)?.into_iter();
    let Some(oldest) = duplicates.next() else {
        return Ok(());
    };
    duplicates.try_for_each(|duplicate| merge_faults(file, oldest, duplicate))
}

/// A fault that is new to a laptop, and how often it became so.
pub(super) struct Fresh {
    fault: i64,
    times: i64,
}

/// The faults that are new to a laptop.
pub(super) fn fresh(backend: &Backend, laptop: i64) -> SqlResult<Vec<Fresh>> {
    let fresh =
        "SELECT fault, fresh FROM laptop_fault WHERE laptop = ?1 AND fresh > 0 ORDER BY fault";
    backend.select(fresh, &values![laptop], |row| {
        Ok(Fresh {
            fault: row.get(0)?,
            times: row.get(1)?,
        })
    })
}

/// Confirms to the server that the laptop has received these new faults, and all other events up to
/// `received`. A fault that became new again meanwhile, because another laptop's sync merged it, stays new.
pub(super) fn acknowledge(
    server: &Server,
    laptop: i64,
    fresh: &[Fresh],
    received: i64,
) -> SqlResult<()> {
    let faults: Vec<i64> = fresh.iter().map(|fresh| fresh.fault).collect();
    let times: Vec<i64> = fresh.iter().map(|fresh| fresh.times).collect();
    let sql = "SELECT note_told($1, $2, $3, $4)";
    server.execute_columns(sql, &[&laptop, &received, &faults, &times])?;
    Ok(())
}
