//! Links to a unit: the embedded one, or one on a port.

mod delayed;
mod pace;
mod port_lock;
pub mod ports;
mod sim;
mod tcp;
mod wire;

pub use crate::endpoint::Endpoint;
pub use ato_under_test::serve::keep_time;
pub use delayed::Delayed;
pub use pace::Pace;
pub(crate) use port_lock::open_port;
pub use sim::{SIM_SERIAL, SimLink};
pub(crate) use tcp::connect_to;
pub use wire::WireLink;
