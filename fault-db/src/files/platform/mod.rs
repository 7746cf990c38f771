//! Functions that differ by operating system, under the same names for each: rights and identity of a file, and the
//! places of libpq's files.

use std::path::Path;

#[cfg(unix)]
mod unix;
#[cfg(windows)]
mod windows;

#[cfg(unix)]
use unix as system;
#[cfg(windows)]
use windows as system;

pub(crate) use system::{
    LOCKS_BIND_ALL, LOGGED_IN, for_all, for_owner, host, is_open_to_others, password_file,
    special_kind,
};

/// Identity of a file, independent of its names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Identity {
    device: u64,
    number: u64,
    pub(crate) names: u64,
}

impl Identity {
    /// Identity of the file at a path; `None` if there is no such file, or if the system does not number files.
    pub(crate) fn at(path: &Path) -> Option<Self> {
        system::identity(&std::fs::metadata(path).ok()?)
    }

    /// Whether both are the same file, even under different names.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        (self.device, self.number) == (other.device, other.number)
    }
}
