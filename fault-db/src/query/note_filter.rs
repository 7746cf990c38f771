//! Conditions on the text of events and notes, as SQL for either backend.

use super::filter::Conditions;
use crate::backend::Backend;
use crate::history::graph_sql::standing;
use crate::schema::full_text::Search;

/// SQL: the faults with these words in the text of an event.
pub(super) fn faults_with_note(backend: &Backend, search: &Search, all: &mut Conditions) -> String {
    match backend {
        Backend::File(_) => {
            let place = all.place(search.for_file());
            format!(
                "SELECT e.fault FROM event_words w JOIN fault_event e ON e.seq = w.rowid
                 WHERE event_words MATCH {place}{}",
                standing!("e")
            )
        }
        Backend::Server(_) => {
            let place = all.place(search.for_server());
            format!(
                "SELECT e.fault FROM fault_event e WHERE e.words @@ CAST({place} AS tsquery){}",
                standing!("e")
            )
        }
    }
}

/// SQL: whether a fault has an event with these words.
pub(super) fn has_note(fault: &str, typed: String, all: &mut Conditions) -> String {
    let place = all.place(typed);
    format!(
        "EXISTS (SELECT 1 FROM fault_event e WHERE e.fault = {fault}
            AND e.kind NOT IN ('opened', 'recurred') AND says(e.body, {place}){})",
        standing!("e")
    )
}

/// SQL: whether a fault was seen by a run with these words in a note.
pub(super) fn has_run_note(fault: &str, typed: String, all: &mut Conditions) -> String {
    let place = all.place(typed);
    format!(
        "EXISTS (SELECT 1 FROM fault_occurrence o JOIN run_note n ON n.run = o.run
            WHERE o.fault = {fault} AND says(n.text, {place}))"
    )
}

/// SQL: the faults seen by runs with these words in a note.
pub(super) fn faults_with_run_note(
    backend: &Backend,
    search: &Search,
    all: &mut Conditions,
) -> String {
    match backend {
        Backend::File(_) => {
            let place = all.place(search.for_file());
            format!(
                "SELECT o.fault FROM note_words w JOIN run_note n ON n.seq = w.rowid
                 JOIN fault_occurrence o ON o.run = n.run WHERE note_words MATCH {place}"
            )
        }
        Backend::Server(_) => {
            let place = all.place(search.for_server());
            format!(
                "SELECT o.fault FROM run_note n JOIN fault_occurrence o ON o.run = n.run
                 WHERE n.words @@ CAST({place} AS tsquery)"
            )
        }
    }
}

/// SQL: the faults with a repair that took out or put in a part of this serial number, found by its words, then
/// compared in full.
pub(super) fn repaired_with(backend: &Backend, serial: &str, all: &mut Conditions) -> String {
    let Some(search) = Search::exactly(serial) else {
        return "SELECT seq FROM fault WHERE 1 = 0".to_owned();
    };
    let with_words = faults_with_note(backend, &search, all);
    let places = ["serial_old", "serial_new"].map(|key| {
        let quoted = serde_json::Value::from(serial).to_string();
        all.place(format!("\"{key}\":{quoted}"))
    });
    let [old, new] = places;
    format!(
        "{with_words} AND e.kind = 'repair'
            AND (replace(e.body, {old}, '') <> e.body OR replace(e.body, {new}, '') <> e.body)"
    )
}
