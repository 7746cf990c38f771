//! Notes at places in traces, as they are shown and written.

use fault_db::{Id, RunDetail, RunNote, Store, StoreError};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::words::{Words, fill};
use ptu_runs::clock::rfc3339;

/// A note at a place in a trace.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TraceNote {
    /// Time from the trigger, or from the first row where there is none; microseconds.
    pub time_us: i64,
    /// When it was written, UTC.
    pub at: String,
    /// Who wrote it.
    pub who: String,
    /// What it says.
    pub text: String,
}

impl TraceNote {
    /// All on a trace, by their places.
    ///
    /// # Errors
    /// There is no such trace, or the database fails.
    pub fn all(store: &Store, trace: Id) -> Result<Vec<Self>, StoreError> {
        let notes = store.trace_notes(trace)?;
        Ok(notes.into_iter().filter_map(Self::of).collect())
    }

    fn of(note: RunNote) -> Option<Self> {
        Some(Self {
            time_us: note.place?.at_us,
            at: rfc3339(note.at_us),
            who: note.who,
            text: note.text,
        })
    }

    /// Its time, as `−0.35 s`.
    pub fn time(&self) -> String {
        time(self.time_us)
    }
}

fn time(time_us: i64) -> String {
    format!("{:.2} s", time_us as f64 / 1e6).replace('-', "−")
}

/// What a note on a run says, with the place in a trace that it is about.
pub fn note_text(note: &RunNote, words: &Words) -> String {
    let Some(place) = note.place else {
        return note.text.clone();
    };
    let (trace, time) = (place.trace.short(), time(place.at_us));
    fill(
        words.traces.note_at,
        &[("trace", &trace), ("time", &time), ("text", &note.text)],
    )
}

/// A note on a run as JSON.
/// Who wrote a note on a run; on a signed one, whether it is signed by that name, too.
pub fn noted_by(note: &RunNote, run: &RunDetail, words: &Words) -> String {
    let who = &note.who;
    match (&run.signature, &note.signed_by) {
        (Some(_), None) => format!("{who} ({})", words.report.unsigned),
        (Some(_), Some(by)) if by.to_lowercase() != who.to_lowercase() => {
            format!("{who} ({} {by})", words.report.signed_by)
        }
        _ => who.clone(),
    }
}

pub(crate) fn note_json(note: &RunNote) -> Value {
    let place = note.place.map(
        |place| json!({ "trace": place.trace.to_string(), "time_s": place.at_us as f64 / 1e6 }),
    );
    json!({ "at": rfc3339(note.at_us), "who": note.who, "text": note.text, "place": place, "signed_by": note.signed_by })
}
