//! The far end of the wire: pseudo-terminal, serial port or TCP socket, never blocking.

use std::fs::File;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::Duration;

use anyhow::{Context, Result};
use rustix::fs::{Mode, OFlags};
use rustix::pty::OpenptFlags;
use rustix::termios::OptionalActions;

use super::Arguments;

/// Baud rate of a serial port when none is given.
const BAUD: u32 = 115_200;

/// An open wire.
pub enum Wire {
    /// The master side; the slave is kept open so that testers can come and go.
    Pty { master: File, _slave: File },
    /// A real port.
    Serial(Box<dyn serialport::SerialPort>),
    /// A listener and the present client.
    Tcp {
        listener: TcpListener,
        client: Option<TcpStream>,
    },
}

impl Wire {
    /// Opens what the arguments ask for and prints where it is.
    pub fn open(arguments: &Arguments) -> Result<Self> {
        if let Some(port) = &arguments.serial {
            return Self::open_serial(port);
        }
        if let Some(address) = &arguments.tcp {
            return Self::listen(address);
        }
        Self::open_pty()
    }

    fn open_pty() -> Result<Self> {
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
        rustix::fs::fcntl_setfl(&master, OFlags::NONBLOCK)?;
        println!("{}", name.to_string_lossy());
        io::stdout().flush()?;
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
            .timeout(Duration::ZERO)
            .open()
            .with_context(|| format!("opening serial port {path}"))?;
        println!("{path}");
        Ok(Self::Serial(port))
    }

    fn listen(address: &str) -> Result<Self> {
        let listener =
            TcpListener::bind(address).with_context(|| format!("listening on {address}"))?;
        listener.set_nonblocking(true)?;
        println!("{}", listener.local_addr()?);
        io::stdout().flush()?;
        Ok(Self::Tcp {
            listener,
            client: None,
        })
    }

    /// Reads what is there, 0 when there is nothing.
    pub fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Pty { master, .. } => nothing_is_zero(master.read(into)),
            Self::Serial(port) => nothing_is_zero(port.read(into)),
            Self::Tcp { listener, client } => {
                if client.is_none() {
                    *client = accept(listener)?;
                }
                let Some(stream) = client else { return Ok(0) };
                match stream.read(into) {
                    Ok(0) => *client = None,
                    Ok(count) => return Ok(count),
                    Err(error) if error.kind() == ErrorKind::WouldBlock => {}
                    Err(_) => *client = None,
                }
                Ok(0)
            }
        }
    }

    /// Writes what fits; as on a real line, nobody waits for a listener.
    pub fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let written = match self {
            Self::Pty { master, .. } => master.write(bytes),
            Self::Serial(port) => port.write(bytes),
            Self::Tcp { client, .. } => {
                let Some(stream) = client else { return Ok(()) };
                let written = stream.write(bytes);
                if written
                    .as_ref()
                    .is_err_and(|e| e.kind() != ErrorKind::WouldBlock)
                {
                    *client = None;
                    return Ok(());
                }
                written
            }
        };
        nothing_is_zero(written).map(|_| ())
    }
}

fn accept(listener: &TcpListener) -> io::Result<Option<TcpStream>> {
    match listener.accept() {
        Ok((stream, _)) => {
            stream.set_nonblocking(true)?;
            stream.set_nodelay(true)?;
            Ok(Some(stream))
        }
        Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(None),
        Err(error) => Err(error),
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
