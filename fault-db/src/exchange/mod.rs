//! Replication: copies the rows of one store into another. REPLICATION.md describes it.
//!
//! A [`ChangeSet`](change_set::ChangeSet) holds rows of the declared [`tables`], read from a file or a server and
//! checked against their columns' domain. One of two appliers adds them: [`to_file`] to a SQLite file, [`to_server`] to
//! a PostgreSQL server. Applying a set twice changes nothing more. [`merge`] copies a whole file into another one,
//! [`sync`] exchanges batches with a server.

mod change_set;
mod checksum;
mod columns;
pub(crate) mod domain;
mod merge;
mod rows;
mod statements;
mod sync;
mod tables;
mod to_file;
mod to_server;

pub use merge::{CopyOf, MergeCounts};
pub use sync::{Difference, LastSync, SyncOptions, SyncOutcome, SyncPhase, SyncProgress};
