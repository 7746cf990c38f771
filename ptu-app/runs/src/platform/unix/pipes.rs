//! Pipes to child processes.

use std::process::ChildStdin;

/// Least bytes that a pipe of Linux can hold.
#[cfg(target_os = "linux")]
const LEAST: usize = 4_096;

/// Makes the pipe as short as possible: bytes in the pipe are still heard when this process has ended. A system that
/// refuses has its usual pipe.
#[cfg(target_os = "linux")]
pub fn shorten_pipe(to: &ChildStdin) {
    let _ = rustix::pipe::fcntl_setpipe_size(to, LEAST);
}

/// A pipe has the length that the system gives it.
#[cfg(not(target_os = "linux"))]
pub fn shorten_pipe(_to: &ChildStdin) {}
