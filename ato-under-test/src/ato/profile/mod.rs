//! Profiles: target speed by time or by way.

mod descent;
mod guide;
mod jerk_limited;
mod pss;
mod s_curve;
mod station_stop;

pub use descent::{Descent, correction_mps2};
pub use guide::{Guide, GuideInputs};
pub use jerk_limited::JerkLimited;
pub use pss::StopCurve;
pub use s_curve::{SCurve, Setpoint};
pub use station_stop::{LastMetres, LastRates, MarkerApproach};
