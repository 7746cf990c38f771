//! Positions of the master controller.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Position of the master controller (S3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Lever {
    /// Opens the emergency brake train line.
    Emergency,
    /// Brake notch B1 to B7.
    Brake(u8),
    /// Neutral: coasting.
    #[default]
    Neutral,
    /// Half of the first power notch, P0.5.
    HalfPower,
    /// Power notch P1 to P4.
    Power(u8),
}

impl Lever {
    /// All positions, from full brake to full power.
    pub const ALL: [Self; 14] = [
        Self::Emergency,
        Self::Brake(7),
        Self::Brake(6),
        Self::Brake(5),
        Self::Brake(4),
        Self::Brake(3),
        Self::Brake(2),
        Self::Brake(1),
        Self::Neutral,
        Self::HalfPower,
        Self::Power(1),
        Self::Power(2),
        Self::Power(3),
        Self::Power(4),
    ];

    /// The position that scripts write as a number: −8 emergency, −7 to −1, 0, 0.5, 1 to 4.
    pub fn from_number(number: f64) -> Option<Self> {
        Self::ALL.into_iter().find(|lever| lever.number() == number)
    }

    /// The position with a name: `EB`, `B7` to `B1`, `N`, `P0.5`, `P1` to `P4`.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|lever| lever.to_string().eq_ignore_ascii_case(name))
    }

    pub fn number(self) -> f64 {
        match self {
            Self::Emergency => -8.0,
            Self::Brake(notch) => -f64::from(notch),
            Self::Neutral => 0.0,
            Self::HalfPower => 0.5,
            Self::Power(notch) => f64::from(notch),
        }
    }

    /// Position as the unit's input has it; P0.5 counts as P1.
    pub fn wire(self) -> i8 {
        match self {
            Self::Emergency => -8,
            Self::Brake(notch) => -(notch as i8),
            Self::Neutral => 0,
            Self::HalfPower => 1,
            Self::Power(notch) => notch as i8,
        }
    }
}

impl fmt::Display for Lever {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Emergency => f.write_str("EB"),
            Self::Brake(notch) => write!(f, "B{notch}"),
            Self::Neutral => f.write_str("N"),
            Self::HalfPower => f.write_str("P0.5"),
            Self::Power(notch) => write!(f, "P{notch}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_position_is_found_by_number_and_name() {
        for lever in Lever::ALL {
            assert_eq!(Lever::from_number(lever.number()), Some(lever));
            assert_eq!(Lever::from_name(&lever.to_string()), Some(lever));
        }
        for wrong in [-9.0, 0.25, 5.0, f64::NAN] {
            assert_eq!(Lever::from_number(wrong), None);
        }
        assert_eq!(Lever::from_name("P5"), None);
    }
}
