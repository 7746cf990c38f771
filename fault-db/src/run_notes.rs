//! Notes of a user on a run; never changed or deleted.

use serde::Serialize;

use crate::backend::{Backend, SqlResult, values};
use crate::error::StoreError;
use crate::id::Id;
use crate::limits;
use crate::seal;
use crate::server::derived_columns;
use crate::store::Store;
use crate::trace_place::TracePlace;

/// A note on a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RunNote {
    /// When it was written.
    pub at_us: i64,
    /// Who wrote it.
    pub who: String,
    /// The place in a trace of the run that it is about.
    pub place: Option<TracePlace>,
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

    /// Adds a note to a place in a trace; it is a note on the run of the trace.
    ///
    /// # Errors
    /// There is no such trace, or the note cannot be written.
    pub fn add_trace_note(
        &self,
        place: TracePlace,
        who: &str,
        text: &str,
        at_us: i64,
    ) -> Result<(), StoreError> {
        let run = self.run_of_trace(place.trace)?;
        self.add_run_note(run, who, &place.before(text), at_us)
    }

    /// Notes at places in a trace, by their places.
    ///
    /// # Errors
    /// There is no such trace, or the notes cannot be read.
    pub fn trace_notes(&self, trace: Id) -> Result<Vec<RunNote>, StoreError> {
        const DOING: &str = "reading the notes on a trace";
        let run = self.run_of_trace(trace)?;
        let notes = self
            .backend()
            .first("SELECT seq FROM run WHERE id = ?1", &values![run], |row| {
                row.get(0)
            })
            .and_then(|seq| seq.map_or(Ok(Vec::new()), |seq| self.run_notes(seq)));
        let mut notes = notes.map_err(|error| self.failed(DOING, error))?;
        notes.retain(|note| note.place.is_some_and(|place| place.trace == trace));
        notes.sort_by_key(|note| note.place.map(|place| place.at_us));
        Ok(notes)
    }

    fn run_of_trace(&self, trace: Id) -> Result<Id, StoreError> {
        let run = self.first(
            "looking for the run of a trace",
            "SELECT r.id FROM trace t JOIN run r ON r.seq = t.run WHERE t.id = ?1",
            &values![trace],
            |row| row.get(0),
        )?;
        run.ok_or_else(|| StoreError::not_found("trace", trace))
    }

    /// Notes on the run with this row number, oldest first.
    pub(crate) fn run_notes(&self, run: i64) -> SqlResult<Vec<RunNote>> {
        self.backend().select(
            "SELECT at_us, who, text FROM run_note WHERE run = ?1 ORDER BY at_us, id",
            &values![run],
            |row| {
                let stored: String = row.get(2)?;
                let (place, text) = match TracePlace::split(&stored) {
                    Some((place, text)) => (Some(place), text.to_owned()),
                    None => (None, stored),
                };
                Ok(RunNote {
                    at_us: row.get(0)?,
                    who: row.get(1)?,
                    place,
                    text,
                })
            },
        )
    }
}
