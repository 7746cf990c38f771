//! The signal of a speed code in a coil.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::ranges::{U16_MAX, in_range};
use crate::procedure::Refusal;

/// Highest code rate, Hz: the catalogue's range, just below what 0.01 Hz in 16 bits can say.
pub const MAX_RATE_HZ: f64 = 655.0;

/// Carrier with a code; by default none. Rate 0 = unmodulated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CodeSignal {
    /// Carrier, Hz.
    pub carrier_hz: f64,
    /// Code rate, Hz.
    pub rate_hz: f64,
    /// Level, mV.
    pub level_mv: f64,
}

impl CodeSignal {
    pub const fn new(carrier_hz: f64, rate_hz: f64, level_mv: f64) -> Self {
        Self {
            carrier_hz,
            rate_hz,
            level_mv,
        }
    }

    /// The signal, if the antenna can have it.
    pub(crate) fn in_antenna(self) -> Result<Self, Refusal> {
        in_range("carrier", self.carrier_hz, 0.0, U16_MAX, "Hz")?;
        in_range("code rate", self.rate_hz, 0.0, MAX_RATE_HZ, "Hz")?;
        in_range("level", self.level_mv, 0.0, U16_MAX, "mV")?;
        Ok(self)
    }
}

impl fmt::Display for CodeSignal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (carrier_hz, rate_hz, level_mv) = (self.carrier_hz, self.rate_hz, self.level_mv);
        write!(f, "{carrier_hz} Hz, code rate {rate_hz} Hz, {level_mv} mV")
    }
}
