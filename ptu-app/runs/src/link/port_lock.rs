//! A serial port is one tester's at a time: two of them would each disturb what the other measures.

use std::time::Duration;

use serialport::SerialPort;

use crate::failure::Failure;
use crate::platform;

/// Opens a port and keeps it to this program until it is closed.
///
/// # Errors
/// It is not there, or another program holds it, which is named where the system tells.
pub(crate) fn open_port(
    path: &str,
    baud: u32,
    waits: Duration,
) -> Result<Box<dyn SerialPort>, Failure> {
    platform::open_alone(path, baud, waits).map_err(|error| {
        Failure::bench(match platform::holder(path) {
            Some(who) => format!(
                "another program holds the port {path}: {who}; end it, or choose one of `ptu ports`"
            ),
            None => format!(
                "cannot open port {path}: {error}; check the cable, or choose one of `ptu ports`"
            ),
        })
    })
}
