//! What a driver does: stimuli of the desk and of the train's switches, by their keys in a sequence file and in
//! words.

use crate::lever::Lever;
use crate::stimulus::{CutOut, Stimulus, TrainSwitch};

/// Switches by their keys in a sequence file.
pub(super) const SWITCHES: [(TrainSwitch, &str); 11] = [
    (TrainSwitch::OtherCab, "other_active"),
    (TrainSwitch::DeadMan, "dead_man"),
    (TrainSwitch::Button1, "emergency_button"),
    (TrainSwitch::Button2, "emergency_button_2"),
    (TrainSwitch::EbCutOut, "eb_cut_out"),
    (TrainSwitch::MainReservoirLow, "main_reservoir_low"),
    (TrainSwitch::SecurityBrake, "security_brake"),
    (TrainSwitch::ParkingBrake, "parking_brake"),
    (TrainSwitch::ForcedRelease, "forced_release"),
    (TrainSwitch::TurnBack, "turn_back"),
    (TrainSwitch::Regeneration, "regeneration"),
];

/// Positions of the reverser by their names in a sequence file.
pub(super) const REVERSER: [(i8, &str); 3] = [(1, "forward"), (0, "neutral"), (-1, "backward")];

fn reverser(position: i8) -> &'static str {
    let named = REVERSER.iter().find(|(at, _)| *at == position);
    named.map_or("neutral", |(_, name)| name)
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

/// As a sequence file has it, `key = value`; empty for what no sequence can do.
pub(super) fn toml(action: &Stimulus) -> String {
    match *action {
        Stimulus::Controller { lever } => format!("lever = \"{lever}\""),
        Stimulus::Reverser { position } => format!("reverser = \"{}\"", reverser(position)),
        Stimulus::Doors { closed } => format!("doors_closed = {closed}"),
        Stimulus::Switch { switch, on } => {
            let named = SWITCHES.iter().find(|(known, _)| *known == switch);
            format!("{} = {on}", named.map_or("", |(_, key)| key))
        }
        Stimulus::CutOut { what, car, on } => {
            let what = match what {
                CutOut::Brake => "brake",
                CutOut::Inverter => "inverter",
            };
            format!("{what}_cut_{} = {car}", if on { "out" } else { "in" })
        }
        _ => String::new(),
    }
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
