//! Notes of a user on a run; never changed or deleted.

use serde::Serialize;

use crate::backend::{Backend, SqlResult, values};
use crate::error::StoreError;
use crate::id::Id;
use crate::limits;
use crate::seal;
use crate::server::derived_columns;
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
    /// Adds a note to a run, whether it has ended or not.
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
        limits::name("the name of who says it", who)?;
        limits::note("the note", text)?;
        let id = self.mint()?;
        self.change(DOING, |backend| {
            let seq: Option<i64> = self.first(
                DOING,
                "SELECT seq FROM run WHERE id = ?1",
                &values![run],
                |row| row.get(0),
            )?;
            let seq = seq.ok_or_else(|| StoreError::not_found("run", run))?;
            let add = || match backend {
                Backend::Server(_) => {
                    derived_columns::insert_run_note(backend, id, seq, at_us, who, text)
                }
                Backend::File(_) => {
                    backend.execute(
                        "INSERT INTO run_note(id, run, at_us, who, text)
                         VALUES (?1, ?2, ?3, ?4, ?5)",
                        &values![id, seq, at_us, who, text],
                    )?;
                    seal::events_and_notes::note(backend, id, &values![id, run, at_us, who, text])
                }
            };
            add().map_err(|error| self.failed(DOING, error))
        })
    }

    /// Notes on the run with this row number, oldest first.
    pub(crate) fn run_notes(&self, run: i64) -> SqlResult<Vec<RunNote>> {
        self.backend().select(
            "SELECT at_us, who, text FROM run_note WHERE run = ?1 ORDER BY at_us, id",
            &values![run],
            |row| {
                Ok(RunNote {
                    at_us: row.get(0)?,
                    who: row.get(1)?,
                    text: row.get(2)?,
                })
            },
        )
    }
}
