//! Puts into the outbox what no trigger puts there: runs that never finished, and rows recorded before the file had an
//! outbox.

use super::cursors;
use crate::backend::{Backend, SqlResult, values};
use crate::id::Id;
use crate::store::Store;

/// Puts the runs of dead programs, with their traces, into the outbox: such runs never finish.
pub(super) fn enqueue_interrupted_runs(store: &Store) -> SqlResult<()> {
    let file = &store.backend;
    let unfinished = file.select(
        "SELECT seq, id FROM run WHERE verdict IS NULL
            AND seq NOT IN (SELECT row FROM outbox WHERE what = 'run')",
        &[],
        |row| Ok((row.get::<i64>(0)?, row.get::<Id>(1)?)),
    )?;
    for (run, id) in unfinished {
        if store.is_under_way(id) {
            continue;
        }
        for sql in [
            "INSERT INTO outbox(what, row) VALUES ('run', ?1)",
            "INSERT INTO outbox(what, row) SELECT 'trace', seq FROM trace WHERE run = ?1
             ORDER BY seq",
        ] {
            file.execute(sql, &values![run])?;
        }
    }
    Ok(())
}

/// Before a file's first sync, puts into the outbox what was recorded before the file had one.
pub(super) fn enqueue_rows_before_outbox(file: &Backend) -> SqlResult<()> {
    if cursors::has_met_a_server(file)? {
        return Ok(());
    }
    for (what, rows) in [
        ("run", "SELECT seq FROM run WHERE verdict IS NOT NULL"),
        ("event", "SELECT seq FROM fault_event"),
        ("note", "SELECT seq FROM run_note"),
        (
            "trace",
            "SELECT t.seq FROM trace t JOIN run r ON r.seq = t.run WHERE r.verdict IS NOT NULL",
        ),
    ] {
        file.execute(
            &format!(
                "INSERT INTO outbox(what, row) SELECT '{what}', e.seq FROM ({rows}) AS e
                 WHERE e.seq NOT IN (SELECT row FROM outbox WHERE what = '{what}')
                 ORDER BY e.seq"
            ),
            &[],
        )?;
    }
    Ok(())
}
