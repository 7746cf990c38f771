//! Columns derived from the texts of events and notes: search words, and the part that an event names. In a file
//! triggers fill these columns; for a server they are computed here.

use crate::schema::full_text;
use crate::values::record::{CAUSE, DIAGNOSED, REPAIR, RepairRecord, part_name};

/// Longest text whose words are indexed, bytes: a `tsvector` holds at most one megabyte and positions up to 16 383.
const MOST_TEXT_BYTES: usize = 100_000;

/// The search words of an event, as text of a `tsvector`; `None` for events made by the program.
pub(crate) fn event_words(kind: &str, body: &str) -> Option<String> {
    let has_words = !matches!(kind, "opened" | "recurred") && !body.is_empty();
    has_words.then(|| note_words(&said(body)))
}

/// The search words of a note, as the text of a `tsvector`; of a very long note only its beginning counts.
pub(crate) fn note_words(text: &str) -> String {
    let mut end = text.len().min(MOST_TEXT_BYTES);
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    full_text::for_server(&text[..end])
}

/// The part that an event names, in lower case: a repair the repaired part, an attribution the cause.
pub(crate) fn part(kind: &str, body: &str) -> Option<String> {
    matches!(kind, REPAIR | CAUSE | DIAGNOSED).then(|| part_of(body))
}

/// The text of an event's body: of a repair its fields, one on each line.
pub(crate) fn said(body: &str) -> String {
    match serde_json::from_str::<RepairRecord>(body) {
        Ok(repair) => {
            let serials = [repair.serial_old, repair.serial_new].into_iter().flatten();
            let all = std::iter::once(repair.part)
                .chain(serials)
                .chain([repair.note]);
            all.collect::<Vec<_>>().join("\n")
        }
        Err(_) => body.to_owned(),
    }
}

/// The part named in the body of a repair or an attribution, in lower case; empty if there is none.
pub(crate) fn part_of(body: &str) -> String {
    let repair = serde_json::from_str::<serde_json::Value>(body).unwrap_or_default();
    let part = repair.get("part").and_then(serde_json::Value::as_str);
    part_name(part.unwrap_or_default())
}
