//! Wayside inputs of the unit: speed codes in its antenna, markers, the section, station data and orders.

mod antenna;
mod markers;
mod order_sender;
mod step_profile;
mod track;
mod twc;

pub use antenna::{Antenna, in_antenna};
pub use markers::Markers;
pub use track::Track;
pub use twc::{Wayside, wire_data};
