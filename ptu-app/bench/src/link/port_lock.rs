//! A serial port is one tester's at a time: two of them would each disturb what the other measures.
//!
//! The lock is the kernel's advisory one, which terminal programs heed, too, and which ends with its process however
//! that ends. A port of hardware is closed to all other programs besides; a pseudo-terminal is not, because that would
//! outlast a killed tester as long as the other end is open.

use std::fs::{File, OpenOptions, TryLockError};
use std::os::unix::fs::{MetadataExt as _, OpenOptionsExt as _};
use std::path::Path;

use rustix::fs::{OFlags, major, minor};
use rustix::termios::{ioctl_tiocexcl, ioctl_tiocnxcl};

use crate::failure::Failure;

/// Held as long as it lives.
pub(super) struct PortLock {
    file: File,
    is_closed: bool,
}

impl PortLock {
    /// Locks the port of this path; none if it cannot be opened, which whoever opens it to use it says better.
    ///
    /// # Errors
    /// Another program holds it; it is named where the system tells.
    pub fn take(path: &str) -> Result<Option<Self>, Failure> {
        let flags = OFlags::NOCTTY | OFlags::NONBLOCK;
        let flags = i32::try_from(flags.bits()).unwrap_or_default();
        let opened = OpenOptions::new()
            .read(true)
            .write(true)
            .custom_flags(flags)
            .open(path);
        let Ok(file) = opened else { return Ok(None) };
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => Err(Failure::bench(format!(
                "another program holds the port {path}: {}; end it, or choose one of `ptu ports`",
                holder(&file).unwrap_or_else(|| "which one, the system does not tell".to_owned())
            ))),
            // A system without such locks has ports nevertheless.
            Err(TryLockError::Error(_)) | Ok(()) => Ok(Some(Self {
                file,
                is_closed: false,
            })),
        }
    }

    /// Closes the port to other programs; to be called once it is open here.
    pub fn close_to_others(&mut self, path: &str) {
        let real = std::fs::canonicalize(path).unwrap_or_default();
        if !real.starts_with(Path::new("/dev/pts")) {
            self.is_closed = ioctl_tiocexcl(&self.file).is_ok();
        }
    }
}

impl Drop for PortLock {
    fn drop(&mut self) {
        if self.is_closed {
            // It ends with the last that has the port open, too.
            let _ = ioctl_tiocnxcl(&self.file);
        }
    }
}

/// Name and number of the process that holds a lock on this file, by the kernel's list of locks.
fn holder(file: &File) -> Option<String> {
    let about = file.metadata().ok()?;
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
    use serialport::{SerialPort as _, TTYPort};

    use super::*;

    #[test]
    fn a_port_is_held_by_one_and_the_other_is_told_by_whom() {
        let (_unit, port) = TTYPort::pair().expect("a pseudo-terminal");
        let path = port.name().expect("a name");
        let mut first = PortLock::take(&path).expect("free").expect("opened");
        first.close_to_others(&path);
        let Err(refused) = PortLock::take(&path) else {
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
        assert!(PortLock::take(&path).expect("free again").is_some());
        assert!(PortLock::take("/dev/none").expect("not there").is_none());
    }
}
