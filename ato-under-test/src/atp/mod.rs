//! ATP: the part that keeps the train safe. Scanned every 10 ms; the mode sequence runs with the
//! 50 ms cycle.

mod code;
mod direction;
mod doors;
mod emergency;
mod mode;
mod overspeed;
mod speedometer;
mod supervisor;
mod tachometers;

pub use code::{Code, CodeDecoder};
pub use doors::{DoorInputs, Doors};
pub use emergency::{BrakeInputs, EmergencyBrake};
pub use mode::{ModeInputs, ModeSequence};
pub use overspeed::{Overspeed, Supervision};
pub use supervisor::{Atp, ScanContext};
pub use tachometers::Tachometers;
