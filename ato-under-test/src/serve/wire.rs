//! The far end of the wire: pseudo-terminal, serial port or TCP socket. Only a pseudo-terminal in lock step
//! waits for its tester.

use std::fs::File;
use std::io::{self, ErrorKind, Read, Write};

use anyhow::{Context, Result};
use protocol::{Duration, Instant};
use rustix::fs::{Mode, OFlags};
use rustix::pty::OpenptFlags;
use rustix::termios::OptionalActions;

use super::tcp::Server;
use super::{Arguments, stdio};

/// Baud rate of a serial port when none is given.
const BAUD: u32 = 115_200;

/// An open wire.
pub enum Wire {
    /// The master side; the slave is kept open so that testers can come and go.
    Pty { master: File, _slave: File },
    /// A real port.
    Serial(Box<dyn serialport::SerialPort>),
    /// A socket that serves one client at a time.
    Tcp(Server),
}

impl Wire {
    /// Opens what the arguments ask for and prints where it is.
    pub fn open(arguments: &Arguments) -> Result<Self> {
        if let Some(port) = &arguments.serial {
            return Self::open_serial(port);
        }
        if let Some(address) = &arguments.tcp {
            return Ok(Self::Tcp(Server::listen(address)?));
        }
        Self::open_pty(arguments.lock_step)
    }

    fn open_pty(waits: bool) -> Result<Self> {
        let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY;
        let master = rustix::pty::openpt(flags).context("opening a pseudo-terminal")?;
        rustix::pty::grantpt(&master)?;
        rustix::pty::unlockpt(&master)?;
        let name = rustix::pty::ptsname(&master, Vec::new())?;
        let slave = rustix::fs::open(&name, OFlags::RDWR | OFlags::NOCTTY, Mode::empty())
            .context("opening the pseudo-terminal's slave side")?;
        let mut raw = rustix::termios::tcgetattr(&slave)?;
        raw.make_raw();
        rustix::termios::tcsetattr(&slave, OptionalActions::Now, &raw)?;
        if !waits {
            rustix::fs::fcntl_setfl(&master, OFlags::NONBLOCK)?;
        }
        stdio::place(&name.to_string_lossy())?;
        Ok(Self::Pty {
            master: File::from(master),
            _slave: File::from(slave),
        })
    }

    fn open_serial(port: &str) -> Result<Self> {
        let (path, baud) = match port.rsplit_once('@') {
            Some((path, baud)) => (
                path,
                baud.parse()
                    .with_context(|| format!("{baud} is not a baud rate"))?,
            ),
            None => (port, BAUD),
        };
        let port = serialport::new(path, baud)
            .timeout(std::time::Duration::ZERO)
            .open()
            .with_context(|| format!("opening serial port {path}"))?;
        stdio::place(path)?;
        Ok(Self::Serial(port))
    }

    /// Attends to who comes and goes; true when another tester has the wire from now on. This program is
    /// `behind` its time; `accepted` counts the frames that the unit accepted.
    pub fn attend(&mut self, now: Instant, behind: Duration, accepted: u64) -> io::Result<bool> {
        match self {
            Self::Tcp(server) => server.attend(now, behind, accepted),
            _ => Ok(false),
        }
    }

    /// Reads what is there, 0 when there is nothing.
    pub fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Pty { master, .. } => nothing_is_zero(master.read(into)),
            Self::Serial(port) => nothing_is_zero(port.read(into)),
            Self::Tcp(server) => Ok(server.read(into)),
        }
    }

    /// Writes what fits; as on a real line, nobody waits for a listener.
    pub fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let written = match self {
            Self::Pty { master, .. } => master.write(bytes),
            Self::Serial(port) => port.write(bytes),
            Self::Tcp(server) => {
                server.write(bytes);
                return Ok(());
            }
        };
        nothing_is_zero(written).map(|_| ())
    }
}

fn nothing_is_zero(result: io::Result<usize>) -> io::Result<usize> {
    match result {
        Err(error)
            if matches!(
                error.kind(),
                ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
            ) =>
        {
            Ok(0)
        }
        other => other,
    }
}
