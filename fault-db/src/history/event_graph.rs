//! Settles faults that got new rows: recomputes the columns of a fault's row that follow from its occurrences and
//! events (`graph_sql`), merges duplicates, and reopens faults that recurred.

use std::collections::BTreeSet;

use super::graph_sql::{RECOMPUTE_FAULT, standing};
use crate::backend::{Backend, SqlResult, values};
use crate::history::recurrence::{HighWaterMark, reopen_recurred};
use crate::id::Id;
use crate::schema::packed::fill_empty_blocks;

/// Recomputes the derived columns of a fault's row from its occurrences and events.
pub(crate) fn recompute_fault(backend: &Backend, fault: i64) -> SqlResult<()> {
    recompute_faults(backend, &[fault])
}

/// Recomputes the derived columns of many faults; on a server in one round trip, by a function of the tables' owner.
fn recompute_faults(backend: &Backend, faults: &[i64]) -> SqlResult<()> {
    if let Backend::Server(server) = backend {
        server.execute_columns("SELECT settle_faults($1)", &[&faults])?;
        return Ok(());
    }
    let sql = format!("{RECOMPUTE_FAULT} WHERE seq = ?1");
    for fault in faults {
        backend.execute(&sql, &values![*fault])?;
    }
    Ok(())
}

/// Settles faults that got rows from elsewhere: derived columns, duplicates, and, with the mark `judge`, recurrences
/// (without it the sender has judged them). `touched` names the faults by a present or former id.
pub(crate) fn settle(
    backend: &Backend,
    touched: &BTreeSet<Id>,
    judge: Option<HighWaterMark>,
) -> SqlResult<()> {
    settle_touched(backend, touched, judge)?;
    fill_empty_blocks(backend)
}

fn settle_touched(
    backend: &Backend,
    touched: &BTreeSet<Id>,
    judge: Option<HighWaterMark>,
) -> SqlResult<()> {
    let faults = faults_of(backend, touched)?;
    if faults.is_empty() {
        return Ok(());
    }
    recompute_faults(backend, &faults)?;
    let merged = merge_duplicates(backend, &faults, touched)?;
    let Some(mark) = judge else {
        return Ok(());
    };
    let mut changed = match merged.is_empty() {
        true => faults,
        false => faults_of(backend, touched)?,
    };
    // A reopened fault may be a duplicate of an open one; merged, it has more occurrences or resolutions.
    loop {
        let again = reopen_recurred(backend, &changed, mark)?;
        if again.is_empty() {
            return Ok(());
        }
        recompute_faults(backend, &again)?;
        changed = merge_duplicates(backend, &again, touched)?;
    }
}

/// The row number of the fault with this id, or with this id as an alias.
pub(crate) fn fault_of(backend: &Backend, id: Id) -> SqlResult<Option<i64>> {
    backend.first(FAULT_OF, &values![id], |row| row.get(0))
}

const FAULT_OF: &str =
    "SELECT seq FROM fault WHERE id = ?1 UNION ALL SELECT fault FROM fault_alias WHERE id = ?1";

/// The row numbers of faults with these ids or aliases.
pub(crate) fn faults_of(backend: &Backend, ids: &BTreeSet<Id>) -> SqlResult<Vec<i64>> {
    let mut found = BTreeSet::new();
    match backend {
        Backend::File(_) => {
            for id in ids {
                found.extend(fault_of(backend, *id)?);
            }
        }
        Backend::Server(server) => {
            let ids: Vec<&[u8]> = ids.iter().map(|id| &id.as_bytes()[..]).collect();
            let sql = "SELECT seq FROM fault WHERE id = ANY($1)
                UNION SELECT fault FROM fault_alias WHERE id = ANY($1)";
            for row in server.select_columns(sql, &[&ids])? {
                found.insert(row.try_get::<_, i64>(0)?);
            }
        }
    }
    Ok(found.into_iter().collect())
}

/// Merges unclosed faults of one unit, code and part into the oldest; returns the faults to look at again. On a server
/// its function `join_faults` does it.
fn merge_duplicates(
    backend: &Backend,
    faults: &[i64],
    touched: &BTreeSet<Id>,
) -> SqlResult<Vec<i64>> {
    if let Backend::Server(server) = backend {
        server.execute_columns("SELECT join_faults($1)", &[&faults])?;
        return faults_of(backend, touched);
    }
    let mut kept = BTreeSet::new();
    for fault in faults {
        let duplicates = backend.select(OPEN_DUPLICATES, &values![*fault], |row| row.get(0))?;
        if let [oldest, duplicates @ ..] = &duplicates[..] {
            for duplicate in duplicates {
                merge_faults(backend, *oldest, *duplicate)?;
                kept.insert(*oldest);
            }
        }
    }
    Ok(kept.into_iter().collect())
}

/// SQL: unclosed faults of the unit, code and part of fault `?1`, oldest first; none if fault `?1` is closed.
const OPEN_DUPLICATES: &str =
    "SELECT d.seq FROM fault f JOIN fault d ON d.unit = f.unit AND d.code = f.code AND d.lru = f.lru
     WHERE f.seq = ?1 AND f.state <> 'closed' AND d.state <> 'closed' ORDER BY d.seq";

/// Merges two faults of a file: all rows of `merged` move to `kept`, and its ids become aliases.
pub(crate) fn merge_faults(backend: &Backend, kept: i64, merged: i64) -> SqlResult<()> {
    for sql in MOVE_REPAIRS.iter().chain(&MOVE_ROWS) {
        backend.execute(sql, &values![kept, merged])?;
    }
    backend.execute("DELETE FROM fault WHERE seq = ?1", &values![merged])?;
    recompute_fault(backend, kept)?;
    backend.execute(UPDATE_REPAIRS, &values![kept])?;
    Ok(())
}

/// Moves the rows of fault `?2` to fault `?1`; on a server as part of `join_faults`.
pub(crate) const MOVE_ROWS: [&str; 4] = [
    "UPDATE fault_occurrence SET fault = ?1 WHERE fault = ?2",
    "UPDATE fault_event SET fault = ?1 WHERE fault = ?2",
    "UPDATE fault_alias SET fault = ?1 WHERE fault = ?2",
    "INSERT INTO fault_alias(id, fault) SELECT id, ?1 FROM fault WHERE seq = ?2 ON CONFLICT DO NOTHING",
];

/// SQL: moves the repairs of fault `?2` to fault `?1`; the index finds them by the unit.
const MOVE_REPAIRS: [&str; 1] = [
    "UPDATE repair SET fault = ?1 WHERE fault = ?2 AND unit = (SELECT unit FROM fault WHERE seq = ?2)",
];

/// SQL: recomputes, for each repair of fault `?1`, when the fault had been opened, from the events of both merged
/// faults.
const UPDATE_REPAIRS: &str = concat!(
    "UPDATE repair SET
        line = (SELECT line FROM fault WHERE seq = ?1),
        opened_at_us = min(repair.at_us, coalesce(
            (SELECT max(e.at_us) FROM fault_event e WHERE e.fault = ?1
                AND e.kind IN ('opened', 'recurred', 'reopened') AND e.at_us <= repair.at_us",
    standing!("e"),
    "),
            (SELECT first_at_us FROM fault WHERE seq = ?1)))
    WHERE fault = ?1 AND unit = (SELECT unit FROM fault WHERE seq = ?1)"
);
