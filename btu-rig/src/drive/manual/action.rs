//! Actions of the driver and at the train's switches.

use std::fmt;

use crate::lever::Lever;
use crate::stimulus::{CutOut, Stimulus, TrainSwitch};

/// One thing done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Master controller to a position.
    Lever(Lever),
    /// Reverser: 1 forward, 0 neutral, −1 backward.
    Reverser(i8),
    /// Doors proved closed, or not.
    Doors {
        /// Closed.
        closed: bool,
    },
    /// A switch of the train, on or off.
    Switch(TrainSwitch, bool),
    /// Equipment of a car cut out, or in again.
    CutOut {
        /// What.
        what: CutOut,
        /// Car, counted from 1 at the head.
        car: u8,
        /// Out, or in.
        out: bool,
    },
}

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

impl Action {
    /// As the bench does it.
    pub fn stimulus(self) -> Stimulus {
        match self {
            Self::Lever(lever) => Stimulus::Controller { lever },
            Self::Reverser(position) => Stimulus::Reverser { position },
            Self::Doors { closed } => Stimulus::Doors { closed },
            Self::Switch(switch, on) => Stimulus::Switch { switch, on },
            Self::CutOut { what, car, out } => Stimulus::CutOut { what, car, on: out },
        }
    }

    /// It asks for traction.
    pub fn powers(self) -> bool {
        matches!(self, Self::Lever(Lever::HalfPower | Lever::Power(_)))
    }

    /// As a sequence file has it, `key = value`.
    pub(super) fn toml(self) -> String {
        match self {
            Self::Lever(lever) => format!("lever = \"{lever}\""),
            Self::Reverser(position) => {
                let named = REVERSER.iter().find(|(at, _)| *at == position);
                format!(
                    "reverser = \"{}\"",
                    named.map_or("neutral", |(_, name)| name)
                )
            }
            Self::Doors { closed } => format!("doors_closed = {closed}"),
            Self::Switch(switch, on) => {
                let named = SWITCHES.iter().find(|(known, _)| *known == switch);
                format!("{} = {on}", named.map_or("", |(_, key)| key))
            }
            Self::CutOut { what, car, out } => {
                let what = match what {
                    CutOut::Brake => "brake",
                    CutOut::Inverter => "inverter",
                };
                format!("{what}_cut_{} = {car}", if out { "out" } else { "in" })
            }
        }
    }
}

impl fmt::Display for Action {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let on_off = |on: bool| if on { "on" } else { "off" };
        match *self {
            Self::Lever(lever) => write!(f, "{lever}"),
            Self::Reverser(position) => {
                let named = REVERSER.iter().find(|(at, _)| *at == position);
                write!(f, "reverser {}", named.map_or("neutral", |(_, name)| name))
            }
            Self::Doors { closed: true } => f.write_str("doors closed"),
            Self::Doors { closed: false } => f.write_str("doors open"),
            Self::Switch(TrainSwitch::Regeneration, true) => f.write_str("regeneration again"),
            Self::Switch(TrainSwitch::Regeneration, false) => f.write_str("regeneration cut-out"),
            Self::Switch(switch, on) => write!(f, "{} {}", switch.label(), on_off(on)),
            Self::CutOut { what, car, out } => {
                let what = match what {
                    CutOut::Brake => "brake",
                    CutOut::Inverter => "inverter",
                };
                write!(
                    f,
                    "{what} of car {car} cut {}",
                    if out { "out" } else { "in" }
                )
            }
        }
    }
}
