//! A serial port that is read scan by scan.

extern crate std;

use std::boxed::Box;
use std::io::{Read, Result, Write};

use serialport::SerialPort;

use super::platform;

pub use platform::PORT_WAITS;

/// An open serial port whose reads take what is there; it was opened with the time-out [`PORT_WAITS`].
pub struct SerialEnd(pub Box<dyn SerialPort>);

impl Read for SerialEnd {
    fn read(&mut self, into: &mut [u8]) -> Result<usize> {
        platform::read_port(&mut *self.0, into)
    }
}

impl Write for SerialEnd {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        self.0.write(bytes)
    }

    fn flush(&mut self) -> Result<()> {
        self.0.flush()
    }
}
