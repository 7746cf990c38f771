//! Work of ATO in place of people when the mode switch is at driverless: doors at stations, turn-back with change of
//! cabs, put-away and wake-up.

mod cabs;
mod stabling;
mod station;

pub use cabs::{CabInputs, Cabs};
pub use stabling::{Stabling, StablingInputs};
pub use station::{Station, StationInputs};
