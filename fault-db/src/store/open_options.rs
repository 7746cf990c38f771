//! Options for opening a file for writing.

use crate::id::IdSource;

/// Durability of a commit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Synchronous {
    /// A commit is on the disk and survives a power cut. For everything that is recorded.
    Full,
    /// A commit is in the system's cache: it survives the program's death, but no power cut. For benchmarks.
    Normal,
}

/// Options of opening a file for writing.
#[derive(Debug)]
pub struct OpenOptions {
    pub(crate) ids: IdSource,
    pub(crate) busy_timeout_ms: u32,
    pub(crate) synchronous: Synchronous,
    pub(crate) max_pages: Option<u32>,
}

impl OpenOptions {
    /// The defaults: durable commits, five seconds' wait for other writers.
    pub fn new(ids: IdSource) -> Self {
        Self {
            ids,
            busy_timeout_ms: 5_000,
            synchronous: Synchronous::Full,
            max_pages: None,
        }
    }

    /// Sets how long to wait for another writer before the file counts as locked, ms.
    pub fn busy_timeout_ms(mut self, busy_timeout_ms: u32) -> Self {
        self.busy_timeout_ms = busy_timeout_ms;
        self
    }

    /// Sets the durability of a commit.
    pub fn synchronous(mut self, synchronous: Synchronous) -> Self {
        self.synchronous = synchronous;
        self
    }

    /// Keeps the file from growing beyond this many 4096-byte pages, to simulate a full disk.
    pub fn max_pages(mut self, max_pages: u32) -> Self {
        self.max_pages = Some(max_pages);
        self
    }
}
