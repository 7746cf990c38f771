//! Entries of the unit's log and refusals of automatic mode, as text.

use protocol::event::Event;
use protocol::message::Refusals;

use crate::procedure::describe::meanings;
use crate::procedure::event_text;

/// Preconditions of automatic mode that do not hold.
pub(super) fn refusals(bits: u16) -> String {
    meanings(&Refusals::SPEC, bits)
}

/// An entry of the unit's log: its name, and what its parameter says.
pub(super) fn described(event: u16, number: i32) -> String {
    let Some(known) = Event::from_code(event) else {
        return format!("event {event}, parameter {number}");
    };
    let said = event_text::parameter(known, number);
    match known {
        Event::ModeChanged => format!("mode {said}"),
        _ if said.is_empty() => known.definition().name.into(),
        _ => format!("{}: {said}", known.definition().name),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_is_its_name_and_what_its_parameter_says() {
        for (event, parameter, words) in [
            (Event::AtoFailed, 7, "ato_failed: not following"),
            (Event::ModeChanged, 4, "mode automatic_run"),
            (Event::PowerUp, 0, "power_up"),
        ] {
            assert_eq!(described(event.definition().code, parameter), words);
        }
        assert_eq!(described(9999, 3), "event 9999, parameter 3");
    }
}
