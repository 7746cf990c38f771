//! Is a file whole? And a copy of it, made while others write.

use std::path::Path;

use serde::Serialize;

use crate::error::StoreError;
use crate::id::Id;
use crate::store::Store;

/// What a check looked at and found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckReport {
    /// Traces whose checksum and samples were read.
    pub traces: u32,
    /// Recordings that were unpacked and read.
    pub recordings: u32,
    /// What is wrong; empty is good.
    pub problems: Vec<Problem>,
}

/// One thing that is wrong.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Problem {
    /// integrity, foreign_key, trace, recording or count.
    pub kind: &'static str,
    /// Which, and how.
    pub detail: String,
}

/// SQLite stops describing damage after so many findings.
const MAX_FINDINGS: u32 = 100;

impl Store {
    /// Looks for damage: SQLite's own check, foreign keys, every trace and recording, the faults'
    /// counts.
    pub fn check(&self) -> Result<CheckReport, StoreError> {
        let mut problems = Vec::new();
        let failed = |error| self.failed("checking", error);
        let integrity = format!("PRAGMA integrity_check({MAX_FINDINGS})");
        for detail in self.texts(&integrity).map_err(failed)? {
            if detail != "ok" {
                problems.push(Problem {
                    kind: "integrity",
                    detail,
                });
            }
        }
        let foreign =
            "SELECT 'row ' || rowid || ' of ' || \"table\" || ' points at a missing row of '
            || parent FROM pragma_foreign_key_check";
        for detail in self.texts(foreign).map_err(failed)? {
            problems.push(Problem {
                kind: "foreign_key",
                detail,
            });
        }
        let counts =
            "SELECT 'fault ' || hex(f.id) || ' says ' || f.occurrences || ' occurrences, has '
            || n FROM (SELECT f.*, (SELECT count(*) FROM fault_occurrence o WHERE o.fault = f.seq) n
            FROM fault f) f WHERE f.occurrences <> n";
        for detail in self.texts(counts).map_err(failed)? {
            problems.push(Problem {
                kind: "count",
                detail,
            });
        }
        let ids = self.trace_ids().map_err(failed)?;
        let mut traces = 0;
        for id in ids {
            traces += 1;
            match self.trace(id) {
                Ok(_) => {}
                // Another program may prune meanwhile.
                Err(StoreError::NotFound { .. }) => traces -= 1,
                Err(error) => problems.push(Problem {
                    kind: "trace",
                    detail: error.to_string(),
                }),
            }
        }
        let (recordings, wrong) = self.check_recordings().map_err(failed)?;
        problems.extend(wrong.into_iter().map(|detail| Problem {
            kind: "recording",
            detail,
        }));
        Ok(CheckReport {
            traces,
            recordings,
            problems,
        })
    }

    /// Copies the file as it stands now, compacted, while others may write to it.
    pub fn backup(&self, to: &Path) -> Result<(), StoreError> {
        if to.exists() {
            return Err(StoreError::TargetExists {
                path: to.to_path_buf(),
            });
        }
        let Some(name) = to.to_str() else {
            let reason = "the name is not UTF-8".to_owned();
            return Err(StoreError::CannotOpen {
                path: to.to_path_buf(),
                reason,
            });
        };
        let copied = self.conn.execute("VACUUM INTO ?1", [name]);
        // What fails here is the target: the source was readable a moment ago.
        copied
            .map(|_| ())
            .map_err(|error| StoreError::from_sqlite(to, "backing up", error))
    }

    fn texts(&self, sql: &str) -> rusqlite::Result<Vec<String>> {
        self.conn
            .prepare(sql)?
            .query_map([], |row| row.get(0))?
            .collect()
    }

    fn trace_ids(&self) -> rusqlite::Result<Vec<Id>> {
        let mut select = self
            .conn
            .prepare_cached("SELECT id FROM trace ORDER BY seq")?;
        select.query_map([], |row| row.get(0))?.collect()
    }
}
