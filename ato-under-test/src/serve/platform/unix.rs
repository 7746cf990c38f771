//! Linux, and macOS by reading only.

extern crate std;

use std::fs::File;
use std::io::{Read, Result, Write};
use std::string::String;
use std::time::Duration;
use std::vec::Vec;

use rustix::fs::{Mode, OFlags};
use rustix::pty::OpenptFlags;
use rustix::termios::OptionalActions;
use serialport::SerialPort;
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

/// Time for which reads and writes of a serial port wait.
pub const PORT_WAITS: Duration = Duration::ZERO;
/// Real-time priority: above all threads without one, low among those with one; the system's own time-keeping threads
/// stand higher \[default\].
const PRIORITY: u8 = 10;

/// A new pseudo-terminal: the master side; the slave is kept open so that testers can come and go.
pub struct Pty {
    master: File,
    _slave: File,
}

impl Pty {
    /// Opens a pseudo-terminal, and returns its name with it. Its reads wait if `waits`.
    ///
    /// # Errors
    /// The system has none left.
    pub fn open(waits: bool) -> Result<(Self, String)> {
        let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY;
        let master = rustix::pty::openpt(flags)?;
        rustix::pty::grantpt(&master)?;
        rustix::pty::unlockpt(&master)?;
        let name = rustix::pty::ptsname(&master, Vec::new())?;
        let flags = OFlags::RDWR | OFlags::NOCTTY;
        let slave = rustix::fs::open(&name, flags, Mode::empty())?;
        let mut raw = rustix::termios::tcgetattr(&slave)?;
        raw.make_raw();
        rustix::termios::tcsetattr(&slave, OptionalActions::Now, &raw)?;
        if !waits {
            rustix::fs::fcntl_setfl(&master, OFlags::NONBLOCK)?;
        }
        let pty = Self {
            master: File::from(master),
            _slave: File::from(slave),
        };
        Ok((pty, name.to_string_lossy().into_owned()))
    }
}

impl Read for Pty {
    fn read(&mut self, into: &mut [u8]) -> Result<usize> {
        self.master.read(into)
    }
}

impl Write for Pty {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        self.master.write(bytes)
    }

    fn flush(&mut self) -> Result<()> {
        self.master.flush()
    }
}

/// Reads what is there.
///
/// # Errors
/// There is nothing, or the port is gone.
pub fn read_port(port: &mut dyn SerialPort, into: &mut [u8]) -> Result<usize> {
    port.read(into)
}

/// Asks the system to let nothing else delay the present thread, which keeps time from now on. Returns whether the
/// system lets it; where it does not, the thread goes on as it is. Needs the right to real-time priorities (on Linux
/// `RLIMIT_RTPRIO` or root).
pub fn keep_time() -> bool {
    let Ok(priority) = ThreadPriorityValue::try_from(PRIORITY) else {
        return false;
    };
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let id = thread_native_id();
    set_thread_priority_and_policy(id, ThreadPriority::Crossplatform(priority), policy).is_ok()
}
