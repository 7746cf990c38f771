//! Room again: old traces go, and the recordings behind them; runs, verdicts and faults stay for ever.

use rusqlite::params;
use serde::Serialize;

use crate::error::StoreError;
use crate::store::Store;

/// Which traces may go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PruneRule {
    /// Only those recorded before this time.
    pub older_than_us: i64,
    /// Count only.
    pub dry_run: bool,
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
    /// Traces old enough, but kept for a fault that is not closed.
    pub kept_for_faults: u32,
    /// Bytes the file shrank by.
    pub freed_bytes: u64,
}

/// A trace goes when every fault it shows is closed; one that shows none, when its run has no
/// fault that is not closed.
const MAY_GO: &str = "
    NOT EXISTS (SELECT 1 FROM fault_occurrence o JOIN fault f ON f.seq = o.fault
        WHERE o.trace = t.seq AND f.state <> 'closed')
    AND (EXISTS (SELECT 1 FROM fault_occurrence o WHERE o.trace = t.seq)
        OR NOT EXISTS (SELECT 1 FROM fault_occurrence o JOIN fault f ON f.seq = o.fault
            WHERE o.run = t.run AND f.state <> 'closed'))";

impl Store {
    /// Deletes old traces nobody needs any more, and gives the room back.
    pub fn prune(&self, rule: &PruneRule) -> Result<PruneCounts, StoreError> {
        const DOING: &str = "pruning";
        let failed = |error| self.failed(DOING, error);
        let count = format!(
            "SELECT ifnull(sum(go), 0), ifnull(sum(go * size), 0), ifnull(sum(NOT go), 0)
             FROM (SELECT {MAY_GO} AS go, length(t.data) AS size FROM trace t WHERE t.t0_us < ?1)"
        );
        // A recording goes with its last trace.
        let recordings = format!(
            "FROM recording AS r WHERE NOT EXISTS (SELECT 1 FROM trace t WHERE t.run = r.run
                AND t.recording = r.ordinal AND NOT (t.t0_us < ?1 AND {MAY_GO}))"
        );
        let counted = |conn: &rusqlite::Connection| {
            let older_than = [rule.older_than_us];
            let count_recordings = format!("SELECT count(*) {recordings}");
            let recordings = conn.query_row(&count_recordings, older_than, |row| row.get(0))?;
            conn.query_row(&count, older_than, |row| {
                Ok(PruneCounts {
                    traces: row.get(0)?,
                    recordings,
                    trace_bytes: row.get(1)?,
                    kept_for_faults: row.get(2)?,
                    freed_bytes: 0,
                })
            })
        };
        if rule.dry_run {
            return counted(&self.conn).map_err(failed);
        }
        let delete = format!("DELETE FROM trace AS t WHERE t.t0_us < ?1 AND {MAY_GO}");
        let mut counts = self.write(DOING, |conn| {
            let counts = counted(conn).map_err(failed)?;
            conn.execute(&format!("DELETE {recordings}"), params![rule.older_than_us])
                .map_err(failed)?;
            conn.execute(&delete, params![rule.older_than_us])
                .map_err(failed)?;
            Ok(counts)
        })?;
        counts.freed_bytes = self.give_back_room()?;
        Ok(counts)
    }

    /// Returns free pages to the system and says how many bytes that were.
    fn give_back_room(&self) -> Result<u64, StoreError> {
        let give = || {
            let pages = || {
                self.conn
                    .query_row("PRAGMA page_count", [], |row| row.get::<_, u64>(0))
            };
            let before = pages()?;
            // Each step frees one page; run as a batch it would stop after the first.
            let mut vacuum = self.conn.prepare("PRAGMA incremental_vacuum")?;
            let mut steps = vacuum.query([])?;
            while steps.next()?.is_some() {}
            let page_bytes: u64 = self
                .conn
                .query_row("PRAGMA page_size", [], |row| row.get(0))?;
            Ok((before - pages()?) * page_bytes)
        };
        let freed = give().map_err(|error| self.failed("giving room back", error))?;
        self.checkpoint()?;
        Ok(freed)
    }
}
