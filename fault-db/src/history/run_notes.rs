//! Notes of a user on a run; never changed or deleted.

use serde::Serialize;

use crate::backend::{Backend, Row, SqlResult, from_row, values};
use crate::error::StoreError;
use crate::history::limits;
use crate::id::Id;
use crate::schema::derived_columns::note_words;
use crate::seal;
use crate::signature::signatures_of;
use crate::store::Store;
use crate::values::trace_place::TracePlace;

/// A note on a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RunNote {
    /// The note's id.
    pub id: Id,
    /// When it was written.
    pub at_us: i64,
    /// Author of the note.
    pub who: String,
    /// The place in a trace of the run that the note is about; `None` for a note on the whole run.
    pub place: Option<TracePlace>,
    /// Text of the note.
    pub text: String,
    /// Signer of the note, if the signature is valid; only set where a whole run is read.
    pub signed_by: Option<String>,
}

impl Store {
    /// Adds a note to a run, finished or not.
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
        self.insert_run_note(run, None, who, text, at_us)
    }

    /// Adds a note on a place in a trace, as a note on the trace's run.
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
        self.insert_run_note(run, Some(place), who, text, at_us)
    }

    fn insert_run_note(
        &self,
        run: Id,
        place: Option<TracePlace>,
        who: &str,
        text: &str,
        at_us: i64,
    ) -> Result<(), StoreError> {
        const DOING: &str = "storing a note on a run";
        limits::name("the name of who says it", who)?;
        limits::note("the note", text)?;
        let id = self.mint()?;
        let (trace, place_us) = (place.map(|at| at.trace), place.map(|at| at.at_us));
        self.change(DOING, |_| {
            let seq = self.run_seq(DOING, run)?;
            self.ask(DOING, |backend| match backend {
                Backend::Server(_) => {
                    backend.execute(
                        "INSERT INTO run_note(id, run, at_us, who, trace, place_us, text, words)
                         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, CAST(?8 AS tsvector))",
                        &values![id, seq, at_us, who, trace, place_us, text, note_words(text)],
                    )?;
                    Ok(())
                }
                Backend::File(_) => {
                    backend.execute(
                        "INSERT INTO run_note(id, run, at_us, who, trace, place_us, text)
                         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)",
                        &values![id, seq, at_us, who, trace, place_us, text],
                    )?;
                    let sealed = values![id, run, at_us, who, trace, place_us, text];
                    seal::events_and_notes::note(backend, id, &sealed)
                }
            })
        })
    }

    /// Notes without a valid signature, each with the name of its author.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn unsigned_notes(&self) -> Result<Vec<(Id, String)>, StoreError> {
        const DOING: &str = "looking for notes that are not signed";
        let sql = "SELECT r.id, n.id, n.who FROM run_note n JOIN run r ON r.seq = n.run ORDER BY n.run, n.seq";
        let notes = self.select(DOING, sql, &[], |row| {
            Ok((row.get::<Id>(0)?, row.get::<Id>(1)?, row.get::<String>(2)?))
        })?;
        let mut signed = (None, Vec::new());
        let mut unsigned = Vec::new();
        for (run, note, who) in notes {
            if signed.0 != Some(run) {
                let of_run = self.ask(DOING, |backend| signatures_of(backend, run))?;
                signed = (Some(run), of_run);
            }
            if !signed.1.iter().any(|(_, of)| of.is_about("note", note)) {
                unsigned.push((note, who));
            }
        }
        Ok(unsigned)
    }

    /// The run of a trace.
    ///
    /// # Errors
    /// There is no such trace.
    pub fn run_of_trace(&self, trace: Id) -> Result<Id, StoreError> {
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
        let sql = format!("{NOTES} WHERE n.run = ?1 ORDER BY n.at_us, n.id");
        self.backend.select(&sql, &values![run], note)
    }
}

const NOTES: &str = "SELECT n.at_us, n.who, n.text, n.trace, n.place_us, n.id FROM run_note n";

fn note(row: Row<'_>) -> SqlResult<RunNote> {
    let (trace, at_us) = (row.get::<Option<Id>>(3)?, row.get::<Option<i64>>(4)?);
    Ok(from_row!(row => RunNote:
        at_us, who, text, _, _, id;
        place: trace
            .zip(at_us)
            .map(|(trace, at_us)| TracePlace { trace, at_us }),
        signed_by: None
    ))
}
