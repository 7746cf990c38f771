//! Station-to-station automatic runs on the embedded unit.

mod bench;
mod settings;

pub use bench::{DriveBench, drive};
pub use settings::{Setting, unit_config};
