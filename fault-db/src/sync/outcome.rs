//! What a sync did, and how far it is.

use serde::Serialize;

use crate::conflicts::StateConflict;
use crate::domain::Refusals;
use crate::id::Id;

/// What a sync is told by its caller.
pub struct SyncOptions<'a> {
    /// What the laptop is called on the server.
    pub laptop: &'a str,
    /// Whether samples go along; without them a later sync sends them.
    pub traces: bool,
    /// The file is a copy, or came back from a backup: it gets a name of its own, if the server has seen more of
    /// it or something else.
    pub as_copy: bool,
    /// Whether the owner of an unfinished run still lives; a run of a dead one is sent as it is.
    pub is_alive: &'a dyn Fn(&str) -> bool,
    /// The laptop's clock, µs since 1970, UTC.
    pub now_us: &'a dyn Fn() -> i64,
    /// Told after each batch; ends the sync there by answering no.
    pub go_on: &'a mut dyn FnMut(SyncProgress) -> bool,
}

/// What a sync is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SyncPhase {
    /// Runs, events and notes go to the server.
    Sending,
    /// Traces go to the server.
    SendingTraces,
    /// Events come from the server.
    Receiving,
}

/// How far a sync is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SyncProgress {
    /// What it is at.
    pub phase: SyncPhase,
    /// Entries done in this phase.
    pub done: u64,
    /// Entries there were to do when it began; of what comes, 0: nobody knows.
    pub total: u64,
}

/// What a sync did. It counts what was new to the other side.
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
    /// Events that came.
    pub events_received: u64,
    /// Faults of the file that they changed.
    pub faults_changed: u64,
    /// About as many bytes went over the wire, both ways.
    pub bytes: u64,
    /// Entries that wait for the next sync.
    pub waiting: u64,
    /// By how much the laptop's clock is ahead of the server's, µs.
    pub clock_offset_us: i64,
    /// What has the same id here and there and does not say the same; both were left as they are.
    pub different: Vec<Different>,
    /// Traces of the file that no longer fit their checksum; they were not sent.
    pub damaged_traces: Vec<Id>,
    /// Rows, here or there, that hold what no history holds: they were left where they are, and all else went on.
    pub refused: Refusals,
    /// Faults of the file that people who did not know of each other brought to different states.
    pub conflicts: Vec<StateConflict>,
    /// Whether it was stopped before its end.
    pub stopped: bool,
}

/// Something of which there are two versions.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Different {
    /// run, trace or chain.
    pub what: &'static str,
    /// Its id; of a chain of seals that of its file.
    pub id: Id,
}

impl SyncOutcome {
    /// A difference of the clocks that is more than a slow network makes.
    pub const CLOCK_TOLERANCE_US: i64 = 3_000_000;

    /// Whether the laptop's clock and the server's are apart.
    pub fn clocks_differ(&self) -> bool {
        self.clock_offset_us.abs() > Self::CLOCK_TOLERANCE_US
    }
}
