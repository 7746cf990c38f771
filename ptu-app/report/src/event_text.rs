//! Texts of events in the history of a fault, on the command line and in the window.

use std::borrow::Cow;

use fault_db::{CauseRecord, Correction, FaultDetail, FaultEvent, RepairRecord};
use ptu_runs::clock;

use crate::words::{Words, fill};

/// The part to which a fault was attributed, as `called` names it, `-` if the fault stands alone, and the grounds.
pub fn cause_text(cause: &CauseRecord, called: impl Fn(&str) -> String) -> String {
    let part = match called(&cause.part) {
        none if none.is_empty() => "-".to_owned(),
        part => part,
    };
    let run = cause.run.as_ref().map_or_else(String::new, |run| {
        let percent = 100.0 * cause.probability.unwrap_or_default();
        // As an id is shortened elsewhere: its last digits.
        let id = run.rsplit('-').next().unwrap_or_default();
        let id: String = id.chars().skip(4).collect();
        format!(" ({percent:.1} %, run {id})")
    });
    format!("{part}{run} {}", cause.note).trim_end().to_owned()
}

/// The part that was worked on, as it is called, its serial numbers before and after, and what was done.
pub fn repair_text(repair: &RepairRecord, called: impl Fn(&str) -> String) -> String {
    let serial = |serial: &Option<String>| serial.clone().unwrap_or_else(|| "?".into());
    let (old, new) = (serial(&repair.serial_old), serial(&repair.serial_new));
    format!("{} {old} → {new} {}", called(&repair.part), repair.note)
}

/// The note of an event; what a person wrote stays as it is.
pub fn note_text<'a>(detail: &FaultDetail, event: &'a FaultEvent, words: &Words) -> Cow<'a, str> {
    let mut seen = detail.occurrences.iter();
    match seen.find(|seen| seen.message == event.note) {
        Some(seen) => words.found(&seen.findings, &event.note),
        None => Cow::Borrowed(&event.note),
    }
}

/// When and by whom an event was withdrawn, and why.
pub fn correction_text(correction: &Correction, words: &Words) -> String {
    let (at, who) = (clock::local(correction.at_us), correction.who.as_str());
    let said = fill(words.faults.withdrawn, &[("at", &at), ("who", &who)]);
    format!("{said} {}", correction.note)
}
