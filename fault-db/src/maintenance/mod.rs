//! Maintenance of files: [check](crate::Store::check), backup, prune.

mod backup;
mod check;
mod prune;

pub(crate) use check::has_its_traces;
pub use check::{CheckReport, KeyUse, Problem, Verification};
pub use prune::{PruneCounts, PruneRule};
