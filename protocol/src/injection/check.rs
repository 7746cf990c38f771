//! Permitted effects at each place and the bounds of their parameters: what unit and rig can carry out. Any
//! other fault mode would have no effect, so it is refused.

use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;

use super::{Effect, FaultMode, Occurrence, Place};
use crate::config::{ConfigError, conflict, within};
use crate::event::Severity;

/// Cars a train may have.
pub const MAX_CARS: u8 = 12;

/// Longest delay of an effect, ms: what is late waits in queues of that length.
const LONGEST_DELAY_MS: f64 = 5_000.0;
/// Latest onset, s: a day.
const LATEST_ONSET_S: f64 = 86_400.0;
/// Spells and pauses of an intermittent fault, s: from a few scans to an hour.
const SHORTEST_SPELL_S: f64 = 0.05;
const LONGEST_SPELL_S: f64 = 3_600.0;
/// Speeds at which something may shake loose, km/h.
const LEAST_KMH: f64 = 1.0;
const MOST_KMH: f64 = 200.0;
/// Prior weights.
const LEAST_WEIGHT: f64 = 1e-6;
const MOST_WEIGHT: f64 = 1e6;

/// Kind of an effect, as catalogues write it, and the range of its number.
type Allowed = (&'static str, f64, f64);

const DEAD: Allowed = ("dead", 0.0, 0.0);
const STUCK_ON: Allowed = ("stuck_on", 0.0, 0.0);
const STUCK_OFF: Allowed = ("stuck_off", 0.0, 0.0);
/// Twice as many, at most.
const GAIN: Allowed = ("gain", 0.0, 2.0);
/// Share of frames.
const BIT_ERRORS: Allowed = ("bit_errors", 0.0, 1.0);
/// One event a scan, at most.
const NOISE: Allowed = ("noise", 0.0, 100.0);
const DELAY: Allowed = ("delay", 0.0, LONGEST_DELAY_MS);

/// Effects that a place can have.
fn allowed(place: Place) -> &'static [Allowed] {
    match place {
        Place::AtpAntenna => &[DEAD, ("gain", 0.0, 10.0)],
        Place::AtpReceiver => &[
            DEAD,
            STUCK_ON,
            ("gain", 0.0, 10.0),
            ("offset", -100.0, 100.0),
            ("limit", 0.0, 100.0),
        ],
        Place::SpeedSensor1 | Place::SpeedSensor2 => &[DEAD, GAIN, NOISE],
        Place::EbRelay => &[DEAD, STUCK_ON, STUCK_OFF, DELAY],
        Place::FsbOutput => &[DEAD, STUCK_ON, STUCK_OFF, DELAY],
        Place::DoorInput
        | Place::DoorInputLeft
        | Place::DoorInputRight
        | Place::DoorOutput
        | Place::DoorOpenOutput
        | Place::DoorCloseOutput
        | Place::CabInput => &[DEAD, STUCK_ON, STUCK_OFF],
        Place::ModeInput | Place::ControllerInput => &[DEAD, STUCK_OFF],
        Place::MarkerAntenna => &[DEAD, BIT_ERRORS, ("deaf", 1.0, 4.0)],
        Place::TestBoard | Place::Regeneration | Place::BrakeUnit => &[DEAD],
        Place::StopGuard
        | Place::ReleaseGuard
        | Place::MarkerDebounce
        | Place::JogGuard
        | Place::CodeConfirmation
        | Place::CodeSeparation
        | Place::LineGuard
        | Place::NeutralGuard
        | Place::SpeedGuard
        | Place::ReleaseStandstill
        | Place::MarkerGuard
        | Place::EnableLatch
        | Place::LoopPlaces
        | Place::SpeedSensors
        | Place::ArmStandstill
        | Place::ArmBrakes
        | Place::MotionGuard
        | Place::CodeGuard
        | Place::ModeGuard
        | Place::KeyGuard
        | Place::BrakeHold
        | Place::TractionBar
        | Place::StartBar
        | Place::DoorBar
        | Place::DoorGuard
        | Place::DoorClosing
        | Place::DoorReopening
        | Place::DepartureGuard
        | Place::SlowRunning
        | Place::TrainGuard
        | Place::OrderGuard
        | Place::CabEntries
        | Place::WheelGuard
        | Place::HandOverBrake
        | Place::PutAwayBrake
        | Place::WakeUpTest
        | Place::TcmsCabs
        | Place::StationGuard
        | Place::SideGuard => &[DEAD],
        Place::TwcDoorSide | Place::DoorOrder => &[("offset", -3.0, 3.0)],
        Place::TwcAnswer => &[STUCK_ON],
        Place::Jog => &[DEAD, STUCK_OFF],
        Place::TestCode => &[("gain", 0.0, 10.0)],
        // Hz.
        Place::TestCarrier => &[("offset", -1000.0, 1000.0)],
        Place::TestRate => &[("offset", -100.0, 100.0)],
        Place::TestSpeed => &[GAIN],
        // Dips a second.
        Place::PowerSupply => &[DEAD, ("noise", 0.0, 1.0)],
        Place::Clock => &[("gain", 0.5, 2.0)],
        Place::Inverter => &[DEAD, ("gain", 0.0, 1.0)],
        Place::Tra => &[DEAD, BIT_ERRORS, ("bounce", 0.0, LONGEST_DELAY_MS)],
        Place::TestMarker
        | Place::TwcAntenna
        | Place::FskReceiver
        | Place::FskTransmitter
        | Place::TcmsReceiver
        | Place::TcmsTransmitter => &[DEAD, BIT_ERRORS],
        Place::TwcCpu => &[DEAD, DELAY, ("offset", -32_768.0, 32_767.0)],
        Place::AtoCpu => &[
            DEAD,
            STUCK_ON,
            ("offset", -2048.0, 2048.0),
            ("limit", 0.0, 1024.0),
            DELAY,
        ],
        Place::Memory => &[STUCK_ON],
        Place::TrackDatabase => &[DEAD, ("offset", -1000.0, 1000.0)],
        Place::WheelParameter => &[("gain", 0.5, 2.0)],
        Place::BrakeCylinder => &[STUCK_ON, ("gain", 0.0, 1.0)],
        // V.
        Place::ControllerPot => &[STUCK_ON, STUCK_OFF, ("offset", -10.0, 10.0)],
        Place::DoorContact
        | Place::DoorContactLeft
        | Place::DoorContactRight
        | Place::HeadControlRelay
        | Place::MainReservoir => &[STUCK_ON, STUCK_OFF],
        Place::Tcms => &[DEAD, STUCK_ON],
        Place::BenchLevel => &[DEAD, ("gain", 0.0, 10.0)],
        // Hz.
        Place::BenchCarrier => &[("offset", -1000.0, 1000.0)],
        Place::BenchRate => &[("offset", -100.0, 100.0)],
        Place::BenchSpeed => &[GAIN],
        Place::WireDoors | Place::WireHcr | Place::BenchDoors => &[STUCK_OFF],
        Place::BenchEb | Place::BenchFsb => &[STUCK_ON, STUCK_OFF],
        Place::WireSpeed1 | Place::BenchMarker | Place::BenchTwc => &[DEAD],
    }
}

/// Kind of an effect; its number, with the name of the number.
fn parts(effect: Effect) -> (&'static str, Option<(&'static str, f64)>) {
    match effect {
        Effect::Dead => ("dead", None),
        Effect::StuckOn => ("stuck_on", None),
        Effect::StuckOff => ("stuck_off", None),
        Effect::Gain { factor } => ("gain", Some(("factor", factor))),
        Effect::Offset { by } => ("offset", Some(("by", by))),
        Effect::Limit { to } => ("limit", Some(("to", to))),
        Effect::Delay { ms } => ("delay", Some(("ms", f64::from(ms)))),
        Effect::Bounce { ms } => ("bounce", Some(("ms", f64::from(ms)))),
        Effect::Deaf { to_marker } => ("deaf", Some(("to_marker", f64::from(to_marker)))),
        Effect::Noise { per_s } => ("noise", Some(("per_s", per_s))),
        Effect::BitErrors { rate } => ("bit_errors", Some(("rate", rate))),
    }
}

/// Checks one fault mode by itself.
///
/// # Errors
/// A number out of its range, an effect that does nothing at its place, a car where there is none.
pub(super) fn check(fault: &FaultMode) -> Result<(), ConfigError> {
    let wrong = |what: String| conflict(&format!("fault {}: {what}", fault.id));
    if Severity::of_fault(&fault.severity).is_none() {
        let severity = &fault.severity;
        return Err(wrong(format!(
            "severity must be minor, major or critical, not {severity}"
        )));
    }
    in_range(fault, "weight", fault.weight, LEAST_WEIGHT, MOST_WEIGHT)?;
    in_range(fault, "onset_s", fault.onset_s, 0.0, LATEST_ONSET_S)?;
    let place = name(fault.place);
    let stored = fault.place.is_stored();
    for (key, given) in [
        ("onset_s", fault.onset_s > 0.0),
        ("occurs", !fault.occurs.is_always()),
    ] {
        if stored && given {
            return Err(wrong(format!(
                "{place} is stored data, wrong from power-up on: leave {key} out"
            )));
        }
    }
    occurrence(fault)?;
    match fault.car {
        None if fault.place.on_car() => {
            return Err(wrong(format!("{place} is on a car, name it with `car`")));
        }
        Some(_) if !fault.place.on_car() => {
            return Err(wrong(format!("{place} is on no car, leave `car` out")));
        }
        Some(car) => in_range(fault, "car", f64::from(car), 1.0, f64::from(MAX_CARS))?,
        None => {}
    }
    let (kind, number) = parts(fault.effect);
    let possible = allowed(fault.place);
    let Some((_, low, high)) = possible.iter().find(|(one, ..)| *one == kind) else {
        let kinds: Vec<_> = possible.iter().map(|(one, ..)| *one).collect();
        return Err(wrong(format!(
            "{kind} does nothing at {place}; there: {}",
            kinds.join(", ")
        )));
    };
    if let Some((key, value)) = number {
        in_range(fault, &format!("effect.{key}"), value, *low, *high)?;
    }
    levels(fault, *low, *high)
}

fn occurrence(fault: &FaultMode) -> Result<(), ConfigError> {
    match fault.occurs {
        Occurrence::Always => Ok(()),
        Occurrence::AtTimes { on_s, off_s } => {
            let (least, most) = (SHORTEST_SPELL_S, LONGEST_SPELL_S);
            in_range(fault, "occurs.on_s", on_s, least, most)?;
            in_range(fault, "occurs.off_s", off_s, least, most)
        }
        Occurrence::AboveSpeed { kmh } => in_range(fault, "occurs.kmh", kmh, LEAST_KMH, MOST_KMH),
        Occurrence::WhenWarm { after_s, full_s } => {
            if fault.onset_s > 0.0 {
                return Err(conflict(&format!(
                    "fault {}: what comes with warmth begins at occurs.after_s: leave onset_s out",
                    fault.id
                )));
            }
            in_range(fault, "occurs.after_s", after_s, 0.0, LATEST_ONSET_S)?;
            in_range(fault, "occurs.full_s", full_s, 0.0, LATEST_ONSET_S)
        }
    }
}

/// Checks the other values the effect's number may have.
fn levels(fault: &FaultMode, low: f64, high: f64) -> Result<(), ConfigError> {
    if fault.levels.is_empty() {
        return Ok(());
    }
    let wrong = |what: String| conflict(&format!("fault {}: {what}", fault.id));
    let (kind, number) = parts(fault.effect);
    let Some((key, written)) = number.filter(|_| !matches!(fault.effect, Effect::Deaf { .. }))
    else {
        return Err(wrong(format!("{kind} has no levels: leave them out")));
    };
    for (i, level) in fault.levels.iter().enumerate() {
        in_range(fault, "levels", *level, low, high)?;
        if *level == written || fault.levels[..i].contains(level) {
            return Err(wrong(format!(
                "levels has {level} twice, or effect.{key} has it already"
            )));
        }
        if matches!(fault.effect, Effect::Delay { .. } | Effect::Bounce { .. })
            && libm::trunc(*level) != *level
        {
            return Err(wrong(format!("levels has {level}: whole ms only")));
        }
    }
    Ok(())
}

fn in_range(
    fault: &FaultMode,
    key: &str,
    value: f64,
    low: f64,
    high: f64,
) -> Result<(), ConfigError> {
    within(&format!("fault {}: {key}", fault.id), value, low, high)
}

/// A place as catalogues write it.
fn name(place: Place) -> String {
    // A unit variant always has a name; nothing else is possible here.
    toml::Value::try_from(place)
        .ok()
        .and_then(|value| value.as_str().map(ToString::to_string))
        .unwrap_or_default()
}
