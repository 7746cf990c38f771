//! The train control and monitoring system around the unit, as the standard EMU (S4) and line 6 (S3)
//! have it. Sans-IO: stepped once a scan with what cabs, train lines, the unit and the train's equipment
//! give it.
//!
//! A scan, in this order: orders of ATO (`atc_link`), the cab that counts, the mode, the emergency
//! brake train line (`emergency_line`), what equipment has failed (`watch`), the full service brake
//! (`full_service_brake`), the holding brake (`holding_brake`), what cuts powering, the value
//! (`driving_control`, `controller`), and the effort of each car (`effort`: `powering`, `braking`,
//! `consist`).

mod atc_link;
mod braking;
mod consist;
mod controller;
mod data;
mod driving_control;
mod effort;
mod emergency_line;
mod full_service_brake;
mod holding_brake;
mod powering;
mod speed;
mod system;
mod timer;
mod watch;
mod words;

pub use consist::Consist;
pub use controller::ControllerInputs;
pub use data::TcmsData;
pub use effort::{Demands, Effort, Order};
pub use system::{CabInputs, Tcms, TcmsEvent, TcmsInputs, TcmsMode, TcmsView};
pub use words::{EbSources, Lamps, PowerCuts};
