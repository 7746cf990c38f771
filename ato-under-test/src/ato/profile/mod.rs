//! Profiles: target speed by time or by way.

mod pss;

pub use pss::StopCurve;
