//! Conditions of generators and links, and the train's switches.

use serde::{Deserialize, Serialize};

/// Condition of one tachometer channel's generator.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TachoCondition {
    Good,
    /// No pulses.
    Dead,
    /// Spurious pulses on top, mean per second.
    Noisy {
        /// Mean spurious pulses per second.
        per_s: f64,
    },
    /// Pulses of a speed multiplied by a factor (missing teeth, wrong wheel diameter).
    Scaled {
        factor: f64,
    },
    /// The tachometer gives the wrong direction.
    Reversed,
}

/// Condition of the TWC wayside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WaysideCondition {
    /// Sends nothing.
    Silent,
    /// Sends sound frames every 250 ms.
    Good,
    /// Sends frames with bit errors.
    Corrupt,
}

/// Doors of one side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DoorState {
    /// At least one is open.
    Open,
    /// All are closed, at least one is not locked.
    Unlocked,
    /// All are closed and locked.
    #[default]
    Locked,
}

/// A door train line, as it ends at the unit's terminals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DoorLine {
    /// Through the closed contacts of all doors.
    All,
    LeftClosed,
    LeftLocked,
    RightClosed,
    RightLocked,
    /// Says that the train reports doors by side.
    BySide,
}

impl DoorLine {
    /// Names in scripts, in the order of the variants.
    pub const LABELS: &'static [&'static str] = &[
        "all",
        "left_closed",
        "left_locked",
        "right_closed",
        "right_locked",
        "by_side",
    ];
    /// All, in the same order.
    pub const ALL: [Self; 6] = [
        Self::All,
        Self::LeftClosed,
        Self::LeftLocked,
        Self::RightClosed,
        Self::RightLocked,
        Self::BySide,
    ];

    /// The line called `label`.
    pub fn from_label(label: &str) -> Option<Self> {
        let place = Self::LABELS.iter().position(|known| *known == label)?;
        Some(Self::ALL[place])
    }

    pub const fn label(self) -> &'static str {
        Self::LABELS[self as usize]
    }
}

impl DoorState {
    pub const fn label(self) -> &'static str {
        match self {
            Self::Open => "open",
            Self::Unlocked => "closed, not locked",
            Self::Locked => "closed",
        }
    }
}

/// Condition of the TCMS link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TcmsCondition {
    /// Answers every cycle.
    Good,
    /// Sends nothing.
    Silent,
    /// Sends with a standing alive counter.
    Stale,
}

/// A switch, contact or valve of the train that is on or off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TrainSwitch {
    /// Head control relay of the other cab.
    OtherCab,
    /// Dead man held down.
    DeadMan,
    /// Emergency push button of the first cab, the one the unit is in.
    Button1,
    /// Emergency push button of the other cab.
    Button2,
    /// Emergency brake cut out.
    EbCutOut,
    /// Main reservoir pressure low.
    MainReservoirLow,
    SecurityBrake,
    ParkingBrake,
    /// Button for release of the brakes by force.
    ForcedRelease,
    /// Driverless initialisation or turn-back.
    TurnBack,
    /// The line takes regenerated power.
    Regeneration,
}

impl TrainSwitch {
    pub fn label(self) -> &'static str {
        match self {
            Self::OtherCab => "head control relay of the other cab",
            Self::DeadMan => "dead man held",
            Self::Button1 => "emergency button of the first cab",
            Self::Button2 => "emergency button of the other cab",
            Self::EbCutOut => "emergency brake cut-out",
            Self::MainReservoirLow => "main reservoir low",
            Self::SecurityBrake => "security brake",
            Self::ParkingBrake => "parking brake",
            Self::ForcedRelease => "forced release",
            Self::TurnBack => "driverless turn-back",
            Self::Regeneration => "line takes regenerated power",
        }
    }
}

/// Failure of a car's equipment that a bench makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CarFailure {
    /// The inverter does nothing and does not answer.
    InverterSilent,
    /// The brake control unit does nothing and does not answer.
    BrakeUnitSilent,
    /// The brake cylinders get no pressure of the service brake.
    CylinderEmpty,
    /// The brake cylinders keep the pressure they have.
    BrakeStuck,
}

impl CarFailure {
    pub fn label(self) -> &'static str {
        match self {
            Self::InverterSilent => "inverter silent",
            Self::BrakeUnitSilent => "brake control unit silent",
            Self::CylinderEmpty => "brake cylinders empty",
            Self::BrakeStuck => "brake stuck",
        }
    }
}

/// Equipment of a car that can be cut out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CutOut {
    Brake,
    Inverter,
}
