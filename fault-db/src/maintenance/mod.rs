//! Maintenance of files: [check](crate::Store::check), backup, prune.

mod backup;
mod check;
mod prune;

pub use check::{CheckReport, KeyUse, Problem, Verification};
pub use prune::{PruneCounts, PruneRule};
