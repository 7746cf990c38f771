//! Names of events, parts, signals and measurements within a text, as people say them.
//!
//! Texts are stored with the names that scripts and programs write: `eb_relay`, `self_test_failed`.

use std::borrow::Cow;
use std::sync::LazyLock;

use protocol::event::Event;
use protocol::injection::{FaultCatalogue, Lru};
use protocol::signal::Signal;

use crate::naming::spoken;

/// The parts of the catalogue that is built in; one that only a depot's own catalogue has goes by its identifier here.
static PARTS: LazyLock<Vec<Lru>> = LazyLock::new(|| {
    let catalogue = include_str!("../../../../scripts/units/faults.toml");
    FaultCatalogue::from_toml(catalogue).map_or_else(|_| Vec::new(), |all| all.lrus)
});

fn part(id: &str) -> Option<&'static Lru> {
    PARTS.iter().find(|part| part.id == id)
}

/// What a part is called in English.
pub(super) fn english_part(id: &str) -> &str {
    part(id).map_or(id, |part| &part.name)
}

/// What a part is called in Korean.
pub(super) fn korean_part(id: &str) -> &str {
    part(id).map_or(id, |part| &part.name_ko)
}

/// An English text with names of several words as people say them: "self-test failed, which points at the EB relay". Names
/// within the path of a script or of a file stay, and so does what is no name that is known here: a step may be called as
/// its script likes.
pub(super) fn english(text: &str) -> Cow<'_, str> {
    if !text.contains('_') {
        return Cow::Borrowed(text);
    }
    let is_of_name = |c: char| c.is_ascii_alphanumeric() || "_./".contains(c);
    let mut said = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find(is_of_name) {
        let (before, from) = rest.split_at(start);
        let end = from.find(|c| !is_of_name(c)).unwrap_or(from.len());
        let (name, after) = from.split_at(end);
        said += before;
        let is_state = [" = ", " ≠ "].iter().any(|sign| before.ends_with(sign));
        match english_name(name, after, is_state) {
            Some(name) => said += &name,
            None => said += name,
        }
        rest = after;
    }
    said += rest;
    Cow::Owned(said)
}

fn english_name(name: &str, after: &str, is_state: bool) -> Option<String> {
    if !name.contains('_') {
        return None;
    }
    if let Some(part) = part(name) {
        return Some(part.name.clone());
    }
    if let Some(item) = super::ENGLISH.bench.self_test_item(name) {
        return Some(item);
    }
    let is_sign = after.starts_with(", which points at ");
    if let Some(event) = Event::from_name(name).filter(|_| is_sign) {
        return Some(within_a_sentence(event.definition().text));
    }
    let is_measured = [" = ", ": no value", ": no data"];
    let is_known = Event::from_name(name).is_some()
        || Signal::from_name(name).is_some()
        || is_measured.iter().any(|sign| after.starts_with(sign));
    let is_spoken = is_known || is_state || is_sign;
    (is_spoken && !name.contains(['/', '.'])).then(|| spoken(name))
}

/// A text without the capital it begins with, unless that is of a word in capitals.
pub(super) fn within_a_sentence(text: &str) -> String {
    let mut letters = text.chars();
    match (letters.next(), letters.clone().next()) {
        (Some(first), Some(second)) if second.is_lowercase() => {
            first.to_lowercase().chain(letters).collect()
        }
        _ => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_said_and_paths_and_names_of_steps_stay() {
        for (text, said) in [
            (
                "atp/power_up: no_code: at rest failed (under this fault 100 %, healthy 0 %), with brake_applied, which points at the eb_relay",
                "atp/power_up: no_code: at rest failed (under this fault 100 %, healthy 0 %), with brake applied, which points at the EB relay",
            ),
            (
                "the unit's log has self_test_failed, which points at the eb_relay",
                "the unit's log has self-test failed, which points at the EB relay",
            ),
            (
                "eb_reaction = 640, allowed at most 472 ms; self_test.eb_relay = 410",
                "EB reaction = 640, allowed at most 472 ms; Self-test: EB relay = 410",
            ),
            (
                "the unit logged self_test_failed (101, TRA), no data for twc_answer_train; mode = automatic_run",
                "the unit logged self test failed (101, TRA), no data for TWC answer train; mode = automatic run",
            ),
            ("what a_person wrote", "what a_person wrote"),
        ] {
            assert_eq!(english(text), said);
        }
    }
}
