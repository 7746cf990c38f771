//! PSM: where the train is in its section, from distance run, corrected at markers whose order and
//! place are checked; and the health of TRA [S0 §3.3].

mod debounce;
mod locator;
mod marker_check;
mod odometer;

mod tacho_compare;
mod tra;
mod ways;
mod wheel;

pub use debounce::Debounce;
pub use locator::Locator;
pub use odometer::{Movement, Odometer};
pub use tacho_compare::{MarkerSpan, TachoCompare, WheelMotion};
pub use tra::Tra;
pub use wheel::WheelCalibration;
