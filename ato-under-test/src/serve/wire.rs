//! The far end of the wire: pseudo-terminal, serial port or TCP socket. Only a pseudo-terminal in lock step
//! waits for its tester.

extern crate std;

use std::format;
use std::io::{self, ErrorKind, Read, Write};
use std::string::{String, ToString};

use protocol::{Duration, Instant};

use super::ServeError;
use super::platform::Pty;
use super::serial_end::{PORT_WAITS, SerialEnd};
use super::tcp::Server;

/// Baud rate of a serial port when none is given.
const BAUD: u32 = 115_200;

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PortAddress {
    /// On a new pseudo-terminal.
    Pty,
    /// On a serial port.
    Serial { path: String, baud: u32 },
    /// At an address, `HOST:PORT`, to one TCP client at a time.
    Tcp(String),
}

impl PortAddress {
    /// A serial port, `PATH` or `PATH@BAUD`.
    ///
    /// # Errors
    /// The rate is no number.
    pub fn serial(text: &str) -> Result<Self, String> {
        let (path, baud) = match text.rsplit_once('@') {
            Some((path, baud)) => (
                path,
                baud.parse()
                    .map_err(|_| format!("\"{baud}\" is not a baud rate"))?,
            ),
            None => (text, BAUD),
        };
        Ok(Self::Serial {
            path: path.into(),
            baud,
        })
    }
}

pub struct Wire {
    pub name: String,
    end: FarEnd,
}

enum FarEnd {
    /// A pseudo-terminal made for this.
    Pty(Pty),
    Serial(SerialEnd),
    /// A socket that serves one client at a time.
    Tcp(Server),
}

impl Wire {
    /// Opens the far end at this place.
    ///
    /// # Errors
    /// The system has no such port, or another program has it.
    pub fn open(place: &PortAddress) -> Result<Self, ServeError> {
        match place {
            PortAddress::Pty => Self::open_pty(false),
            PortAddress::Serial { path, baud } => {
                let port = serialport::new(path, *baud)
                    .timeout(PORT_WAITS)
                    .open()
                    .map_err(io::Error::from)
                    .map_err(ServeError::new(format!("opening serial port {path}")))?;
                Ok(Self {
                    name: path.clone(),
                    end: FarEnd::Serial(SerialEnd(port)),
                })
            }
            PortAddress::Tcp(address) => {
                let (server, at) = Server::listen(address)
                    .map_err(ServeError::new(format!("listening on {address}")))?;
                Ok(Self {
                    name: at.to_string(),
                    end: FarEnd::Tcp(server),
                })
            }
        }
    }

    /// A new pseudo-terminal whose reads wait, for a unit that goes by its tester instead of the clock.
    ///
    /// # Errors
    /// The system has none left.
    pub fn open_lock_step() -> Result<Self, ServeError> {
        Self::open_pty(true)
    }

    fn open_pty(waits: bool) -> Result<Self, ServeError> {
        let opened = Pty::open(waits);
        let (pty, name) = opened.map_err(ServeError::new("opening a pseudo-terminal"))?;
        Ok(Self {
            name,
            end: FarEnd::Pty(pty),
        })
    }

    /// Attends to who comes and goes; true when another tester has the wire from now on. This program is
    /// `behind` its time; `accepted` counts the frames that were accepted.
    pub fn attend(
        &mut self,
        now: Instant,
        behind: Duration,
        accepted: u64,
    ) -> Result<bool, ServeError> {
        match &mut self.end {
            FarEnd::Tcp(server) => server
                .attend(now, behind, accepted)
                .map_err(ServeError::new("attending to the wire")),
            _ => Ok(false),
        }
    }

    /// Reads what is there, 0 when there is nothing.
    ///
    /// # Errors
    /// The port is gone.
    pub fn read(&mut self, into: &mut [u8]) -> Result<usize, ServeError> {
        let read = match &mut self.end {
            FarEnd::Pty(pty) => nothing_is_zero(pty.read(into)),
            FarEnd::Serial(port) => nothing_is_zero(port.read(into)),
            FarEnd::Tcp(server) => Ok(server.read(into)),
        };
        read.map_err(ServeError::new("reading from the wire"))
    }

    /// Writes what fits; as on a real line, a listener is not waited for.
    ///
    /// # Errors
    /// The port is gone.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), ServeError> {
        let written = match &mut self.end {
            FarEnd::Pty(pty) => pty.write(bytes),
            FarEnd::Serial(port) => port.write(bytes),
            FarEnd::Tcp(server) => {
                server.write(bytes);
                return Ok(());
            }
        };
        let written = nothing_is_zero(written).map_err(ServeError::new("writing to the wire"));
        written.map(|_| ())
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
