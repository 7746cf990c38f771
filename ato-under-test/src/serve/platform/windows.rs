//! Windows.

extern crate std;

use std::io::{Error, ErrorKind, Read, Result, Write};
use std::string::String;
use std::time::Duration;

use serialport::SerialPort;
use thread_priority::windows::{
    WinAPIThreadPriority, set_winapi_thread_priority, thread_native_id,
};

/// Longest wait of a write to a serial port: a frame takes some milliseconds to go out. No read waits
/// ([`read_port`]).
pub const PORT_WAITS: Duration = Duration::from_millis(100);

/// A pseudo-terminal, of which there is none.
pub enum Pty {}

impl Pty {
    /// Refuses: Windows has no pseudo-terminal.
    ///
    /// # Errors
    /// Always.
    pub fn open(_: bool) -> Result<(Self, String)> {
        let what = "Windows has none; serve with --tcp or --serial";
        Err(Error::new(ErrorKind::Unsupported, what))
    }
}

impl Read for Pty {
    fn read(&mut self, _: &mut [u8]) -> Result<usize> {
        match *self {}
    }
}

impl Write for Pty {
    fn write(&mut self, _: &[u8]) -> Result<usize> {
        match *self {}
    }

    fn flush(&mut self) -> Result<()> {
        match *self {}
    }
}

/// Reads what is there: a read of the system would wait for more.
///
/// # Errors
/// There is nothing, or the port is gone.
pub fn read_port(port: &mut dyn SerialPort, into: &mut [u8]) -> Result<usize> {
    let there = port.bytes_to_read()? as usize;
    match there.min(into.len()) {
        0 => Err(ErrorKind::WouldBlock.into()),
        some => port.read(&mut into[..some]),
    }
}

/// Asks the system to let nothing else delay the present thread, which keeps time from now on. Returns whether the
/// system lets it.
pub fn keep_time() -> bool {
    set_winapi_thread_priority(thread_native_id(), WinAPIThreadPriority::Highest).is_ok()
}
