//! What the tester has to say about a run: kept for good, never changed.

use rusqlite::params;
use serde::Serialize;

use crate::error::StoreError;
use crate::id::Id;
use crate::store::Store;

/// A note on a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RunNote {
    /// When it was written.
    pub at_us: i64,
    /// Who wrote it.
    pub who: String,
    /// What it says.
    pub text: String,
}

impl Store {
    /// Adds a note to a run, whether the run has ended or not.
    ///
    /// # Errors
    /// There is no such run, or the note cannot be written.
    pub fn add_run_note(
        &self,
        run: Id,
        who: &str,
        text: &str,
        at_us: i64,
    ) -> Result<(), StoreError> {
        const DOING: &str = "storing a note on a run";
        let id = self.mint()?;
        self.write(DOING, |conn| {
            let seq: i64 = conn
                .prepare_cached("SELECT seq FROM run WHERE id = ?1")
                .and_then(|mut select| select.query_row([run], |row| row.get(0)))
                .map_err(|error| self.not_found("run", run, error))?;
            conn.prepare_cached(
                "INSERT INTO run_note(id, run, at_us, who, text) VALUES (?1, ?2, ?3, ?4, ?5)",
            )
            .and_then(|mut insert| insert.execute(params![id, seq, at_us, who, text]))
            .map_err(|error| self.failed(DOING, error))?;
            Ok(())
        })
    }

    /// Notes on the run of this number, oldest first.
    pub(crate) fn run_notes(&self, run: i64) -> rusqlite::Result<Vec<RunNote>> {
        self.conn
            .prepare_cached(
                "SELECT at_us, who, text FROM run_note WHERE run = ?1 ORDER BY at_us, id",
            )?
            .query_map([run], |row| {
                Ok(RunNote {
                    at_us: row.get(0)?,
                    who: row.get(1)?,
                    text: row.get(2)?,
                })
            })?
            .collect()
    }
}
