//! Pipes to child processes.

use std::process::ChildStdin;

/// A pipe has the length that the system gives it.
pub fn shorten_pipe(_to: &ChildStdin) {}
