//! Data of a train's doors.

use serde::{Deserialize, Serialize};

/// Times of the door drives.
#[derive(Clone, Debug, PartialEq, Deserialize, schemars::JsonSchema, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct DoorData {
    /// Time in which a closed door opens, s.
    pub opening_s: f64,
    /// Time in which an open door closes and locks, s.
    pub closing_s: f64,
}

/// Doors of line 6, for trains without this table.
impl Default for DoorData {
    fn default() -> Self {
        Self {
            opening_s: 2.5,
            closing_s: 3.0,
        }
    }
}
