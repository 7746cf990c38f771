//! What a driver does: the keys of a step in a sequence file, each a stimulus of the desk or of the train's switches.

use toml::Value;

use crate::lever::Lever;
use crate::stimulus::{CutOut, DoorState, Stimulus, TrainSwitch};

/// What a key of a step does.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Key {
    /// Cuts the equipment of a car out, or in again.
    CutOut(CutOut, bool),
    Switch(TrainSwitch),
    Doors,
    /// Doors on the left, else on the right.
    SideDoors(bool),
    Reverser,
    Lever,
}

/// Keys of a step in the order in which they are done: what is cut out or switched comes before the lever, so that
/// one step can do both.
const KEYS: [(&str, Key); 20] = [
    ("brake_cut_out", Key::CutOut(CutOut::Brake, true)),
    ("brake_cut_in", Key::CutOut(CutOut::Brake, false)),
    ("inverter_cut_out", Key::CutOut(CutOut::Inverter, true)),
    ("inverter_cut_in", Key::CutOut(CutOut::Inverter, false)),
    ("other_active", Key::Switch(TrainSwitch::OtherCab)),
    ("dead_man", Key::Switch(TrainSwitch::DeadMan)),
    ("emergency_button", Key::Switch(TrainSwitch::Button1)),
    ("emergency_button_2", Key::Switch(TrainSwitch::Button2)),
    ("eb_cut_out", Key::Switch(TrainSwitch::EbCutOut)),
    (
        "main_reservoir_low",
        Key::Switch(TrainSwitch::MainReservoirLow),
    ),
    ("security_brake", Key::Switch(TrainSwitch::SecurityBrake)),
    ("parking_brake", Key::Switch(TrainSwitch::ParkingBrake)),
    ("forced_release", Key::Switch(TrainSwitch::ForcedRelease)),
    ("turn_back", Key::Switch(TrainSwitch::TurnBack)),
    ("regeneration", Key::Switch(TrainSwitch::Regeneration)),
    ("doors_closed", Key::Doors),
    ("doors_left_closed", Key::SideDoors(true)),
    ("doors_right_closed", Key::SideDoors(false)),
    ("reverser", Key::Reverser),
    ("lever", Key::Lever),
];

/// Positions of the reverser by their names.
const REVERSER: [(i8, &str); 3] = [(1, "forward"), (0, "neutral"), (-1, "backward")];

fn reverser(position: i8) -> &'static str {
    let named = REVERSER.iter().find(|(at, _)| *at == position);
    named.map_or("neutral", |(_, name)| name)
}

/// Names of all keys, in the order in which they are done.
pub fn names() -> impl Iterator<Item = &'static str> {
    KEYS.iter().map(|(name, _)| *name)
}

/// What the key of this name does with a value.
///
/// # Errors
/// What is wrong with it, in words.
pub fn stimulus(name: &str, value: &Value) -> Result<Stimulus, String> {
    let key = KEYS.iter().find(|(known, _)| *known == name);
    let (_, key) = key.ok_or_else(|| format!("unknown field `{name}`"))?;
    Ok(match *key {
        Key::CutOut(what, on) => Stimulus::CutOut {
            what,
            car: of(value)?,
            on,
        },
        Key::Switch(switch) => Stimulus::Switch {
            switch,
            on: of(value)?,
        },
        Key::Doors => Stimulus::Doors { closed: of(value)? },
        Key::SideDoors(left) => Stimulus::SideDoors {
            left,
            state: match of(value)? {
                true => DoorState::Locked,
                false => DoorState::Open,
            },
        },
        Key::Reverser => {
            let asked: String = of(value)?;
            let known = REVERSER.iter().find(|(_, known)| *known == asked);
            let (position, _) = *known.ok_or_else(|| {
                format!("no reverser position \"{asked}\"; it has forward, neutral, backward")
            })?;
            Stimulus::Reverser { position }
        }
        Key::Lever => {
            let asked: String = of(value)?;
            let lever = Lever::from_name(&asked).ok_or_else(|| {
                format!("no lever position \"{asked}\"; it has EB, B7 to B1, N, P0.5, P1 to P4")
            })?;
            Stimulus::Controller { lever }
        }
    })
}

/// A value as the kind that is wanted.
pub(super) fn of<T: serde::de::DeserializeOwned>(value: &Value) -> Result<T, String> {
    let wanted = value.clone().try_into();
    wanted.map_err(|error: toml::de::Error| error.message().to_owned())
}

/// As a sequence file has it, `key = value`; nothing for what no key does.
pub(super) fn toml(action: &Stimulus) -> Option<String> {
    let (key, value) = match *action {
        Stimulus::CutOut { what, car, on } => (Key::CutOut(what, on), car.to_string()),
        Stimulus::Switch { switch, on } => (Key::Switch(switch), on.to_string()),
        Stimulus::Doors { closed } => (Key::Doors, closed.to_string()),
        Stimulus::SideDoors { left, state } if state != DoorState::Unlocked => (
            Key::SideDoors(left),
            (state == DoorState::Locked).to_string(),
        ),
        Stimulus::Reverser { position } => (Key::Reverser, format!("\"{}\"", reverser(position))),
        Stimulus::Controller { lever } => (Key::Lever, format!("\"{lever}\"")),
        _ => return None,
    };
    let (name, _) = KEYS.iter().find(|(_, known)| *known == key)?;
    Some(format!("{name} = {value}"))
}

/// In words, as a driver says it.
pub fn words(action: &Stimulus) -> String {
    match *action {
        Stimulus::Controller { lever } => lever.to_string(),
        Stimulus::Reverser { position } => format!("reverser {}", reverser(position)),
        Stimulus::Switch {
            switch: TrainSwitch::Regeneration,
            on,
        } => format!("regeneration {}", if on { "again" } else { "cut-out" }),
        other => other.to_string(),
    }
}

/// It asks for traction.
pub(super) fn powers(action: &Stimulus) -> bool {
    matches!(
        action,
        Stimulus::Controller {
            lever: Lever::HalfPower | Lever::Power(_)
        }
    )
}
