//! What ATO does in place of people when the mode switch is at driverless.

mod station;

pub use station::{DeadOrders, Station, StationInputs};
