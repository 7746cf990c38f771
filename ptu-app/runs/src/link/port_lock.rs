//! A serial port is one tester's at a time: two of them would each disturb what the other measures.

use std::time::Duration;

use serialport::SerialPort;

use crate::failure::{Failure, NoUnit};
use crate::platform;

/// Opens a port and keeps it to this program until it is closed.
///
/// # Errors
/// The port is missing, or another program holds it; the error names that program where the system
/// tells.
pub(crate) fn open_port(
    path: &str,
    baud: u32,
    waits: Duration,
) -> Result<Box<dyn SerialPort>, Failure> {
    platform::open_alone(path, baud, waits).map_err(|error| {
        let path = path.to_owned();
        let held = match platform::holder(&path) {
            Some(who) => NoUnit::PortHeld(path, who),
            None => NoUnit::PortClosed(path, error.to_string()),
        };
        held.into()
    })
}
