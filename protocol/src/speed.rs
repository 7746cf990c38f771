//! Speed as a type, made from and read in a named unit only: m/s, km/h or cm/s.

use core::fmt;
use core::ops::{Add, Sub};

/// A speed, metres per second inside; people see km/h, the wire carries cm/s.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Speed(f64);

impl Speed {
    /// At rest.
    pub const ZERO: Self = Self(0.0);

    /// From metres per second.
    pub const fn from_mps(mps: f64) -> Self {
        Self(mps)
    }

    /// From kilometres per hour.
    pub const fn from_kmh(kmh: f64) -> Self {
        Self(kmh / 3.6)
    }

    /// From centimetres per second, the unit on the wire.
    pub const fn from_cms(cms: u16) -> Self {
        Self(cms as f64 / 100.0)
    }

    /// Metres per second.
    pub const fn mps(self) -> f64 {
        self.0
    }

    /// Kilometres per hour.
    pub const fn kmh(self) -> f64 {
        self.0 * 3.6
    }

    /// Centimetres per second for the wire, rounded and limited to 0..=65535.
    pub fn to_cms(self) -> u16 {
        libm::round(self.0 * 100.0).clamp(0.0, 65535.0) as u16
    }

    /// The greater of two speeds.
    pub fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }

    /// The lesser of two speeds.
    pub fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0))
    }

    /// The size of the difference between two speeds.
    pub fn difference(self, other: Self) -> Self {
        Self(libm::fabs(self.0 - other.0))
    }
}

impl Add for Speed {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for Speed {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl fmt::Display for Speed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1} km/h", self.kmh())
    }
}
