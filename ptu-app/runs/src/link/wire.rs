//! A unit on a serial port or a TCP socket, by the clock, or on a pseudo-terminal in lock step.

use std::io::{self, ErrorKind, Read, Write};
use std::mem::take;
use std::net::{TcpStream, ToSocketAddrs};
use std::time::Duration;

use ato_under_test::serve::{PORT_WAITS, SerialEnd};
use btu_rig::rig::{LinkFailure, LinkTrouble, PortFailure, UnitLink};
use protocol::frame::SCAN_END;
use protocol::{Backlog, Duration as BenchDuration, Instant, SCAN};
use serialport::SerialPort;

use super::{Pace, connect_to, open_port};
use crate::endpoint::Endpoint;
use crate::failure::{EndpointError, Failure, NoUnit, RunTrouble};
use crate::places::Placed;

/// Baud rate when none is given.
const BAUD: u32 = 115_200;
/// Longest time a unit in lock step takes for a scan.
const STEP: Duration = Duration::from_secs(10);
/// Longest time for a TCP connection.
const CONNECT: Duration = Duration::from_secs(3);

impl Endpoint {
    /// Pace of a bench with this unit, `slower` times slower than the clock where the bench follows the
    /// clock.
    pub fn pace(&self, slower: u32) -> Pace {
        match self {
            Self::LockStep(_) => Pace::Virtual,
            _ => Pace::slower(slower),
        }
    }
}

impl std::str::FromStr for Endpoint {
    type Err = EndpointError;

    fn from_str(text: &str) -> Result<Self, EndpointError> {
        if text == "sim" {
            return Ok(Self::Sim);
        }
        if let Some(address) = text.strip_prefix("tcp:") {
            return match address.rsplit_once(':') {
                Some((host, port)) if !host.is_empty() && port.parse::<u16>().is_ok() => {
                    Ok(Self::Tcp(address.to_owned()))
                }
                _ => Err(EndpointError::Address(address.to_owned())),
            };
        }
        if let Some(path) = text
            .strip_prefix("lockstep:")
            .filter(|path| !path.is_empty())
        {
            return Ok(Self::LockStep(path.to_owned()));
        }
        let Some(port) = text.strip_prefix("serial:") else {
            return Err(EndpointError::Unknown);
        };
        let (path, baud) = match port.rsplit_once('@') {
            Some((path, baud)) => (
                path,
                baud.parse()
                    .map_err(|_| EndpointError::Baud(baud.to_owned()))?,
            ),
            None => (port, BAUD),
        };
        if path.is_empty() {
            return Err(EndpointError::NoPort);
        }
        Ok(Self::Serial {
            path: path.to_owned(),
            baud,
        })
    }
}

/// An open link; only in lock step do reading and writing wait.
pub struct WireLink {
    name: String,
    port: Port,
    /// Times the bench is slower than the clock.
    slower: u32,
    /// When the first bytes were exchanged, by the clock and on the bench.
    began: Option<(std::time::Instant, Instant)>,
    read: Vec<u8>,
    backlog: Backlog,
    /// Time for which both ends stood still.
    pause: BenchDuration,
    placed: Option<Placed>,
    /// Bytes on the wire: sent, without what instruments take, and received, before instruments give their part.
    to_wire: Vec<u8>,
    from_wire: Vec<u8>,
}

enum Port {
    Serial(SerialEnd),
    Tcp(TcpStream),
    LockStep(Box<dyn SerialPort>),
}

impl WireLink {
    /// Opens the port or connects.
    ///
    /// # Errors
    /// The port is missing or in use; the message says what to do next.
    pub fn open(endpoint: &Endpoint) -> Result<Self, Failure> {
        let port = match endpoint {
            Endpoint::Sim => return Err(Failure::bench(RunTrouble::NoPort)),
            Endpoint::Serial { path, baud } => {
                Port::Serial(SerialEnd(open_serial(path, *baud, PORT_WAITS)?))
            }
            Endpoint::LockStep(path) => Port::LockStep(open_serial(path, BAUD, STEP)?),
            Endpoint::Tcp(address) => connect(address)?,
        };
        Ok(Self {
            name: endpoint.to_string(),
            port,
            slower: 1,
            began: None,
            read: Vec::new(),
            backlog: Backlog::default(),
            pause: BenchDuration::ZERO,
            placed: None,
            to_wire: Vec::new(),
            from_wire: Vec::new(),
        })
    }

    /// Sets the pace of a unit that goes `slower` times slower than the clock.
    pub fn slower(mut self, slower: u32) -> Self {
        self.slower = slower;
        self
    }

    /// Adds instruments, which take a part of the stimuli and give a part of the readings.
    pub fn with_instruments(mut self, placed: Placed) -> Self {
        self.placed = Some(placed);
        self
    }

    /// Lag of the bench behind the clock; in lock step there is none.
    fn behind(&mut self, now: Instant) -> BenchDuration {
        if matches!(self.port, Port::LockStep(_)) {
            return BenchDuration::ZERO;
        }
        let clock = std::time::Instant::now();
        let (clock_began, bench_began) = *self.began.get_or_insert((clock, now));
        let clock_us = clock.duration_since(clock_began).as_micros() / u128::from(self.slower);
        let bench_us = now.since(bench_began).as_us();
        BenchDuration::from_us(
            u64::try_from(clock_us)
                .unwrap_or(u64::MAX)
                .saturating_sub(bench_us),
        )
    }
}

fn open_serial(path: &str, baud: u32, waits: Duration) -> Result<Box<dyn SerialPort>, Failure> {
    let port = open_port(path, baud, waits)?;
    let _ = port.clear(serialport::ClearBuffer::All);
    Ok(port)
}

fn connect(address: &str) -> Result<Port, Failure> {
    let cannot = |error: io::Error| NoUnit::NotServed(address.to_owned(), error.to_string());
    let stream = connect_to(address.to_socket_addrs().map_err(cannot)?, CONNECT).map_err(cannot)?;
    stream.set_nonblocking(true).map_err(cannot)?;
    stream.set_nodelay(true).map_err(cannot)?;
    Ok(Port::Tcp(stream))
}

impl WireLink {
    fn exchange_frames(
        &mut self,
        now: Instant,
        to_unit: &[u8],
        from_unit: &mut Vec<u8>,
    ) -> Result<(), LinkTrouble> {
        let behind = self.behind(now);
        let scans = 1 + behind.as_us() / SCAN.as_us();
        let exchanged = match &mut self.port {
            Port::Serial(port) => exchange(port, to_unit, &mut self.read, scans),
            Port::Tcp(stream) => exchange(stream, to_unit, &mut self.read, scans),
            Port::LockStep(port) => exchange_scan(port, to_unit, &mut self.read),
        };
        self.pause += self.backlog.share(&self.read, behind, from_unit);
        self.read.clear();
        exchanged.map_err(|why| {
            let link = self.name.clone();
            LinkTrouble::Broken(LinkFailure { link, why })
        })
    }
}

impl UnitLink for WireLink {
    fn exchange(
        &mut self,
        now: Instant,
        to_unit: &[u8],
        from_unit: &mut Vec<u8>,
    ) -> Result<(), LinkTrouble> {
        let Some(mut placed) = self.placed.take() else {
            return self.exchange_frames(now, to_unit, from_unit);
        };
        let (mut to_wire, mut from_wire) = (take(&mut self.to_wire), take(&mut self.from_wire));
        placed.take(now, to_unit, &mut to_wire);
        let exchanged = self.exchange_frames(now, &to_wire, &mut from_wire);
        let given = placed.give(now, &from_wire, from_unit);
        if exchanged.is_err() {
            placed.release();
        }
        to_wire.clear();
        from_wire.clear();
        (self.to_wire, self.from_wire) = (to_wire, from_wire);
        self.placed = Some(placed);
        exchanged.and(given)
    }

    fn take_late(&mut self) -> BenchDuration {
        let placed = self.placed.as_mut();
        placed.map_or(BenchDuration::ZERO, Placed::take_late)
    }

    fn take_pause(&mut self) -> BenchDuration {
        std::mem::take(&mut self.pause)
    }

    fn shift_clock(&mut self, later_us: i64) {
        let by = Duration::from_micros(later_us.unsigned_abs()) * self.slower;
        if let Some((began, _)) = &mut self.began {
            match later_us >= 0 {
                true => *began += by,
                false => *began = began.checked_sub(by).unwrap_or(*began),
            }
        }
    }
}

/// Reads what is there, a chunk for each of the scans in which it came, and writes what the port takes; a full buffer is a
/// slow line, and the link's own checks see it.
fn exchange(
    port: &mut (impl Read + Write),
    to_unit: &[u8],
    from_unit: &mut Vec<u8>,
    scans: u64,
) -> Result<(), PortFailure> {
    let mut chunk = [0; 4096];
    for _ in 0..scans {
        match port.read(&mut chunk) {
            Ok(0) => return Err(PortFailure::Closed),
            Ok(count) => from_unit.extend_from_slice(&chunk[..count]),
            Err(error) if is_nothing(&error) => break,
            Err(error) => return Err(PortFailure::Reading(error.to_string())),
        }
    }
    match port.write(to_unit) {
        Ok(_) => Ok(()),
        Err(error) if is_nothing(&error) => Ok(()),
        Err(error) => Err(PortFailure::Writing(error.to_string())),
    }
}

/// Sends the bytes of one scan and waits for those of the unit's answer.
fn exchange_scan(
    port: &mut Box<dyn SerialPort>,
    to_unit: &[u8],
    from_unit: &mut Vec<u8>,
) -> Result<(), PortFailure> {
    let not_in_step = |error: io::Error| PortFailure::NotInLockStep(error.to_string());
    port.write_all(to_unit).map_err(not_in_step)?;
    port.write_all(&SCAN_END).map_err(not_in_step)?;
    let mut chunk = [0; 4096];
    let asked = std::time::Instant::now();
    while !from_unit.ends_with(&SCAN_END) {
        // A unit that goes by the clock never ends a scan, and never falls silent.
        if asked.elapsed() > STEP {
            return Err(not_in_step(ErrorKind::TimedOut.into()));
        }
        let count = match port.read(&mut chunk) {
            // As after the program was stopped and went on.
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            read => read.map_err(not_in_step)?,
        };
        from_unit.extend_from_slice(&chunk[..count]);
    }
    Ok(())
}

fn is_nothing(error: &std::io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}
