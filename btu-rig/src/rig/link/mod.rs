//! Data from the unit: whether they come by the bench harness, how well the line carries them, and the latest value
//! of each signal.

mod clock_rate;
mod harness;
mod lateness;
mod line_watch;
mod link_watch;
mod sample;
mod signal_sources;

pub use harness::{Harness, HarnessWatch};
pub use line_watch::LineWatch;
pub use link_watch::LinkWatch;
pub use sample::LatestSample;
pub use signal_sources::told_by_train_state;
