//! Entries of the unit's log and refusals of automatic mode, as text.

use protocol::event::Event;
use protocol::message::{AbsurdInputs, ArmRefusal, AtoFailure, Channel, Mode, Refusals, SelfTest};

use crate::procedure::describe::meanings as set;

/// Preconditions of automatic mode that do not hold.
pub(super) fn refusals(bits: u16) -> String {
    set(&Refusals::SPEC, bits)
}

/// An entry of the unit's log: its name, and its parameter by name or with its unit.
pub(super) fn described(event: u16, number: i32) -> String {
    let Some(known) = Event::from_code(event) else {
        return format!("event {event}, parameter {number}");
    };
    let definition = known.definition();
    let (code, bits) = (number as u8, number as u16);
    let name = definition.name;
    match known {
        Event::ModeChanged => format!("mode {}", Mode::from_code(code).label()),
        Event::AtoFailed => format!("{name}: {}", plain(AtoFailure::from_code(code).label())),
        Event::ArmingLapsed => format!("{name}: {}", plain(ArmRefusal::from_code(code).label())),
        Event::AutomaticRefused => format!("{name}: {}", refusals(bits)),
        Event::AtoInputAbsurd => format!("{name}: {}", set(&AbsurdInputs::SPEC, bits)),
        Event::SelfTestFailed => format!("{name}: {}", set(&SelfTest::SPEC, bits)),
        Event::FramesRejected => match Channel::from_code(code) {
            Some(channel) => format!("{name}: channel {channel:?}"),
            None => format!("{name}: channel {number}"),
        },
        _ if definition.parameter.starts_with("car") => match number {
            0 => format!("{name}: all cars"),
            car => format!("{name}: car {car}"),
        },
        _ if definition.parameter.is_empty() => name.into(),
        _ => format!("{name}: {}", measured(definition.parameter, number)),
    }
}

/// A number under what it is, as `excess, cm/s` or `difference, 0.01 %`.
fn measured(what: &str, number: i32) -> String {
    let Some((what, unit)) = what.split_once(", ") else {
        return format!("{what} {number}");
    };
    let scaled = unit.split_once(' ');
    match scaled.and_then(|(scale, unit)| Some((scale.parse::<f64>().ok()?, unit))) {
        Some((scale, unit)) => format!("{what} {:.2} {unit}", f64::from(number) * scale),
        None => format!("{what} {number} {unit}"),
    }
}

/// A label as people write it.
fn plain(label: &str) -> String {
    label.replace('_', " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_told_in_words_and_units() {
        for (event, parameter, words) in [
            (Event::AtoFailed, 7, "ato_failed: not following"),
            (
                Event::AtoInputAbsurd,
                4,
                "ato_input_absurd: Speed that stays exactly the same while effort is asked for",
            ),
            (
                Event::AutomaticRefused,
                0x0401,
                "automatic_refused: The train is not at standstill; ATO is not ready",
            ),
            (Event::OverspeedFsb, 139, "overspeed_fsb: excess 139 cm/s"),
            (
                Event::WheelDiameter,
                -150,
                "wheel_diameter: difference -1.50 %",
            ),
            (Event::BrakeUnitFailed, 4, "brake_unit_failed: car 4"),
            (
                Event::RegenerationCutOut,
                0,
                "regeneration_cut_out: all cars",
            ),
            (Event::PowerUp, 0, "power_up"),
            (Event::AutomaticRefused, 0x8000, "automatic_refused: bit 15"),
        ] {
            assert_eq!(described(event.definition().code, parameter), words);
        }
    }
}
