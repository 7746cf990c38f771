//! Parameters of events in words: everything that shows an entry of a log to a person uses this.

use protocol::event::{ALL_CARS, Event, RELAY_DROPPED};
use protocol::message::{
    AbsurdInputs, ArmRefusal, AtoFailure, Channel, DoorSide, EbCause, Mode, OrderLacks, Refusals,
    SelfTest,
};

use super::describe::meanings;

/// Parameter of an event as text, by name or with its unit; empty for an event without one.
pub fn parameter(event: Event, number: i32) -> String {
    let what = event.definition().parameter;
    if what.is_empty() {
        return String::new();
    }
    named(event, number).unwrap_or_else(|| {
        let (what, value) = measured(event, number);
        format!("{what} {value}")
    })
}

/// Name that an event's parameter stands for; `None` where the parameter is a measured value or not
/// used.
pub fn named(event: Event, number: i32) -> Option<String> {
    let (code, bits) = (number as u8, number as u16);
    Some(match event {
        Event::ModeChanged => Mode::from_code(code).label().to_owned(),
        Event::EbReleaseRefused => match EbCause::from_code(code) {
            EbCause::None => "the train moves".into(),
            cause => plain(cause.label()),
        },
        Event::AtoFailed => plain(AtoFailure::from_code(code).label()),
        Event::ArmingLapsed | Event::TestModeBroken => plain(ArmRefusal::from_code(code).label()),
        Event::AutomaticRefused => meanings(&Refusals::SPEC, bits),
        Event::AtoInputAbsurd => meanings(&AbsurdInputs::SPEC, bits),
        Event::OrderRefused => meanings(&OrderLacks::SPEC, bits),
        Event::WokenUp if number == 0 => "self-test passed".into(),
        Event::SelfTestFailed | Event::WokenUp => meanings(&SelfTest::SPEC, bits),
        Event::CabsNotChanged => match number {
            RELAY_DROPPED => "the relay dropped, the unit does not see it".into(),
            _ => "the relay did not drop".into(),
        },
        Event::ChangeOfCabs => match number {
            1 => "handed over".into(),
            _ => "taken over".into(),
        },
        Event::DoorNotEnabled
        | Event::DoorLinesContradict
        | Event::DoorObstructed
        | Event::DoorOrderRefused
        | Event::DoorsStayClosed => match DoorSide::from_code(code) {
            DoorSide::None => "all doors".to_owned(),
            side => side.label().to_owned(),
        },
        Event::TwcWrongSide => format!("doors {}", DoorSide::from_code(code).label()),
        Event::FramesRejected => match Channel::from_code(code) {
            Some(channel) => format!("channel {channel:?}"),
            None => format!("channel {number}"),
        },
        _ if event.definition().parameter.starts_with("car") => match number {
            ALL_CARS => "all cars".into(),
            car => format!("car {car}"),
        },
        _ => return None,
    })
}

/// Kind of a measured parameter, and its value with its unit: `excess, cm/s` or `difference, 0.01 %`.
pub fn measured(event: Event, number: i32) -> (&'static str, String) {
    let what = event.definition().parameter;
    let Some((what, unit)) = what.split_once(", ") else {
        return (what, number.to_string());
    };
    let unit = unit.split(';').next().unwrap_or_default();
    let scaled = unit.split_once(' ');
    match scaled.and_then(|(scale, unit)| Some((scale.parse::<f64>().ok()?, unit))) {
        Some((scale, unit)) => (what, format!("{:.2} {unit}", f64::from(number) * scale)),
        None => (what, format!("{number} {unit}")),
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
        for (event, number, words) in [
            (Event::AtoFailed, 7, "not following"),
            (Event::TwcWrongSide, 1, "doors left"),
            (
                Event::SelfTestFailed,
                0x48,
                "Brake line energised although the EB relay is not; TWC modem loop-back",
            ),
            (
                Event::AtoInputAbsurd,
                4,
                "Speed that stays exactly the same while effort is asked for",
            ),
            (
                Event::AutomaticRefused,
                0x0401,
                "The train is not at standstill; ATO is not ready",
            ),
            (Event::EbReleaseRefused, 6, "door open"),
            (Event::EbReleaseRefused, 0, "the train moves"),
            (Event::OverspeedFsb, 139, "excess 139 cm/s"),
            (Event::WheelDiameter, -150, "difference -1.50 %"),
            (Event::BrakeUnitFailed, 4, "car 4"),
            (Event::RegenerationCutOut, 0, "all cars"),
            (Event::FramesRejected, 4, "channel Twc"),
            (Event::PowerUp, 0, ""),
            (Event::AtoInputAbsurd, 0x8000, "bit 15"),
            (
                Event::OrderRefused,
                3,
                "The train moves; Doors are not proved closed and locked",
            ),
            (Event::WokenUp, 0, "self-test passed"),
            (Event::ChangeOfCabs, 2, "taken over"),
        ] {
            assert_eq!(parameter(event, number), words);
        }
    }

    /// A new event whose parameter is a code or a set of bits needs words, too.
    #[test]
    fn no_parameter_is_a_number_that_stands_for_a_word() {
        for &event in Event::ALL {
            let what = event.definition().parameter;
            let coded = what.contains('`') || what.contains("bits") || what.contains("refusal");
            let told = parameter(event, 1);
            assert!(!coded || !told.ends_with('1'), "{event:?}: {told}");
        }
    }
}
