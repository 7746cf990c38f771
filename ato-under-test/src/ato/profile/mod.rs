//! Profiles: target speed by time or by distance.

mod descent;
mod jerk_limited;
mod pss;
mod reference;
mod s_curve;
mod station_stop;

pub use descent::{Descent, correction_mps2};
pub use jerk_limited::JerkLimited;
pub use pss::StopCurve;
pub use reference::{Reference, ReferenceGenerator};
pub use s_curve::{SCurve, Setpoint};
pub use station_stop::{FinalStop, FinalStopLimits, MarkerApproach};
