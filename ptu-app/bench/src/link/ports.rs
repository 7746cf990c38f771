//! Serial ports of this machine.

use std::path::Path;

use serde::Serialize;

use crate::failure::Failure;

/// A serial port.
#[derive(Clone, Debug, Serialize)]
pub struct PortFound {
    /// Its path.
    pub path: String,
    /// `usb`, `bluetooth`, `pci` or `unknown`.
    pub kind: &'static str,
}

/// Whether this user may not read and write a port that is there: then the group whose members may, if there is one.
#[cfg(unix)]
pub fn closed_to_user(path: &str) -> Option<Option<String>> {
    use rustix::fs::{Access, access};
    use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _};
    if access(path, Access::READ_OK | Access::WRITE_OK).is_ok() {
        return None;
    }
    let about = std::fs::metadata(path).ok()?;
    let groups = std::fs::read_to_string("/etc/group").unwrap_or_default();
    let of_port = groups.lines().find_map(|line| {
        let mut fields = line.split(':');
        let name = fields.next()?;
        (fields.nth(1)? == about.gid().to_string()).then(|| name.to_owned())
    });
    let may = about.permissions().mode() & 0o060 == 0o060;
    Some(of_port.filter(|_| may))
}

/// The same: elsewhere every user may.
#[cfg(not(unix))]
pub fn closed_to_user(_path: &str) -> Option<Option<String>> {
    None
}

/// Where the package puts the rule that keeps others from serial adapters, and where an administrator does.
const RULES: [&str; 2] = [
    "/usr/lib/udev/rules.d/60-ptu.rules",
    "/etc/udev/rules.d/60-ptu.rules",
];

/// A service that takes serial adapters for modems is running, and nothing keeps it from them.
pub fn is_probed_by_others() -> bool {
    let processes = std::fs::read_dir("/proc").into_iter().flatten().flatten();
    let mut names =
        processes.filter_map(|entry| std::fs::read_to_string(entry.path().join("comm")).ok());
    names.any(|name| name.trim() == "ModemManager")
        && !RULES.iter().any(|rule| Path::new(rule).exists())
}

/// Those found; a pseudo-terminal is not among them but can be named.
///
/// # Errors
/// The system does not tell.
pub fn found() -> Result<Vec<PortFound>, Failure> {
    // The library panics on a Linux without /sys, as in a bare container.
    if cfg!(target_os = "linux") && !Path::new("/sys/class/tty").is_dir() {
        return Ok(Vec::new());
    }
    let ports = serialport::available_ports()
        .map_err(|error| Failure::bench(format!("cannot list serial ports: {error}")))?;
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
