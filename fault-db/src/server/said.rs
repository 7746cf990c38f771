//! What a file's triggers make of what people say, made here for a server, which cannot: the words of
//! a note that a search finds, and the part a repair was of.

use crate::base::{Base, SqlResult, values};
use crate::fault_log::{Known, NewEvent, REPAIR};
use crate::functions;
use crate::id::Id;
use crate::record::{RepairRecord, part_name};
use crate::words;

/// PostgreSQL takes no more than a megabyte of words, and looks no further than the 16 383rd.
const MOST_TEXT_BYTES: usize = 100_000;

/// An event's words, as text of a `tsvector`; none of what the tester itself says.
pub(crate) fn event_words(kind: &str, body: &str) -> Option<String> {
    let said = !matches!(kind, "opened" | "recurred") && !body.is_empty();
    said.then(|| note_words(&functions::said(body)))
}

/// A note's words, as text of a `tsvector`; of a very long one those it begins with.
pub(crate) fn note_words(text: &str) -> String {
    let mut end = text.len().min(MOST_TEXT_BYTES);
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    words::for_server(&text[..end])
}

/// The part a repair was of, lower case.
pub(crate) fn part(kind: &str, body: &str) -> Option<String> {
    let repair = (kind == REPAIR).then(|| serde_json::from_str::<RepairRecord>(body));
    let part = repair?.ok()?.part;
    Some(part_name(&part))
}

/// Adds an event that was said to the server itself, unless it is there.
pub(crate) fn insert_event(
    base: &Base,
    fault: i64,
    event: &NewEvent<'_>,
    known: &Known,
) -> SqlResult<()> {
    base.execute(
        "INSERT INTO fault_event(id, fault, kind, at_us, who, body, state, turn, follows, seen, part, words)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, CAST(?12 AS tsvector))
         ON CONFLICT (id) DO NOTHING",
        &values![
            event.id,
            fault,
            event.kind,
            event.at_us,
            event.who,
            event.body,
            event.state,
            known.turn,
            &known.follows[..],
            known.seen,
            part(event.kind, event.body),
            event_words(event.kind, event.body)
        ],
    )?;
    Ok(())
}

/// Adds a note on a run that was said to the server itself.
pub(crate) fn insert_run_note(
    base: &Base,
    id: Id,
    run: i64,
    at_us: i64,
    who: &str,
    text: &str,
) -> SqlResult<()> {
    base.execute(
        "INSERT INTO run_note(id, run, at_us, who, text, words)
         VALUES (?1, ?2, ?3, ?4, ?5, CAST(?6 AS tsvector))",
        &values![id, run, at_us, who, text, note_words(text)],
    )?;
    Ok(())
}
