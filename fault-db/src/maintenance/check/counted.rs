//! Checks and rebuilds the derived tables, which triggers maintain.
//!
//! The statements that fill these tables are run against temporary tables of the same names: an unqualified
//! name means the temporary table, so the check changes nothing in the file.

use rusqlite::Connection;

use super::derived::faults_that_differ;
use super::{Damage, Derived, Findings};
use crate::backend::{SqlError, SqlResult};
use crate::error::StoreError;
use crate::history::event_graph::recompute_fault;
use crate::schema::{DERIVED, WORDS};
use crate::seal::{RECOUNTED, RecountedPayload, append_statement};
use crate::store::Store;

/// The derived tables, each with the columns to index for a join with its copy.
const TABLES: [(&str, Option<&str>); 4] = [
    ("repair", None),
    ("measured_day", Some("name, day")),
    ("measured_month", Some("name, month, unit")),
    ("packed", Some("block")),
];

/// Queries that count differing rows. Floating-point sums depend on the order of summation; that much
/// difference is allowed, relative to the sum of squares.
const DIFFERENCES: [(Derived, &str); 6] = [
    (
        Derived::Repairs,
        "SELECT count(DISTINCT event) FROM (
            SELECT * FROM (SELECT * FROM main.repair EXCEPT SELECT * FROM temp.repair)
            UNION ALL SELECT * FROM (SELECT * FROM temp.repair EXCEPT SELECT * FROM main.repair))",
    ),
    (
        Derived::Days,
        "SELECT count(*) FROM main.measured_day a FULL JOIN temp.measured_day b USING (name, procedure, day)
         WHERE a.n IS NOT b.n OR a.least IS NOT b.least OR a.most IS NOT b.most
            OR a.not_passed IS NOT b.not_passed
            OR (a.x - b.x) * (a.x - b.x) > 1e-18 * b.n * b.xx OR abs(a.xx - b.xx) > 1e-9 * b.xx",
    ),
    (
        Derived::Months,
        "SELECT count(*) FROM main.measured_month a FULL JOIN temp.measured_month b USING (name, procedure, month, unit)
         WHERE a.n IS NOT b.n
            OR (a.x - b.x) * (a.x - b.x) > 1e-18 * b.n * b.xx OR abs(a.xx - b.xx) > 1e-9 * b.xx
            OR (a.t - b.t) * (a.t - b.t) > 1e-18 * b.n * b.tt OR abs(a.tt - b.tt) > 1e-9 * b.tt
            OR (a.tx - b.tx) * (a.tx - b.tx) > 1e-18 * b.tt * b.xx",
    ),
    (
        Derived::Packed,
        "SELECT count(*) FROM main.packed a FULL JOIN temp.packed b USING (block)
         WHERE a.block IS NULL OR a.faults IS NOT NULL AND (a.faults, a.occurrences, a.repairs)
            IS NOT (b.faults, b.occurrences, b.repairs)",
    ),
    (
        Derived::FaultNotes,
        "SELECT (SELECT count(*) FROM fault_event e WHERE e.kind NOT IN ('opened', 'recurred') AND e.body <> ''
                AND NOT EXISTS (SELECT 1 FROM event_words_docsize w WHERE w.id = e.seq))
            + (SELECT count(*) FROM event_words_docsize w
                WHERE NOT EXISTS (SELECT 1 FROM fault_event e WHERE e.seq = w.id))",
    ),
    (
        Derived::RunNotes,
        "SELECT (SELECT count(*) FROM run_note n
                WHERE NOT EXISTS (SELECT 1 FROM note_words_docsize w WHERE w.id = n.seq))
            + (SELECT count(*) FROM note_words_docsize w
                WHERE NOT EXISTS (SELECT 1 FROM run_note n WHERE n.seq = w.id))",
    ),
];

/// Compares the derived tables with a recount.
pub(super) fn check(conn: &Connection, mut found: Findings<'_>) -> SqlResult<()> {
    in_snapshot(conn, || Ok(compare(conn, |detail| found.add(detail))?))
}

/// Runs `work` in one snapshot of the file, and rolls the temporary tables back; others may write meanwhile.
pub(super) fn in_snapshot(
    conn: &Connection,
    work: impl FnOnce() -> SqlResult<()>,
) -> SqlResult<()> {
    with_sorting_on_disk(conn, || {
        conn.execute_batch("BEGIN")?;
        let done = work();
        let ended = conn.execute_batch("ROLLBACK");
        // If a statement is interrupted SQLite rolls back by itself: the error of the work is the one to return.
        done.and(ended.map_err(SqlError::from))
    })
}

fn compare(conn: &Connection, mut found: impl FnMut(Damage)) -> rusqlite::Result<()> {
    for (table, named_by) in TABLES {
        conn.execute_batch(&format!(
            "CREATE TEMP TABLE {table} AS SELECT * FROM main.{table} WHERE false"
        ))?;
        if let Some(columns) = named_by {
            conn.execute_batch(&format!(
                "CREATE INDEX temp.{table}_by_name ON {table}({columns})"
            ))?;
        }
    }
    conn.execute_batch(DERIVED)?;
    for (what, sql) in DIFFERENCES {
        let differ: i64 = conn.query_row(sql, [], |row| row.get(0))?;
        if differ > 0 {
            found(Damage::Miscounted(differ, what));
        }
    }
    Ok(())
}

/// Recomputes all derived rows; returns what differed.
pub(super) fn rebuild(store: &Store, at_us: i64) -> Result<Vec<String>, StoreError> {
    const DOING: &str = "filling the derived tables again";
    let conn = store.file()?;
    let id = store.mint()?;
    let file = &store.backend;
    let rebuild = || {
        let mut differed = Vec::new();
        compare(conn, |detail| differed.push(detail.to_string()))?;
        for (table, _) in TABLES {
            conn.execute_batch(&format!("DROP TABLE temp.{table}"))?;
        }
        let mut faults = Vec::new();
        faults_that_differ(file, |fault, id| faults.push((fault, id)))?;
        if let Some((_, id)) = faults.first() {
            let count = faults.len();
            differed.push(format!(
                "{count} faults, first {id}, were not as their occurrences and events say"
            ));
        }
        for (fault, _) in &faults {
            recompute_fault(file, *fault)?;
        }
        if !differed.is_empty() {
            let differed = differed.clone();
            let payload = RecountedPayload { at_us, differed };
            append_statement(file, RECOUNTED, id, &payload)?;
        }
        conn.execute_batch(DERIVED)?;
        conn.execute_batch(WORDS)?;
        Ok(differed)
    };
    let failed = |error| store.failed(DOING, error);
    let written = with_sorting_on_disk(conn, || {
        Ok(store.write(DOING, |_| rebuild().map_err(failed)))
    });
    written.map_err(failed)?
}

/// Lets SQLite sort on disk: a whole history does not fit in memory.
fn with_sorting_on_disk<T>(conn: &Connection, work: impl FnOnce() -> SqlResult<T>) -> SqlResult<T> {
    let kept: i64 = conn.query_row("PRAGMA temp_store", [], |row| row.get(0))?;
    conn.execute_batch("PRAGMA temp_store = FILE")?;
    let done = work();
    conn.execute_batch(&format!("PRAGMA temp_store = {kept}"))?;
    done
}
