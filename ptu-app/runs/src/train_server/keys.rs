//! Operations in the cab that have no order of their own: words with a value, each a stimulus of the desk or of the
//! train's switches.

use btu_rig::lever::Lever;
use btu_rig::stimulus::{CutOut, DoorState, Stimulus, TrainSwitch};

/// Part that a key's value operates.
#[derive(Clone, Copy)]
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

pub fn names() -> impl Iterator<Item = &'static str> {
    KEYS.iter().map(|(name, _)| *name)
}

/// Stimulus of the key of this name with a value; `None` = there is no such key.
///
/// # Errors
/// The values that the key takes, if this is another one.
pub fn stimulus(name: &str, value: Option<&str>) -> Option<Result<Stimulus, &'static str>> {
    let (_, key) = KEYS.iter().find(|(known, _)| *known == name)?;
    let value = value.unwrap_or_default();
    let on = || on_or_off(value).ok_or("on or off");
    Some(match *key {
        Key::CutOut(what, on) => {
            let car = value.parse().map_err(|_| "the number of a car");
            car.map(|car| Stimulus::CutOut { what, car, on })
        }
        Key::Switch(switch) => on().map(|on| Stimulus::Switch { switch, on }),
        Key::Doors => on().map(|closed| Stimulus::Doors { closed }),
        Key::SideDoors(left) => on().map(|closed| Stimulus::SideDoors {
            left,
            state: match closed {
                true => DoorState::Locked,
                false => DoorState::Open,
            },
        }),
        Key::Reverser => {
            let known = REVERSER.iter().find(|(_, name)| *name == value);
            let known = known.ok_or("forward, neutral or backward");
            known.map(|(position, _)| Stimulus::Reverser {
                position: *position,
            })
        }
        Key::Lever => {
            let lever = Lever::from_name(value).ok_or("EB, B7 to B1, N, P0.5 or P1 to P4");
            lever.map(|lever| Stimulus::Controller { lever })
        }
    })
}

pub fn on_or_off(value: &str) -> Option<bool> {
    match value {
        "on" | "true" => Some(true),
        "off" | "false" => Some(false),
        _ => None,
    }
}

/// In words, as a driver says it.
pub fn words(action: &Stimulus) -> String {
    match *action {
        Stimulus::Controller { lever } => lever.to_string(),
        Stimulus::Reverser { position } => {
            let named = REVERSER.iter().find(|(at, _)| *at == position);
            format!("reverser {}", named.map_or("neutral", |(_, name)| name))
        }
        Stimulus::Switch {
            switch: TrainSwitch::Regeneration,
            on,
        } => format!("regeneration {}", if on { "again" } else { "cut-out" }),
        other => other.to_string(),
    }
}
