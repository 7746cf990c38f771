//! Receives the events that other laptops, and users on the server, added to the faults of a file.

use rusqlite::Connection;

use super::outcome::SyncOutcome;
use crate::backend::{Backend, Server, SqlError, SqlResult, from_row, values};
use crate::exchange::change_set::{ChangeSet, MOST_ENTRIES};
use crate::exchange::columns::Kind;
use crate::exchange::domain::Refusals;
use crate::exchange::tables::TableId;
use crate::exchange::to_file::FileApplier;
use crate::history::event_graph::{faults_of, settle};
use crate::seal::BY_SYNC;

#[derive(Clone, Copy)]
pub(super) struct PullScope {
    /// The server's row number of the laptop.
    pub laptop: i64,
    /// Row number of the server's last event when receiving began. Writers exclude each other, so no event appears
    /// later with a smaller number.
    pub until: i64,
    /// Receive only events of faults that are new to the laptop, however old the events.
    pub fresh: bool,
    /// Receive also events that the laptop sent itself: its file was restored from a backup.
    pub own_events: bool,
}

/// Row number of the last event on the server.
pub(super) fn last(backend: &Backend) -> SqlResult<i64> {
    let last = "SELECT coalesce(max(seq), 0) FROM fault_event";
    Ok(backend
        .first(last, &[], |row| row.get(0))?
        .unwrap_or_default())
}

pub(super) struct Events {
    pub set: ChangeSet,
    /// Events outside their columns' domain, accepted by an early version of the server.
    pub refused: Refusals,
    /// Row number of the event after which the next batch begins; `None` after the last batch.
    pub next: Option<i64>,
}

/// The next batch of events after row `after`.
pub(super) fn events(backend: &Backend, scope: PullScope, after: i64) -> SqlResult<Events> {
    let fresh = if scope.fresh { "AND k.fresh > 0" } else { "" };
    let own_events = if scope.own_events {
        ""
    } else {
        "AND e.laptop IS DISTINCT FROM ?1"
    };
    let columns = TableId::Event.table().columns;
    let values: Vec<_> = (columns.iter())
        .map(|column| match column.kind {
            Kind::Fault => "k.id".to_owned(),
            _ => format!("e.{}", column.name),
        })
        .collect();
    // Two faults of the file may have been merged on the server: then the later one is returned.
    let sql = format!(
        "SELECT DISTINCT ON (e.seq) {}, e.seq
         FROM fault_event e JOIN laptop_fault k ON k.fault = e.fault AND k.laptop = ?1 {fresh}
         WHERE e.seq > ?2 AND e.seq <= ?3 {own_events} ORDER BY e.seq, k.id DESC LIMIT {MOST_ENTRIES}",
        values.join(", ")
    );
    let mut found = Events {
        set: ChangeSet::new(false),
        refused: Refusals::default(),
        next: None,
    };
    let mut count = 0;
    backend.each(&sql, &values![scope.laptop, after, scope.until], |row| {
        count += 1;
        found.next = Some(row.get(columns.len())?);
        match found.set.rows_mut(TableId::Event).take(row) {
            Err(SqlError::Refused(refusal)) => {
                let what = format!("event {} on the server", refusal.shown);
                found.refused.add(what, refusal.reason);
                Ok(())
            }
            taken => taken,
        }
    })?;
    found.next = found.next.filter(|_| count == MOST_ENTRIES);
    Ok(found)
}

/// Adds events to the file and settles their faults; runs in the caller's transaction.
pub(super) fn add(file: &Backend, conn: &Connection, set: &ChangeSet) -> SqlResult<SyncOutcome> {
    let last = "SELECT coalesce(max(seq), 0) FROM outbox";
    let last: Option<i64> = file.first(last, &[], |row| row.get(0))?;
    let mut applier = FileApplier::begin(file, conn)?;
    // The file may have been restored from a backup.
    applier.is_older = true;
    applier.apply(set)?;
    // Sealed unchanged: the server compares these seals with its own events.
    applier.seal_the_rest(BY_SYNC)?;
    // An event cannot know more occurrences than this file has: those on other laptops are not in it.
    file.execute(
        "UPDATE fault_event SET seen = min(seen, (SELECT occurrences FROM fault f
            WHERE f.seq = fault_event.fault)) WHERE seq > ?1",
        &values![applier.before.event],
    )?;
    // Received events need not be sent back.
    file.execute(
        "DELETE FROM outbox WHERE seq > ?1",
        &values![last.unwrap_or(0)],
    )?;
    let outcome = SyncOutcome {
        events_received: applier.counts[TableId::Event as usize],
        faults_changed: faults_of(file, &applier.touched)?.len() as u64,
        bytes: set.bytes() as u64,
        ..SyncOutcome::default()
    };
    settle(file, &applier.touched, None)?;
    Ok(outcome)
}

/// A fault that is new to a laptop, with the number of times that it became new.
pub(super) struct NewFault {
    fault: i64,
    times: i64,
}

/// The faults that are new to a laptop.
pub(super) fn fresh(backend: &Backend, laptop: i64) -> SqlResult<Vec<NewFault>> {
    let fresh =
        "SELECT fault, fresh FROM laptop_fault WHERE laptop = ?1 AND fresh > 0 ORDER BY fault";
    backend.select(fresh, &values![laptop], |row| {
        Ok(from_row!(row => NewFault: fault, times))
    })
}

/// Confirms to the server that the laptop has received these new faults, and all other events up to
/// `received`. A fault that became new again meanwhile, because another laptop's sync merged it, stays new.
pub(super) fn acknowledge(
    server: &Server,
    laptop: i64,
    fresh: &[NewFault],
    received: i64,
) -> SqlResult<()> {
    let faults: Vec<i64> = fresh.iter().map(|fresh| fresh.fault).collect();
    let times: Vec<i64> = fresh.iter().map(|fresh| fresh.times).collect();
    let sql = "SELECT note_told($1, $2, $3, $4)";
    server.execute_columns(sql, &[&laptop, &received, &faults, &times])?;
    Ok(())
}
