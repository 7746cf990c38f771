//! Profiles: target speed by time or by way.

mod approach;
mod guide;
mod jerk_limited;
mod pss;
mod s_curve;
mod station_stop;

pub use approach::{Approach, correction_mps2};
pub use guide::{Guide, GuideInputs, Reference};
pub use jerk_limited::{JerkLimited, Motion};
pub use pss::StopCurve;
pub use s_curve::{Reference, SCurve};
pub use station_stop::{Approach, last_metres};
