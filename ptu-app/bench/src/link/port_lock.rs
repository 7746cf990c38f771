//! A serial port is one tester's at a time: two of them would each disturb what the other measures.
//!
//! The lock is the kernel's advisory one, which terminal programs heed, too, and which ends with its process however
//! that ends. A port of hardware is closed to all other programs besides; a pseudo-terminal is not, because that would
//! outlast a killed tester as long as the other end is open.

use std::fs::{File, OpenOptions};
use std::os::unix::fs::{MetadataExt as _, OpenOptionsExt as _};
use std::time::Duration;

use rustix::fs::{OFlags, major, minor};
use rustix::termios::ioctl_tiocnxcl;
use serialport::SerialPort;

use crate::failure::Failure;

/// Opens a port and locks it until it is closed.
///
/// # Errors
/// It is not there, or another program holds it, which is named where the system tells.
pub(super) fn open(path: &str, baud: u32, waits: Duration) -> Result<Box<dyn SerialPort>, Failure> {
    let beside = is_pseudo_terminal(path)
        .then(|| open_beside(path))
        .flatten();
    let opened = serialport::new(path, baud)
        .timeout(waits)
        .exclusive(true)
        .open();
    let port = opened.map_err(|error| {
        Failure::bench(match holder(path) {
            Some(who) => format!(
                "another program holds the port {path}: {who}; end it, or choose one of `ptu ports`"
            ),
            None => format!(
                "cannot open port {path}: {error}; check the cable, or choose one of `ptu ports`"
            ),
        })
    })?;
    if let Some(beside) = beside {
        // The lock stays.
        let _ = ioctl_tiocnxcl(&beside);
    }
    Ok(port)
}

fn is_pseudo_terminal(path: &str) -> bool {
    std::fs::canonicalize(path).is_ok_and(|real| real.starts_with("/dev/pts"))
}

/// The same device once more, without waiting for it or becoming its terminal.
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
fn holder(path: &str) -> Option<String> {
    let about = std::fs::metadata(path).ok()?;
    let (device, inode) = (about.dev(), about.ino());
    let place = format!("{:02x}:{:02x}:{inode}", major(device), minor(device));
    let locks = std::fs::read_to_string("/proc/locks").ok()?;
    let process = locks.lines().find_map(|line| {
        let mut words = line.split_whitespace().skip_while(|word| *word != "FLOCK");
        let process = words.nth(3)?;
        (words.next() == Some(&*place)).then(|| process.to_owned())
    })?;
    let name = std::fs::read_to_string(format!("/proc/{process}/comm")).unwrap_or_default();
    Some(match name.trim() {
        "" => format!("process {process}"),
        name => format!("{name}, process {process}"),
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

    use super::*;

    /// Goal: a second tester is told who has the port, and has it when the first has left it. Method: a
    /// pseudo-terminal whose other end stays open.
    #[test]
    fn a_port_is_held_by_one_and_the_other_is_told_by_whom() {
        let unit = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).expect("a pseudo-terminal");
        grantpt(&unit).expect("granted");
        unlockpt(&unit).expect("unlocked");
        let path = ptsname(&unit, Vec::new()).expect("a name");
        let path = path.to_str().expect("a path");
        let opened = || open(path, 115_200, Duration::ZERO);
        for _ in 0..2 {
            let first = opened().expect("free");
            let Err(refused) = opened() else {
                panic!("it is taken");
            };
            let told = format!("process {}", std::process::id());
            let knows = Path::new("/proc/locks").exists();
            assert!(
                !knows || refused.message.contains(&told),
                "{}",
                refused.message
            );
            drop(first);
        }
        assert!(open("/dev/none", 115_200, Duration::ZERO).is_err());
    }
}
