//! Maintenance of files: [check](crate::Store::check), backup, prune, merge.

mod backup;
mod check;
mod merge;
mod prune;

pub use check::{CheckReport, Problem};
pub use merge::{CopyOf, MergeCounts};
pub use prune::{PruneCounts, PruneRule};
