//! Driverless operation's part of the unit configuration.

use serde::{Deserialize, Serialize};

/// Times of the door sequence at a station.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DriverlessConfig {
    /// How long doors stand open at least, ms.
    pub dwell_min_ms: u32,
    /// Time within which doors that are ordered to open must be seen open, ms.
    pub open_ms: u32,
    /// Time within which doors that are ordered to close must be proved closed and locked, ms.
    pub close_ms: u32,
    /// How long doors that did not close are ordered to open, ms.
    pub reopen_ms: u32,
    /// Number of attempts to close.
    pub close_tries: u8,
}

/// The values of `sg100`, for configurations without this table.
impl Default for DriverlessConfig {
    fn default() -> Self {
        Self {
            dwell_min_ms: 5000,
            open_ms: 3000,
            close_ms: 4000,
            reopen_ms: 2000,
            close_tries: 3,
        }
    }
}
