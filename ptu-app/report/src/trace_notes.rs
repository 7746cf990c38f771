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
    /// Time at which the note was written, UTC.
    pub at: String,
    /// Author of the note; on a signed run with whether the note is signed.
    pub who: String,
    pub text: String,
}

impl TraceNote {
    /// All notes on a trace, by their times in the trace.
    ///
    /// # Errors
    /// There is no such trace, or the database fails.
    pub fn all(store: &Store, trace: Id, words: &Words) -> Result<Vec<Self>, StoreError> {
        let run = store.run(store.run_of_trace(trace)?)?;
        let of_trace = (run.notes.iter()).filter_map(|note| {
            let place = note.place.filter(|place| place.trace == trace)?;
            Some(Self {
                time_us: place.at_us,
                at: rfc3339(note.at_us),
                who: noted_by(note, &run, words),
                text: note.text.clone(),
            })
        });
        let mut notes: Vec<_> = of_trace.collect();
        notes.sort_by_key(|note| note.time_us);
        Ok(notes)
    }

    /// Time of the note, as `−0.35 s`.
    pub fn time(&self) -> String {
        time(self.time_us)
    }
}

fn time(time_us: i64) -> String {
    format!("{:.2} s", time_us as f64 / 1e6).replace('-', "−")
}

/// Text of a note on a run, with its place in a trace.
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

/// Author of a note on a run; on a signed run with whether the note is signed.
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
