//! The train control and monitoring system around the unit, as the standard EMU (S4) and line 6 (S3)
//! have it. Sans-IO: stepped every 20 ms, which is a scan of TCMS, with what cabs, train lines, the unit and the
//! train's equipment give it.
//!
//! A scan, in this order (`system`): orders of the unit (`atc_link`), the active cab (`inputs`), the `mode`, the
//! emergency brake train line (`emergency_line`), what equipment has failed (`equipment_monitor`, `not_released`), the
//! full service brake (`full_service_brake`), the holding brake (`holding_brake`), what cuts powering (`causes`), the
//! value of powering or braking (`driving_control`, `controller`), the effort of each car (`effort`: `powering`,
//! `braking`, `consist`), the change of cabs (`cab_change`), and what is reported (`view`, `feedback`, `report`).

mod atc_link;
mod braking;
mod cab_change;
mod cause_bits;
mod causes;
mod consist;
mod controller;
mod data;
mod driving_control;
mod effort;
mod emergency_line;
mod equipment_monitor;
mod feedback;
mod full_service_brake;
mod holding_brake;
mod inputs;
mod mode;
mod not_released;
mod powering;
mod report;
mod speed;
mod system;
mod timer;
mod view;

pub use cab_change::CabOrder;
pub use cause_bits::{EbSources, Lamps, PowerCuts, names_of};
pub use consist::Consist;
pub use controller::{ControllerInputs, FULL_BRAKE, FULL_POWER};
pub use data::TcmsData;
pub use driving_control::{DrivingInputs, DrivingOutputs, driving_control};
pub use effort::{Demands, Effort, Order};
pub use emergency_line::{Line, LineInputs, emergency_line};
pub use equipment_monitor::EquipmentFailures;
pub use full_service_brake::{BrakeInputs, BrakeOutputs, full_service_brake};
pub use holding_brake::{HoldingBrake, HoldingInputs};
pub use inputs::{CabInputs, TcmsInputs};
pub use mode::TcmsMode;
pub use system::Tcms;
pub use view::{TcmsEvent, TcmsView};
