//! Stimuli: everything that can be done to a unit, as typed values that scripts build and the rig carries
//! out.

mod conditions;
mod orders;
pub(crate) mod ranges;
mod signal;
mod station;
mod table;
pub(crate) mod text;

pub use conditions::{
    CarFailure, CutOut, DoorLine, DoorState, TachoCondition, TcmsCondition, TrainSwitch,
    WaysideCondition,
};
pub use orders::OrderData;
pub use signal::CodeSignal;
pub use station::StationData;
pub use table::{Stimulus, Way};
pub use text::number;

/// Steepest gradient that can be added to the track's, ‰.
pub const MAX_GRADIENT_PERMILLE: f64 = 100.0;
