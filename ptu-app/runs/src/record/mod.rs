//! A unit's own record of automatic runs, read where the unit is, becomes traces in the history.
//!
//! ```text
//! unit → unit_log::read_log (stored rows, clocks) → recorded (a trace for each run) → store (what is new)
//! trace → section (where it was) → compare (with its own target, and with a sound unit's run)
//! ```

mod compare;
mod recorded;
mod request;
mod section;
mod store;

pub(crate) use compare::compare;
pub use compare::{Parting, RecordComparison, StopComparison};
pub use recorded::RecordedRun;
pub(crate) use recorded::{Rest, recorded_runs};
pub use request::{CompareRequest, Compared};
pub(crate) use section::find_section;
pub use store::{Pulled, pull, pull_reading};

#[cfg(test)]
mod tests;
