//! Options, progress and result of a sync.

use serde::Serialize;

use crate::exchange::domain::Refusals;
use crate::history::conflicts::StateConflict;
use crate::id::Id;

/// Options of a sync.
pub struct SyncOptions<'a> {
    /// The laptop's name on the server.
    pub laptop: &'a str,
    /// Whether traces are sent, too; otherwise a later sync sends them.
    pub traces: bool,
    /// The file is a copy, or was restored from a backup: it gets an id of its own if the server has more entries of
    /// its chain, or other ones.
    pub as_copy: bool,
    /// The laptop's clock, µs since 1970, UTC.
    pub now_us: &'a dyn Fn() -> i64,
    /// Called after each batch; returning `false` ends the sync there.
    pub go_on: &'a mut dyn FnMut(SyncProgress) -> bool,
}

/// The phase of a sync.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SyncPhase {
    /// Runs, events and notes are sent.
    Sending,
    /// Traces are sent.
    SendingTraces,
    /// Events are received.
    Receiving,
}

/// The progress of a sync.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SyncProgress {
    /// The current phase.
    pub phase: SyncPhase,
    /// Entries done in this phase.
    pub done: u64,
    /// Entries in this phase when it began; 0 when receiving, as the number is not known.
    pub total: u64,
}

/// The result of a sync. Counts are of rows that were new to the receiving side.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SyncOutcome {
    /// Runs sent.
    pub runs: u64,
    /// Occurrences of faults sent.
    pub occurrences: u64,
    /// Events sent.
    pub events: u64,
    /// Notes on runs sent.
    pub notes: u64,
    /// Traces sent.
    pub traces: u64,
    /// Entries that the server had already, from an earlier sync or another laptop.
    pub already_there: u64,
    /// Events received.
    pub events_received: u64,
    /// Faults of the file that the received events changed.
    pub faults_changed: u64,
    /// Approximate bytes transferred, both ways.
    pub bytes: u64,
    /// Entries that wait for the next sync.
    pub waiting: u64,
    /// Time by which the laptop's clock is ahead of the server's, µs.
    pub clock_offset_us: i64,
    /// Rows with the same id and different content on both sides; both were left as they are.
    pub different: Vec<Difference>,
    /// Traces of the file that do not match their checksum; they were not sent.
    pub damaged_traces: Vec<Id>,
    /// Rows on either side outside their columns' domain: they stay where they are, and all other rows were processed.
    pub refused: Refusals,
    /// Faults of the file in conflict.
    pub conflicts: Vec<StateConflict>,
    /// Whether the caller stopped the sync.
    pub stopped: bool,
}

/// A run, trace or chain with different content on both sides.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Difference {
    /// run, trace or chain.
    pub what: &'static str,
    /// Id of the row; for a chain of seals the id of its file.
    pub id: Id,
}

impl SyncOutcome {
    /// Clock offset, µs, above which a slow network no longer explains it.
    pub const CLOCK_TOLERANCE_US: i64 = 3_000_000;

    /// Whether the clocks differ by more than the tolerance.
    pub fn clocks_differ(&self) -> bool {
        self.clock_offset_us.abs() > Self::CLOCK_TOLERANCE_US
    }
}
