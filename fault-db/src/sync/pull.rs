//! What other laptops, and people at the server itself, said about the faults of a file.

use std::collections::BTreeSet;

use super::outcome::SyncOutcome;
use crate::base::{Base, Row, Server, SqlResult, values};
use crate::domain::{Refusals, check, check_body, shown_id};
use crate::id::Id;
use crate::seal::BY_SYNC;
use crate::seal::said::found_event;
use crate::settle::{fault_of, join, open_doubles, settle};

/// Events of a batch at most.
const MOST_EVENTS: usize = 500;

/// An event of the server, with the fault's id as the file knows it.
pub(super) struct Event {
    id: Id,
    fault: Id,
    kind: String,
    at_us: i64,
    who: String,
    body: String,
    state: Option<String>,
    turn: i64,
    follows: Vec<u8>,
    seen: i64,
}

/// Which events are asked for.
#[derive(Clone, Copy)]
pub(super) struct Asked {
    /// The server's number of the laptop.
    pub laptop: i64,
    /// Up to this event, which was the last when the pull began. Events are added one transaction after
    /// the other, so that none comes later with a smaller number.
    pub until: i64,
    /// Only of faults that the laptop has not been told of before, however old the event.
    pub fresh: bool,
    /// The laptop's own, too: its file came back from a backup.
    pub own: bool,
}

/// The last event there is.
pub(super) fn last(base: &Base) -> SqlResult<i64> {
    let last = "SELECT coalesce(max(seq), 0) FROM fault_event";
    Ok(base.first(last, &[], |row| row.get(0))?.unwrap_or_default())
}

/// Some events.
#[derive(Default)]
pub(super) struct Events {
    pub events: Vec<Event>,
    /// Those that hold what none holds: a server of an earlier version took them.
    pub refused: Refusals,
    /// Where the next question goes on; none if these were the last.
    pub next: Option<i64>,
}

/// An event's columns, in the order they are asked for.
const COLUMNS: [&str; 11] = [
    "seq", "id", "fault", "kind", "at_us", "who", "body", "state", "turn", "follows", "seen",
];

/// The next events after this one.
pub(super) fn events(base: &Base, asked: Asked, after: i64) -> SqlResult<Events> {
    let fresh = if asked.fresh { "AND k.fresh > 0" } else { "" };
    let own = if asked.own {
        ""
    } else {
        "AND e.laptop IS DISTINCT FROM ?1"
    };
    // Two faults of the file may have become one on the server: the later one is told.
    let sql = format!(
        "SELECT DISTINCT ON (e.seq) e.seq, e.id, k.id, e.kind, e.at_us, e.who, e.body, e.state, e.turn,
            e.follows, e.seen
         FROM fault_event e JOIN laptop_fault k ON k.fault = e.fault AND k.laptop = ?1 {fresh}
         WHERE e.seq > ?2 AND e.seq <= ?3 {own} ORDER BY e.seq, k.id DESC LIMIT {MOST_EVENTS}"
    );
    let mut found = Events::default();
    let mut count = 0;
    base.each(&sql, &values![asked.laptop, after, asked.until], |row| {
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
            turn: row.get(8)?,
            follows: row.get(9)?,
            seen: row.get(10)?,
        });
        Ok(())
    })?;
    found.next = found.next.filter(|_| count == MOST_EVENTS);
    Ok(found)
}

/// Holds an event to its columns' domain.
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

/// Adds events to the file and brings their faults in line; runs in the caller's transaction.
pub(super) fn add(file: &Base, events: &[Event]) -> SqlResult<SyncOutcome> {
    let mut outcome = SyncOutcome::default();
    let before: i64 = file
        .first("SELECT coalesce(max(seq), 0) FROM outbox", &[], |row| {
            row.get(0)
        })?
        .unwrap_or_default();
    let mut faults = BTreeSet::new();
    for event in events {
        // The file came back from a backup older than the fault.
        let Some(fault) = fault_of(file, event.fault)? else {
            continue;
        };
        // What others saw of it stays with them and the server: of that, nothing is known here.
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
                event.turn,
                &event.follows[..],
                event.seen
            ],
        )?;
        if added > 0 {
            if let Some(seq) = file.first(
                "SELECT seq FROM fault_event WHERE id = ?1",
                &values![event.id],
                |row| row.get(0),
            )? {
                found_event(file, seq, BY_SYNC)?;
            }
            outcome.events_received += 1;
            outcome.bytes += (event.body.len() + event.who.len() + 80) as u64;
            faults.insert(fault);
        }
    }
    // What came from the server need not go back to it.
    file.execute("DELETE FROM outbox WHERE seq > ?1", &values![before])?;
    outcome.faults_changed = faults.len() as u64;
    for fault in faults {
        settle(file, fault)?;
        join_doubles(file, fault)?;
    }
    Ok(outcome)
}

/// What came may have opened a fault again that the file has a second one of by now.
fn join_doubles(file: &Base, fault: i64) -> SqlResult<()> {
    let mut doubles = open_doubles(file, fault)?.into_iter();
    let Some(oldest) = doubles.next() else {
        return Ok(());
    };
    doubles.try_for_each(|double| join(file, oldest, double))
}

/// A fault that is new to a laptop, and how often it became so.
pub(super) struct Fresh {
    fault: i64,
    times: i64,
}

/// The faults that are new to a laptop.
pub(super) fn fresh(base: &Base, laptop: i64) -> SqlResult<Vec<Fresh>> {
    let fresh =
        "SELECT fault, fresh FROM laptop_fault WHERE laptop = ?1 AND fresh > 0 ORDER BY fault";
    base.select(fresh, &values![laptop], |row| {
        Ok(Fresh {
            fault: row.get(0)?,
            times: row.get(1)?,
        })
    })
}

/// The laptop has been told all of these faults, which were new to it, and of the others up to `received`.
/// What became new once more meanwhile, since another laptop's sync joined it with a fault, stays new.
pub(super) fn told(server: &Server, laptop: i64, fresh: &[Fresh], received: i64) -> SqlResult<()> {
    let faults: Vec<i64> = fresh.iter().map(|fresh| fresh.fault).collect();
    let times: Vec<i64> = fresh.iter().map(|fresh| fresh.times).collect();
    let told = "SELECT note_told($1, $2, $3, $4)";
    server.execute_columns(told, &[&laptop, &received, &faults, &times])?;
    Ok(())
}
