//! Opens serial ports, and tells whether one is held: a COM port is one program's at a time here anyway.

use std::time::Duration;

use serialport::SerialPort;

/// Opens a port. Reads and writes wait for so long.
pub fn open_alone(
    path: &str,
    baud: u32,
    waits: Duration,
) -> serialport::Result<Box<dyn SerialPort>> {
    serialport::new(path, baud).timeout(waits).open()
}

/// A port that is there and cannot be opened is another program's. Windows does not say whose.
pub fn holder(path: &str) -> Option<String> {
    let ports = serialport::available_ports().ok()?;
    let is_there = ports
        .iter()
        .any(|port| port.port_name.eq_ignore_ascii_case(path));
    is_there.then(|| "Windows does not say which".into())
}

/// Every user may open every port.
pub fn closed_to_user(_path: &str) -> Option<Option<String>> {
    None
}

/// Nothing here writes to adapters that are plugged in.
pub fn is_probed_by_others() -> bool {
    false
}
