//! Data from the unit: at a harness or on a train, how well the line carries it, and the latest value of each
//! signal.

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
