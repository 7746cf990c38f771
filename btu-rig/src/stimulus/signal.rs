//! The signal of a speed code in a coil.

use std::fmt;

use serde::{Deserialize, Serialize};

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
}

impl fmt::Display for CodeSignal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (carrier_hz, rate_hz, level_mv) = (self.carrier_hz, self.rate_hz, self.level_mv);
        write!(f, "{carrier_hz} Hz, code rate {rate_hz} Hz, {level_mv} mV")
    }
}
