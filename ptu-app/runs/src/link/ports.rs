//! Serial ports of this machine.

use std::path::Path;

use serde::Serialize;

use crate::failure::{Failure, RunTrouble};
pub use crate::platform::{closed_to_user, is_probed_by_others};

#[derive(Clone, Debug, Serialize)]
pub struct PortFound {
    pub path: String,
    /// `usb`, `bluetooth`, `pci` or `unknown`.
    pub kind: &'static str,
}

/// The serial ports found. A pseudo-terminal is not among them but can be named.
///
/// # Errors
/// The system does not tell.
pub fn found() -> Result<Vec<PortFound>, Failure> {
    // The library panics on a Linux without /sys, as in a bare container.
    if cfg!(target_os = "linux") && !Path::new("/sys/class/tty").is_dir() {
        return Ok(Vec::new());
    }
    let ports = serialport::available_ports()
        .map_err(|error| Failure::bench(RunTrouble::PortsNotListed(error.to_string())))?;
    let kind = |port: &serialport::SerialPortInfo| match port.port_type {
        serialport::SerialPortType::UsbPort(_) => "usb",
        serialport::SerialPortType::BluetoothPort => "bluetooth",
        serialport::SerialPortType::PciPort => "pci",
        serialport::SerialPortType::Unknown => "unknown",
    };
    let found = ports.iter().map(|port| PortFound {
        path: port.port_name.clone(),
        kind: kind(port),
    });
    Ok(found.collect())
}
