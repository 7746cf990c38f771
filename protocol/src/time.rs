//! Virtual time: integer microseconds, made from numbers and never from a clock.

use core::fmt;
use core::ops::{Add, AddAssign, Sub};

use serde::{Deserialize, Serialize};

/// Control and communication cycle [S0 §2: 50 ms].
pub const CYCLE: Duration = Duration::from_ms(50);
/// I/O scan: ATP supervision, tachometer counts and marker edges.
pub const SCAN: Duration = Duration::from_ms(10);

/// A point in virtual time, microseconds since the start of the program that counts it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Instant(u64);

/// A span of virtual time in microseconds; stored as their number.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(transparent)]
pub struct Duration(u64);

impl Instant {
    /// The beginning of time.
    pub const ZERO: Self = Self(0);

    /// The instant `us` microseconds after [`Instant::ZERO`].
    pub const fn from_us(us: u64) -> Self {
        Self(us)
    }

    /// The instant `ms` milliseconds after [`Instant::ZERO`].
    pub const fn from_ms(ms: u64) -> Self {
        Self(ms * 1000)
    }

    /// Microseconds since [`Instant::ZERO`].
    pub const fn as_us(self) -> u64 {
        self.0
    }

    /// Seconds since [`Instant::ZERO`].
    pub fn as_secs(self) -> f64 {
        self.0 as f64 / 1e6
    }

    /// The time stamp that goes on the wire: whole milliseconds, wrapping at 2^32.
    pub const fn stamp_ms(self) -> u32 {
        (self.0 / 1000) as u32
    }

    /// Time since `earlier`, zero if `earlier` is later.
    pub const fn since(self, earlier: Self) -> Duration {
        Duration(self.0.saturating_sub(earlier.0))
    }

    /// This instant moved back, not before [`Instant::ZERO`].
    pub const fn back(self, span: Duration) -> Self {
        Self(self.0.saturating_sub(span.0))
    }
}

impl Duration {
    /// No time.
    pub const ZERO: Self = Self(0);

    /// A span of `us` microseconds.
    pub const fn from_us(us: u64) -> Self {
        Self(us)
    }

    /// A span of `ms` milliseconds.
    pub const fn from_ms(ms: u64) -> Self {
        Self(ms * 1000)
    }

    /// A span of `secs` seconds; negative and not-a-number give zero.
    pub fn from_secs(secs: f64) -> Self {
        Self(libm::round(secs.max(0.0) * 1e6) as u64)
    }

    /// Microseconds.
    pub const fn as_us(self) -> u64 {
        self.0
    }

    /// The span times a number.
    pub const fn times(self, count: u32) -> Self {
        Self(self.0 * count as u64)
    }

    /// Whole milliseconds.
    pub const fn as_ms(self) -> u64 {
        self.0 / 1000
    }

    /// Seconds.
    pub fn as_secs(self) -> f64 {
        self.0 as f64 / 1e6
    }
}

impl Add<Duration> for Instant {
    type Output = Self;
    fn add(self, span: Duration) -> Self {
        Self(self.0 + span.0)
    }
}

impl AddAssign<Duration> for Instant {
    fn add_assign(&mut self, span: Duration) {
        self.0 += span.0;
    }
}

impl Add for Duration {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for Duration {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }
}

impl AddAssign for Duration {
    fn add_assign(&mut self, other: Self) {
        self.0 += other.0;
    }
}

impl fmt::Display for Instant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.3} s", self.as_secs())
    }
}

impl fmt::Display for Duration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.3} s", self.as_secs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stamp_wraps_and_differences_saturate() {
        let late = Instant::from_ms((1 << 32) + 7);
        assert_eq!(late.stamp_ms(), 7);
        assert_eq!(Instant::ZERO.since(late), Duration::ZERO);
        assert_eq!(Duration::from_secs(-1.0), Duration::ZERO);
        assert_eq!(Duration::from_secs(f64::NAN), Duration::ZERO);
    }
}
