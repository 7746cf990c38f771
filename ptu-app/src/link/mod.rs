//! Links to a unit: the embedded one, or one on a port.

mod pace;
mod sim;
mod wire;

pub use pace::Pace;
pub use sim::{SIM_SERIAL, SimLink};
pub use wire::{Endpoint, WireLink};
