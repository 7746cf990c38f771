//! Room again: old traces go, and the recordings behind them; runs, verdicts and faults stay for ever.

use rusqlite::{Connection, params};
use serde::Serialize;

use crate::base::{Base, SqlResult};
use crate::error::StoreError;
use crate::id::Id;
use crate::seal::{PRUNED, PrunedSays, hex, state, trace};
use crate::store::Store;

/// Which traces may go. One that shows a fault that is not closed never does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PruneRule {
    /// Only those recorded before this time.
    pub older_than_us: Option<i64>,
    /// Only those of runs that passed.
    pub passed_only: bool,
    /// Only as many, the oldest first, as the file is larger than this.
    pub max_file_bytes: Option<u64>,
    /// Not those that wait to be sent to the server this file is brought to; without a server none waits.
    pub keep_unsent: bool,
    /// Count only.
    pub dry_run: bool,
    /// When: it is sealed what was deleted then.
    pub at_us: i64,
}

impl Default for PruneRule {
    /// Every trace that nobody needs and no server waits for.
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

/// What went.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PruneCounts {
    /// Traces deleted.
    pub traces: u32,
    /// Recordings deleted with the last trace cut from them.
    pub recordings: u32,
    /// Bytes of samples in them.
    pub trace_bytes: u64,
    /// Traces the rule would let go, but kept for a fault that is not closed.
    pub kept_for_faults: u32,
    /// Traces the rule would let go, but kept because they wait to be sent.
    pub kept_unsent: u32,
    /// Bytes the file shrank by.
    pub freed_bytes: u64,
    /// Bytes the file is still larger than it may be; 0 if it fits, or no limit was given.
    pub over_bytes: u64,
}

/// A trace goes when every fault it shows is closed; one that shows none, when its run has no
/// fault that is not closed.
const MAY_GO: &str = "
    NOT EXISTS (SELECT 1 FROM fault_occurrence o JOIN fault f ON f.seq = o.fault
        WHERE o.trace = t.seq AND f.state <> 'closed')
    AND (EXISTS (SELECT 1 FROM fault_occurrence o WHERE o.trace = t.seq)
        OR NOT EXISTS (SELECT 1 FROM fault_occurrence o JOIN fault f ON f.seq = o.fault
            WHERE o.run = t.run AND f.state <> 'closed'))";

/// A trace that one of the servers has not been sent, if there is any: those of a run that was broken off
/// wait for the next sync to find out that it was.
const UNSENT: &str = "
    t.seq IN (SELECT row FROM outbox
        WHERE what = 'trace' AND seq > (SELECT min(sent_traces) FROM sync_server))
    OR r.verdict IS NULL AND EXISTS (SELECT 1 FROM sync_server)
        AND t.seq NOT IN (SELECT row FROM outbox WHERE what = 'trace')";

/// Traces under the rule, in a temporary table, by what becomes of them.
const GOES: i64 = 0;
const FOR_FAULT: i64 = 1;
const IS_UNSENT: i64 = 2;
const FITS: i64 = 3;

/// About as many bytes the statement takes that a trace was deleted.
const SAID_BYTES: i64 = 512;

/// Recordings that no trace which stays was cut from.
const RECORDINGS: &str = "
    FROM recording AS r WHERE NOT EXISTS (SELECT 1 FROM trace t
        WHERE t.run = r.run AND t.recording = r.ordinal
            AND t.seq NOT IN (SELECT seq FROM temp.pruned WHERE fate = 0))";

impl Store {
    /// Deletes old traces nobody needs any more, and gives the room back.
    pub fn prune(&self, rule: &PruneRule) -> Result<PruneCounts, StoreError> {
        const DOING: &str = "pruning";
        let failed = |error| self.failed(DOING, error);
        if rule.dry_run {
            return plan(self.file()?, rule).map_err(failed);
        }
        let mut all = PruneCounts::default();
        // What is said of each trace takes room, too.
        let pages_before = pragma(self.file()?, "page_count").map_err(failed)?;
        loop {
            let counts = self.write(DOING, |conn| {
                let counts = plan(conn, rule).map_err(failed)?;
                let sealed = seal_deleted(self.base(), rule.at_us);
                sealed.map_err(|error| self.failed(DOING, error))?;
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
            // What a trace takes in the file is reckoned; it may take one more round.
            if all.over_bytes == 0 || counts.traces == 0 {
                break;
            }
        }
        all.freed_bytes = self.give_back_room(pages_before)?;
        Ok(all)
    }

    /// Returns free pages to the system and says by how many bytes the file is smaller than it was.
    fn give_back_room(&self, pages_before: u64) -> Result<u64, StoreError> {
        let conn = self.file()?;
        let give = || -> rusqlite::Result<u64> {
            // Each step frees one page; run as a batch it would stop after the first.
            let mut vacuum = conn.prepare("PRAGMA incremental_vacuum")?;
            let mut steps = vacuum.query([])?;
            while steps.next()?.is_some() {}
            // Somebody may have recorded more meanwhile than was given back.
            let freed = pages_before.saturating_sub(pragma(conn, "page_count")?);
            Ok(freed * pragma(conn, "page_size")?)
        };
        let freed = give().map_err(|error| self.failed("giving room back", error))?;
        self.checkpoint()?;
        Ok(freed)
    }
}

/// Sorts the traces under the rule by what becomes of them, and counts.
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
        // The oldest, until what they take in whole pages is enough.
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
        Ok(PruneCounts {
            traces: row.get(0)?,
            recordings,
            trace_bytes,
            kept_for_faults: row.get(2)?,
            kept_unsent: row.get(3)?,
            freed_bytes: 0,
            over_bytes: over_bytes.saturating_sub(trace_bytes),
        })
    })
}

/// Says of each trace and recording that is about to go what it was: their runs are sealed with them.
fn seal_deleted(base: &Base, at_us: i64) -> SqlResult<()> {
    let recordings = format!("SELECT u.id, r.run, r.ordinal {RECORDINGS}");
    let recordings = recordings.replace("AS r WHERE", "AS r JOIN run u ON u.seq = r.run WHERE");
    let recordings = base.select(&recordings, &[], |row| {
        Ok((row.get::<Id>(0)?, row.get(1)?, row.get(2)?))
    })?;
    for (id, run, ordinal) in recordings {
        let says = PrunedSays {
            run: id.to_string(),
            sha256: hex(&trace::recording_digest(base, run, ordinal)?),
            recording: Some(ordinal),
            at_us,
        };
        state(base, PRUNED, id, &says)?;
    }
    let traces = format!(
        "SELECT t.id, r.id, t.seq FROM temp.pruned p JOIN trace t ON t.seq = p.seq
            JOIN run r ON r.seq = t.run WHERE p.fate = {GOES} ORDER BY t.seq"
    );
    let traces = base.select(&traces, &[], |row| {
        Ok((row.get::<Id>(0)?, row.get::<Id>(1)?, row.get(2)?))
    })?;
    for (id, run, seq) in traces {
        let says = PrunedSays {
            run: run.to_string(),
            sha256: hex(&trace::digest(base, seq)?),
            recording: None,
            at_us,
        };
        state(base, PRUNED, id, &says)?;
    }
    Ok(())
}

/// Deletes what was planned.
fn delete(conn: &Connection) -> rusqlite::Result<()> {
    conn.execute(&format!("DELETE {RECORDINGS}"), [])?;
    let traces =
        format!("DELETE FROM trace WHERE seq IN (SELECT seq FROM temp.pruned WHERE fate = {GOES})");
    conn.execute(&traces, [])?;
    conn.execute_batch("DROP TABLE temp.pruned")
}

/// Bytes the file would be larger than it may be, if it gave back its free pages.
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
