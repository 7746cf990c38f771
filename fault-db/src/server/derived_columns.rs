//! Columns derived from the text of events and notes: search words, and the part that a repair replaced.
//! In a file triggers fill them; for a server they are computed here.

use crate::full_text;
use crate::record::{CAUSE, DIAGNOSED, REPAIR};
use crate::sql_functions;

/// PostgreSQL limits a `tsvector` to one megabyte, and positions to 16 383.
const MOST_TEXT_BYTES: usize = 100_000;

/// The search words of an event, as text of a `tsvector`; `None` for events made by the program.
pub(crate) fn event_words(kind: &str, body: &str) -> Option<String> {
    let said = !matches!(kind, "opened" | "recurred") && !body.is_empty();
    said.then(|| note_words(&sql_functions::said(body)))
}

/// The search words of a note, as text of a `tsvector`; of a very long note those of its beginning.
pub(crate) fn note_words(text: &str) -> String {
    let mut end = text.len().min(MOST_TEXT_BYTES);
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    full_text::for_server(&text[..end])
}

/// The part that an event names, in lower case: a repair the one replaced, an attribution the cause.
pub(crate) fn part(kind: &str, body: &str) -> Option<String> {
    matches!(kind, REPAIR | CAUSE | DIAGNOSED).then(|| sql_functions::part_of(body))
}
