//! Maintenance of files: [check](crate::Store::check), backup, prune.

mod backup;
mod check;
mod prune;

pub use check::{
    Advice, CheckReport, Damage, Derived, KeyUse, Problem, ProblemKind, Samples, SchemaObject,
    SealPlace, Verification, WrongSignature,
};
pub use prune::{PruneCounts, PruneRule};
