//! The master controller: what its positions put on contacts and potentiometer, and what its voltage
//! means (S4 figure 2).

use crate::lever::Lever;

use super::data::TcmsData;

pub const FULL_BRAKE: i16 = -1024;
pub const FULL_POWER: i16 = 1023;
/// Distance by which the end positions lie inside the outer break points, V: outside of those the controller counts as
/// failed.
const INSIDE_V: f64 = 0.001;

/// Inputs of TCMS from a master controller.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ControllerInputs {
    /// P contact.
    pub power: bool,
    /// B contact.
    pub brake: bool,
    pub neutral: bool,
    /// Potentiometer, V.
    pub volts: f64,
    /// The controller's contact in the emergency brake train line is open.
    pub emergency: bool,
}

impl ControllerInputs {
    /// Whether contacts of the controller contradict each other.
    pub fn contradicts(&self) -> bool {
        self.power && self.brake || self.neutral && (self.power || self.brake)
    }
}

impl TcmsData {
    /// Inputs from the master controller at a position.
    pub fn at(&self, lever: Lever) -> ControllerInputs {
        let [a, b, c, d] = self.controller_v;
        let volts = match lever {
            Lever::Emergency => a,
            Lever::Brake(notch) => {
                let percent = self.brake_notches[usize::from(notch.clamp(1, 7)) - 1];
                b - percent / 100.0 * (b - a)
            }
            Lever::Neutral => 0.5 * (b + c),
            Lever::HalfPower => c + self.power_notches[0] / 100.0 * (d - c),
            Lever::Power(notch) => {
                c + self.power_notches[usize::from(notch.clamp(1, 4))] / 100.0 * (d - c)
            }
        };
        ControllerInputs {
            power: matches!(lever, Lever::HalfPower | Lever::Power(_)),
            brake: matches!(lever, Lever::Emergency | Lever::Brake(_)),
            neutral: lever == Lever::Neutral,
            volts: volts.clamp(a + INSIDE_V, d - INSIDE_V),
            emergency: lever == Lever::Emergency,
        }
    }

    /// Value of a voltage, −1024..1023: a voltage in a failure range, or not-a-number, is a full brake.
    pub fn value(&self, volts: f64) -> i16 {
        let [a, b, c, d] = self.controller_v;
        if self.controller_failed(volts) {
            FULL_BRAKE
        } else if volts < b {
            (-(b - volts) / (b - a) * f64::from(-FULL_BRAKE)).round() as i16
        } else if volts <= c {
            0
        } else {
            ((volts - c) / (d - c) * f64::from(FULL_POWER)).round() as i16
        }
    }

    /// The voltage is in a failure range, or is not a number.
    pub fn controller_failed(&self, volts: f64) -> bool {
        let [a, _, _, d] = self.controller_v;
        !(volts > a && volts < d)
    }
}
