//! Conditions of generators and links, and the train's switches.

use serde::{Deserialize, Serialize};

/// Condition of one tachometer channel's generator.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TachoCondition {
    Good,
    /// No pulses.
    Dead,
    /// Spurious pulses beside the true ones.
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

/// Condition of the TWC wayside, in the order of the labels of the signal `wayside`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WaysideCondition {
    /// Sends nothing.
    Silent = 0,
    /// Sends undamaged frames every 250 ms.
    Good = 1,
    /// Sends frames with bit errors.
    Corrupt = 2,
}

protocol::labelled! {
    /// Doors of one side.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    pub enum DoorState: label {
        /// At least one is open.
        Open = "open",
        /// All are closed, at least one is not locked.
        Unlocked = "closed, not locked",
        /// All are closed and locked.
        #[default]
        Locked = "closed",
    }
}

protocol::labelled! {
    /// A door train line, as it ends at the unit's terminals.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    pub enum DoorLine: label {
        /// Through the closed contacts of all doors.
        All = "all",
        LeftClosed = "left_closed",
        LeftLocked = "left_locked",
        RightClosed = "right_closed",
        RightLocked = "right_locked",
        /// Says that the train reports doors by side.
        BySide = "by_side",
    }
}

impl DoorLine {
    /// The line that scripts call `label`.
    pub fn from_label(label: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|line| line.label() == label)
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
    /// Sends frames whose alive counter stands still.
    Stale,
}

protocol::labelled! {
    /// A switch, contact or valve of the train that is on or off.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    pub enum TrainSwitch: label {
        /// Head control relay of the other cab.
        OtherCab = "head control relay of the other cab",
        /// Dead man held down.
        DeadMan = "dead man held",
        /// Emergency push button of the first cab, the one the unit is in.
        Button1 = "emergency button of the first cab",
        /// Emergency push button of the other cab.
        Button2 = "emergency button of the other cab",
        /// Emergency brake cut out.
        EbCutOut = "emergency brake cut-out",
        /// Main reservoir pressure low.
        MainReservoirLow = "main reservoir low",
        SecurityBrake = "security brake",
        ParkingBrake = "parking brake",
        /// Button for release of the brakes by force.
        ForcedRelease = "forced release",
        /// Driverless initialisation or turn-back.
        TurnBack = "driverless turn-back",
        /// The line takes regenerated power.
        Regeneration = "line takes regenerated power",
    }
}

protocol::labelled! {
    /// Failure of a car's equipment that a bench makes.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    pub enum CarFailure: label {
        /// The inverter does nothing and does not answer.
        InverterSilent = "inverter silent",
        /// The brake control unit does nothing and does not answer.
        BrakeUnitSilent = "brake control unit silent",
        /// The brake cylinders get no pressure of the service brake.
        CylinderEmpty = "brake cylinders empty",
        /// The brake cylinders keep the pressure they have.
        BrakeStuck = "brake stuck",
    }
}

/// Equipment of a car that can be cut out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CutOut {
    Brake,
    Inverter,
}
