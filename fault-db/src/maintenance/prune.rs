//! Frees space: deletes old traces and their recordings. Runs, verdicts and faults are never deleted.

use rusqlite::{Connection, params};
use serde::Serialize;

use crate::backend::{Backend, SqlResult, from_row};
use crate::error::StoreError;
use crate::id::Id;
use crate::seal::{PRUNED, PrunedPayload, append_statement, hex, trace};
use crate::store::Store;

/// Which traces may be deleted. A trace of a fault that is not closed is never deleted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PruneRule {
    /// Only traces recorded before this time, µs since 1970.
    pub older_than_us: Option<i64>,
    /// Only traces of runs that passed.
    pub passed_only: bool,
    /// Only as many traces, the oldest first, as bring the file down to this size, bytes.
    pub max_file_bytes: Option<u64>,
    /// Keep traces that are still to be sent to a server with which this file is synced.
    pub keep_unsent: bool,
    /// Count only.
    pub dry_run: bool,
    /// Time of the deletion for its seals, µs since 1970.
    pub at_us: i64,
}

impl Default for PruneRule {
    /// Every trace that is not needed and not waiting for a server.
    fn default() -> Self {
        Self {
            older_than_us: None,
            passed_only: false,
            max_file_bytes: None,
            keep_unsent: true,
            dry_run: false,
            at_us: 0,
        }
    }
}

/// The result of a prune.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PruneCounts {
    /// Traces deleted.
    pub traces: u32,
    /// Recordings deleted with the last trace cut from them.
    pub recordings: u32,
    /// Bytes of samples in the deleted traces.
    pub trace_bytes: u64,
    /// Traces matching the rule, but kept for a fault that is not closed.
    pub kept_for_faults: u32,
    /// Traces matching the rule, but kept because they are still to be sent.
    pub kept_unsent: u32,
    /// Bytes by which the file shrank.
    pub freed_bytes: u64,
    /// Bytes by which the file still exceeds the limit; 0 if it fits, or no limit was given.
    pub over_bytes: u64,
}

/// SQL: trace `t` may be deleted if every fault it shows is closed; a trace that shows none, if every fault of its run
/// is closed.
const MAY_GO: &str = "
    NOT EXISTS (SELECT 1 FROM fault_occurrence o JOIN fault f ON f.seq = o.fault
        WHERE o.trace = t.seq AND f.state <> 'closed')
    AND (EXISTS (SELECT 1 FROM fault_occurrence o WHERE o.trace = t.seq)
        OR NOT EXISTS (SELECT 1 FROM fault_occurrence o JOIN fault f ON f.seq = o.fault
            WHERE o.run = t.run AND f.state <> 'closed'))";

/// SQL: trace `t` is still to be sent to a server. Traces of interrupted runs count, too: the next sync puts them into
/// the outbox.
const UNSENT: &str = "
    t.seq IN (SELECT row FROM outbox
        WHERE what = 'trace' AND seq > (SELECT min(sent_traces) FROM sync_server))
    OR r.verdict IS NULL AND EXISTS (SELECT 1 FROM sync_server)
        AND t.seq NOT IN (SELECT row FROM outbox WHERE what = 'trace')";

/// `fate` of a trace that matches the rule, in the temporary table `pruned`: deleted, or kept for one of three reasons.
const GOES: i64 = 0;
const FOR_FAULT: i64 = 1;
const IS_UNSENT: i64 = 2;
const FITS: i64 = 3;

/// Approximate bytes of a seal of a deletion.
const SAID_BYTES: i64 = 512;

/// SQL from `FROM` on: recordings from which no remaining trace was cut.
const RECORDINGS: &str = "
    FROM recording AS r WHERE NOT EXISTS (SELECT 1 FROM trace t
        WHERE t.run = r.run AND t.recording = r.ordinal
            AND t.seq NOT IN (SELECT seq FROM temp.pruned WHERE fate = 0))";

impl Store {
    /// Deletes old traces that are not needed any more, and shrinks the file.
    pub fn prune(&self, rule: &PruneRule) -> Result<PruneCounts, StoreError> {
        const DOING: &str = "pruning";
        let failed = |error| self.failed(DOING, error);
        if rule.dry_run {
            return plan(self.file()?, rule).map_err(failed);
        }
        let mut all = PruneCounts::default();
        // The seals of the deletions take room, too.
        let pages_before = pragma(self.file()?, "page_count").map_err(failed)?;
        loop {
            let counts = self.write(DOING, |conn| {
                let counts = plan(conn, rule).map_err(failed)?;
                self.ask(DOING, |file| seal_deleted(file, rule.at_us))?;
                delete(conn).map_err(failed)?;
                Ok(counts)
            })?;
            all = PruneCounts {
                traces: all.traces + counts.traces,
                recordings: all.recordings + counts.recordings,
                trace_bytes: all.trace_bytes + counts.trace_bytes,
                over_bytes: over(self.file()?, rule).map_err(failed)?,
                ..counts
            };
            // The size of a trace in the file is estimated; another round may be needed.
            if all.over_bytes == 0 || counts.traces == 0 {
                break;
            }
        }
        all.freed_bytes = self.give_back_room(pages_before)?;
        Ok(all)
    }

    /// Returns free pages to the file system; bytes by which the file shrank.
    fn give_back_room(&self, pages_before: u64) -> Result<u64, StoreError> {
        let conn = self.file()?;
        let give = || -> rusqlite::Result<u64> {
            // Each step frees one page; `execute_batch` would stop after the first.
            let mut vacuum = conn.prepare("PRAGMA incremental_vacuum")?;
            let mut steps = vacuum.query([])?;
            while steps.next()?.is_some() {}
            // The file may even have grown: another program may have recorded more than was freed.
            let freed = pages_before.saturating_sub(pragma(conn, "page_count")?);
            Ok(freed * pragma(conn, "page_size")?)
        };
        let freed = give().map_err(|error| self.failed("giving room back", error))?;
        self.checkpoint()?;
        Ok(freed)
    }
}

/// Decides what happens to each trace matching the rule, and counts.
fn plan(conn: &Connection, rule: &PruneRule) -> rusqlite::Result<PruneCounts> {
    conn.execute_batch(
        "DROP TABLE IF EXISTS temp.pruned;
         CREATE TEMP TABLE pruned(seq INTEGER PRIMARY KEY, t0_us INTEGER, size INTEGER, fate INTEGER)",
    )?;
    let sort = format!(
        "INSERT INTO temp.pruned
         SELECT t.seq, t.t0_us, length(t.data),
            CASE WHEN NOT ({MAY_GO}) THEN {FOR_FAULT}
                WHEN ?3 AND ({UNSENT}) THEN {IS_UNSENT} ELSE {GOES} END
         FROM trace t JOIN run r ON r.seq = t.run
         WHERE (?1 IS NULL OR t.t0_us < ?1) AND (NOT ?2 OR r.verdict = 'passed')"
    );
    conn.execute(
        &sort,
        params![rule.older_than_us, rule.passed_only, rule.keep_unsent],
    )?;
    let over_bytes = over(conn, rule)?;
    if rule.max_file_bytes.is_some() {
        // Deletes the oldest traces until their size in whole pages suffices.
        let page_bytes = pragma(conn, "page_size")?;
        conn.execute(
            &format!(
                "UPDATE temp.pruned SET fate = {FITS} WHERE seq IN (
                    SELECT seq FROM (SELECT seq, sum((size / ?1 + 1) * ?1 - {SAID_BYTES}) OVER (
                            ORDER BY t0_us, seq
                            ROWS BETWEEN UNBOUNDED PRECEDING AND 1 PRECEDING) AS bytes_before
                        FROM temp.pruned WHERE fate = {GOES})
                    WHERE coalesce(bytes_before, 0) >= ?2)"
            ),
            params![page_bytes, over_bytes],
        )?;
    }
    let recordings = conn.query_row(&format!("SELECT count(*) {RECORDINGS}"), [], |row| {
        row.get(0)
    })?;
    let count = format!(
        "SELECT coalesce(sum(fate = {GOES}), 0), coalesce(sum((fate = {GOES}) * size), 0),
            coalesce(sum(fate = {FOR_FAULT}), 0), coalesce(sum(fate = {IS_UNSENT}), 0) FROM temp.pruned"
    );
    conn.query_row(&count, [], |row| {
        let trace_bytes: u64 = row.get(1)?;
        Ok(from_row!(row => PruneCounts:
            traces, _, kept_for_faults, kept_unsent;
            recordings,
            trace_bytes,
            freed_bytes: 0,
            over_bytes: over_bytes.saturating_sub(trace_bytes)
        ))
    })
}

/// Seals the deletion of each trace and recording, with the digest that the seal of its run has.
fn seal_deleted(backend: &Backend, at_us: i64) -> SqlResult<()> {
    let recordings = format!("SELECT u.id, r.run, r.ordinal {RECORDINGS}");
    let recordings = recordings.replace("AS r WHERE", "AS r JOIN run u ON u.seq = r.run WHERE");
    let mut deleted = backend.select(&recordings, &[], |row| {
        let run = row.get::<Id>(0)?;
        Ok((run, run, row.get(1)?, Some(row.get(2)?)))
    })?;
    let traces = format!(
        "SELECT t.id, r.id, t.seq FROM temp.pruned p JOIN trace t ON t.seq = p.seq
            JOIN run r ON r.seq = t.run WHERE p.fate = {GOES} ORDER BY t.seq"
    );
    deleted.extend(backend.select(&traces, &[], |row| {
        Ok((row.get::<Id>(0)?, row.get::<Id>(1)?, row.get(2)?, None))
    })?);
    for (id, run, row, recording) in deleted {
        let digest = match recording {
            Some(ordinal) => trace::recording_digest(backend, row, ordinal)?,
            None => trace::digest(backend, row)?,
        };
        let payload = PrunedPayload {
            run: run.to_string(),
            sha256: hex(&digest),
            recording,
            at_us,
        };
        append_statement(backend, PRUNED, id, &payload)?;
    }
    Ok(())
}

fn delete(conn: &Connection) -> rusqlite::Result<()> {
    conn.execute(&format!("DELETE {RECORDINGS}"), [])?;
    let traces =
        format!("DELETE FROM trace WHERE seq IN (SELECT seq FROM temp.pruned WHERE fate = {GOES})");
    conn.execute(&traces, [])?;
    conn.execute_batch("DROP TABLE temp.pruned")
}

/// Bytes by which the file exceeds the limit, not counting its free pages.
fn over(conn: &Connection, rule: &PruneRule) -> rusqlite::Result<u64> {
    let Some(max_file_bytes) = rule.max_file_bytes else {
        return Ok(0);
    };
    let pages = pragma(conn, "page_count")?.saturating_sub(pragma(conn, "freelist_count")?);
    Ok((pages * pragma(conn, "page_size")?).saturating_sub(max_file_bytes))
}

fn pragma(conn: &Connection, name: &str) -> rusqlite::Result<u64> {
    conn.query_row(&format!("PRAGMA {name}"), [], |row| row.get(0))
}
