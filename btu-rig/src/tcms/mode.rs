//! The mode TCMS drives in (S4).

use protocol::message::ModeSwitch;

use super::atc_link::AtoOrder;
use super::inputs::CabInputs;

/// Driver of the train, by the mode bits of the paper's modules.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Driver {
    /// The driver: emergency, yard and manual mode.
    Hand,
    /// ATO: automatic and driverless mode.
    Ato,
}

impl Driver {
    /// `None` when no mode is on, or more than one.
    pub fn of(by_hand: [bool; 3], by_ato: [bool; 2]) -> Option<Self> {
        let count = |modes: &[bool]| modes.iter().filter(|on| **on).count();
        match (count(&by_hand), count(&by_ato)) {
            (1, 0) => Some(Self::Hand),
            (0, 1) => Some(Self::Ato),
            _ => None,
        }
    }
}

/// Mode TCMS drives in (S4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TcmsMode {
    /// No cab is active, or the mode switch of the active cab is off.
    #[default]
    None,
    /// Mode switch at emergency: the driver has the train.
    Emergency,
    /// Mode switch at yard: the driver has the train.
    Yard,
    /// The driver has the train; also with the switch at automatic or driverless until the unit is in automatic.
    Manual,
    /// ATO drives, a driver in the cab.
    Automatic,
    /// ATO drives, the cab is empty.
    Driverless,
}

impl TcmsMode {
    /// Mode of the active cab. Automatic and driverless only while the unit is in automatic: until
    /// then, and after it, the driver has the train.
    pub(super) fn of(cab: Option<&CabInputs>, order: &AtoOrder) -> Self {
        match cab.map_or(ModeSwitch::Off, |cab| cab.mode_switch) {
            ModeSwitch::Off | ModeSwitch::Unknown(_) => Self::None,
            ModeSwitch::Emergency => Self::Emergency,
            ModeSwitch::Yard => Self::Yard,
            ModeSwitch::Automatic if order.automatic => Self::Automatic,
            ModeSwitch::Driverless if order.automatic => Self::Driverless,
            ModeSwitch::Manual | ModeSwitch::Automatic | ModeSwitch::Driverless => Self::Manual,
        }
    }

    /// Place among the labels of the signal `tcms_mode`.
    pub fn code(self) -> u8 {
        self as u8
    }

    /// Whether P, B and effort are ATO's.
    pub fn by_ato(self) -> bool {
        matches!(self, Self::Automatic | Self::Driverless)
    }
}
