//! Fault modes as data: the place in the signal path, the effect there (`check` has the permitted ones), when
//! it acts ([`Occurrence`]) and how strongly (`levels`). The [`FaultCatalogue`] lists them with their
//! parts.
//!
//! The unit applies fault modes at its own places, the rig those of the train, its wiring and the bench. Nothing that
//! judges a result can read them.

mod catalogue;
mod check;
mod levels;
mod occurrence;
mod place;

use alloc::string::String;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use crate::LruId;

pub use catalogue::{FaultCatalogue, Lru};
pub use check::MAX_CARS;
pub use levels::FaultKind;
pub use occurrence::{Occurrence, OccurrenceState};
pub use place::Place;

/// Effect of a fault at its place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case", tag = "kind", deny_unknown_fields)]
pub enum Effect {
    /// Nothing comes through.
    Dead,
    /// Stays on, energised or high.
    StuckOn,
    /// Stays off, de-energised or low.
    StuckOff,
    /// The value is multiplied.
    Gain {
        /// Factor; 1 = no effect.
        factor: f64,
    },
    /// The value is moved.
    Offset {
        /// Amount by which the value is moved, in the place's own unit (Hz, km/h, m, effort …).
        by: f64,
    },
    /// The value is kept within bounds.
    Limit {
        /// Greatest size that comes through.
        to: f64,
    },
    /// The value, contact or frame comes late.
    Delay {
        /// Delay, ms.
        ms: u32,
    },
    /// What comes through comes a second time.
    Bounce {
        /// Time from the first to the second, ms.
        ms: u32,
    },
    /// One marker does not come through.
    Deaf {
        /// Number of this marker, 1 to 4.
        to_marker: u8,
    },
    /// Spurious or missing pulses.
    Noise {
        /// Mean events per second.
        per_s: f64,
    },
    /// Frames are sent or received with wrong bits.
    BitErrors {
        /// Share of frames hit, 0..1.
        rate: f64,
    },
}

crate::labelled! {
    /// What a laptop alone lacks to find a fault. The laptop has the maintenance port of a unit on a train at rest in a
    /// depot, and with it the TEST board, the antennas' test coils, the unit's read-backs, its self-test and its log.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
    #[serde(rename_all = "snake_case")]
    pub enum OutOfReach: word {
        /// Wheels that turn, or a train that is driven.
        Motion = "motion",
        /// Somebody at the desk of a cab, or at its doors.
        Cab = "cab",
        /// The train's own equipment, or a code in the rail.
        Train = "train",
    }
}

/// One fault mode of one part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FaultMode {
    /// Identifier, `part.mode`.
    pub id: String,
    /// Part to replace.
    pub lru: LruId,
    /// Name of the mode, for people.
    pub mode: String,
    /// Label of a [`Severity`](crate::event::Severity) of faults.
    pub severity: String,
    /// Relative prior weight, a bench default.
    pub weight: f64,
    /// The fault can leave the train less protected.
    #[serde(rename = "unsafe")]
    pub unsafe_: bool,
    /// Where the fault sits in the signal path.
    pub place: Place,
    /// Effect of the fault.
    pub effect: Effect,
    /// What a laptop alone lacks to find the fault; `None` = the laptop should find it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub out_of_reach: Option<OutOfReach>,
    /// When the fault begins, s after power-up.
    #[serde(default)]
    pub onset_s: f64,
    /// Car with the fault, counted from the head of the train; only at places that are on cars.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub car: Option<u8>,
    /// When the fault acts, once it has begun.
    #[serde(default, skip_serializing_if = "Occurrence::is_always")]
    pub occurs: Occurrence,
    /// Other values that the effect's number may have in a part with this fault.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub levels: Vec<f64>,
}
