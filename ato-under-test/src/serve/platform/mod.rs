//! Functions that differ by operating system, under one name for all: pseudo-terminals, reads of serial ports and
//! priorities.

#[cfg(unix)]
mod unix;
#[cfg(windows)]
mod windows;

#[cfg(unix)]
pub use unix::{PORT_WAITS, Pty, keep_time, read_port};
#[cfg(windows)]
pub use windows::{PORT_WAITS, Pty, keep_time, read_port};
