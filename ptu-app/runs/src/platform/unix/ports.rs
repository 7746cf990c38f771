//! Opens serial ports, and tells who holds one.
//!
//! The lock is the kernel's advisory one, which terminal programs respect, too, and which ends with its process however
//! that ends. A port of hardware is closed to all other programs besides; a pseudo-terminal is not, because that would
//! outlast a killed tester as long as the other end is open.

use std::fs::{File, OpenOptions};
use std::os::unix::fs::{MetadataExt as _, OpenOptionsExt as _, PermissionsExt as _};
use std::path::Path;
use std::time::Duration;

use rustix::fs::{Access, OFlags, access};
use rustix::termios::ioctl_tiocnxcl;
use serialport::SerialPort;

/// Opens a port and locks it until it is closed. Reads and writes wait for `waits` at most.
pub fn open_alone(
    path: &str,
    baud: u32,
    waits: Duration,
) -> serialport::Result<Box<dyn SerialPort>> {
    let beside = is_pseudo_terminal(path)
        .then(|| open_beside(path))
        .flatten();
    let port = serialport::new(path, baud)
        .timeout(waits)
        .exclusive(true)
        .open()?;
    if let Some(beside) = beside {
        // Only the exclusive use ends; the lock stays.
        let _ = ioctl_tiocnxcl(&beside);
    }
    Ok(port)
}

/// Whether the path is a pseudo-terminal, by its name on Linux or macOS.
fn is_pseudo_terminal(path: &str) -> bool {
    let places = ["/dev/pts/", "/dev/ttys"];
    std::fs::canonicalize(path).is_ok_and(|real| {
        let real = real.to_string_lossy();
        places.iter().any(|place| real.starts_with(place))
    })
}

/// Opens the port a second time, without waiting for it or becoming its terminal.
fn open_beside(path: &str) -> Option<File> {
    let flags = (OFlags::NOCTTY | OFlags::NONBLOCK).bits();
    OpenOptions::new()
        .read(true)
        .write(true)
        .custom_flags(i32::try_from(flags).ok()?)
        .open(path)
        .ok()
}

/// Name and number of the process that holds a lock on this port, by the kernel's list of locks.
#[cfg(target_os = "linux")]
pub fn holder(path: &str) -> Option<String> {
    use rustix::fs::{major, minor};

    let about = std::fs::metadata(path).ok()?;
    let (device, inode) = (about.dev(), about.ino());
    let place = format!("{:02x}:{:02x}:{inode}", major(device), minor(device));
    let process = (0..READINGS_OF_LOCKS).find_map(|_| locked_by(&place))?;
    let name = std::fs::read_to_string(format!("/proc/{process}/comm")).unwrap_or_default();
    Some(match name.trim() {
        "" => format!("process {process}"),
        name => format!("{name}, process {process}"),
    })
}

/// How often the list of locks is read before a lock is said to have no holder. The kernel hands the list out page by
/// page and counts lines to go on: a lock released meanwhile makes it skip one of those that follow. With 240 locks taken
/// and released all the time, 8 % of the readings missed the one in question.
#[cfg(target_os = "linux")]
const READINGS_OF_LOCKS: usize = 16;

/// The process whose lock on the file at this place one reading of the kernel's list shows.
#[cfg(target_os = "linux")]
fn locked_by(place: &str) -> Option<String> {
    let locks = std::fs::read_to_string("/proc/locks").ok()?;
    locks.lines().find_map(|line| {
        let mut words = line.split_whitespace().skip_while(|word| *word != "FLOCK");
        let process = words.nth(3)?;
        (words.next() == Some(place)).then(|| process.to_owned())
    })
}

/// Systems other than Linux do not tell.
#[cfg(not(target_os = "linux"))]
pub fn holder(_: &str) -> Option<String> {
    None
}

/// Whether this user may not read and write an existing port; if so, the group whose members may, if there is one.
pub fn closed_to_user(path: &str) -> Option<Option<String>> {
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

#[cfg(test)]
mod tests {
    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

    use super::*;
    use crate::link::open_port;

    /// Goal: a second tester is shown who has the port, and has it when the first has left it. Method: a
    /// pseudo-terminal whose other end stays open.
    #[test]
    fn a_port_is_held_by_one_and_the_other_is_told_by_whom() {
        let unit = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).expect("a pseudo-terminal");
        grantpt(&unit).expect("granted");
        unlockpt(&unit).expect("unlocked");
        let path = ptsname(&unit, Vec::new()).expect("a name");
        let path = path.to_str().expect("a path");
        let opened = || open_port(path, 115_200, Duration::ZERO);
        for _ in 0..2 {
            let first = opened().expect("free");
            let Err(refused) = opened() else {
                panic!("it is taken");
            };
            let told = format!("process {}", std::process::id());
            let knows = Path::new("/proc/locks").exists();
            assert!(
                !knows || refused.to_string().contains(&told),
                "{}",
                refused.to_string()
            );
            drop(first);
        }
        assert!(open_port("/dev/none", 115_200, Duration::ZERO).is_err());
    }
}
