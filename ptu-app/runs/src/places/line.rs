//! The line to an instrument, a TCP connection, a serial port or a USB test and measurement device: one program has it at a
//! time, and modules on one line take turns.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Read, Result, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use btu_rig::rig::InstrumentFault;
use serialport::{ClearBuffer, SerialPort};

use super::file::Places;
use super::instrument::Reach;
use super::worker::{ANSWERS_WITHIN, span};
use crate::link::connect_to;
use crate::platform;

/// Longest answer of an instrument, bytes.
pub(super) const LONGEST: usize = 4096;

/// An open line.
pub(super) enum Line {
    Tcp(TcpStream),
    /// A serial port, its rate, and when the last byte on the line has passed.
    Serial(Box<dyn SerialPort>, u32, Instant),
    /// Each write to the device is one message, and each read.
    Usb(File, Reading),
}

/// Reading of a device whose driver waits for a time of its own, 5 s as shipped: another thread waits in the driver.
#[derive(Default)]
pub(super) struct Reading {
    within: Duration,
    under_way: Option<Receiver<Result<Vec<u8>>>>,
}

impl Reading {
    fn read(&mut self, device: &File, into: &mut [u8]) -> Result<usize> {
        let begin = |mut device: File| {
            let (came, comes) = channel();
            std::thread::spawn(move || {
                let mut bytes = vec![0; LONGEST];
                let read = device.read(&mut bytes);
                let _ = came.send(read.map(|count| bytes[..count].to_vec()));
            });
            comes
        };
        let under_way = match self.under_way.take() {
            Some(under_way) => under_way,
            None => begin(device.try_clone()?),
        };
        let Ok(came) = under_way.recv_timeout(self.within) else {
            // What still comes is taken by a later read.
            self.under_way = Some(under_way);
            return Err(ErrorKind::TimedOut.into());
        };
        came.and_then(|came| (&came[..]).read(into))
    }
}

/// A line of one or several instruments.
pub(super) type SharedLine = Arc<Mutex<Line>>;

/// The lines of a bench, which no other program may use meanwhile.
#[derive(Default)]
pub(super) struct Lines {
    locks: BTreeMap<String, Option<File>>,
    open: BTreeMap<String, SharedLine>,
}

impl Lines {
    /// Lines of all instruments, none open yet.
    ///
    /// # Errors
    /// Another program uses an instrument, which is named.
    pub fn of(places: &Places) -> std::result::Result<Self, (String, InstrumentFault)> {
        let mut lines = Self::default();
        for (name, entry) in &places.instruments {
            let at = entry.reach().to_string();
            if let Entry::Vacant(free) = lines.locks.entry(at) {
                let lock = lock(free.key()).map_err(|()| (name.clone(), InstrumentFault::Taken));
                free.insert(lock?);
            }
        }
        Ok(lines)
    }

    /// The line to this place, which is opened if it is not yet.
    pub fn to(&mut self, reach: &Reach) -> std::result::Result<SharedLine, InstrumentFault> {
        let at = reach.to_string();
        if let Some(open) = self.open.get(&at) {
            return Ok(open.clone());
        }
        let opened = Line::open(reach).map_err(|error| InstrumentFault::NotThere {
            at: at.clone(),
            why: error.to_string(),
        });
        let opened = Arc::new(Mutex::new(opened?));
        self.open.insert(at, opened.clone());
        Ok(opened)
    }
}

/// Locks a place for this program as long as the file is open; `None` where the computer has no locks.
fn lock(at: &str) -> std::result::Result<Option<File>, ()> {
    let name = at.replace(|c: char| !c.is_ascii_alphanumeric(), "-");
    let path = std::env::temp_dir().join(format!("ptu-instrument-{name}.lock"));
    let mut options = OpenOptions::new();
    let made = options.write(true).create(true).truncate(false).open(&path);
    // Another user made the file: it can be read, which is enough for a lock.
    let Ok(file) = made.or_else(|_| File::open(&path)) else {
        return Ok(None);
    };
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(()),
        Err(TryLockError::Error(_)) | Ok(()) => Ok(Some(file)),
    }
}

impl Line {
    fn open(reach: &Reach) -> Result<Self> {
        Ok(match reach {
            Reach::Tcp(address) => Self::Tcp(connect(address)?),
            Reach::Serial(path, baud) => {
                let port = platform::open_alone(path, *baud, ANSWERS_WITHIN)?;
                Self::Serial(port, *baud, Instant::now())
            }
            Reach::Usb(path) => {
                let device = OpenOptions::new().read(true).write(true).open(path)?;
                Self::Usb(device, Reading::default())
            }
        })
    }

    /// Waits until a serial line has been silent for so long that a frame of Modbus RTU may begin.
    pub fn await_silence(&self) {
        if let Self::Serial(_, baud, passed) = self {
            std::thread::sleep(silence(*baud).saturating_sub(passed.elapsed()));
        }
    }

    /// Forgets what a serial line still holds of an answer that came too late.
    pub fn forget(&mut self) {
        if let Self::Serial(port, ..) = self {
            let _ = port.clear(ClearBuffer::Input);
        }
    }

    /// Sets how long reading waits.
    pub fn wait_for(&mut self, within: Duration) -> Result<()> {
        match self {
            Self::Tcp(stream) => stream.set_read_timeout(Some(within)),
            Self::Serial(port, ..) => Ok(port.set_timeout(within)?),
            Self::Usb(_, reading) => {
                reading.within = within;
                Ok(())
            }
        }
    }
}

impl Read for Line {
    fn read(&mut self, into: &mut [u8]) -> Result<usize> {
        match self {
            Self::Tcp(stream) => stream.read(into),
            Self::Serial(port, _, passed) => {
                let read = port.read(into);
                *passed = Instant::now();
                read
            }
            Self::Usb(device, reading) => reading.read(device, into),
        }
    }
}

impl Write for Line {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        match self {
            Self::Tcp(stream) => stream.write(bytes),
            Self::Serial(port, baud, passed) => {
                let written = port.write(bytes)?;
                *passed = Instant::now() + characters(written as f64, *baud);
                Ok(written)
            }
            Self::Usb(device, _) => device.write(bytes),
        }
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

/// How long so many characters take: 11 bits each (Modbus over serial line 2.5.1).
fn characters(count: f64, baud: u32) -> Duration {
    Duration::from_secs_f64(11.0 * count / f64::from(baud.max(1)))
}

/// Silence between two frames of Modbus RTU (Modbus over serial line 2.5.1.1).
fn silence(baud: u32) -> Duration {
    characters(3.5, baud).max(Duration::from_micros(1_750))
}

fn connect(address: &str) -> Result<TcpStream> {
    let stream = connect_to(address.to_socket_addrs()?, ANSWERS_WITHIN)?;
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(ANSWERS_WITHIN))?;
    stream.set_write_timeout(Some(ANSWERS_WITHIN))?;
    Ok(stream)
}

/// Fault of an instrument whose exchange failed with this error.
pub(super) fn io_fault(error: std::io::Error) -> InstrumentFault {
    match error.kind() {
        ErrorKind::WouldBlock | ErrorKind::TimedOut => {
            InstrumentFault::Silent(span(ANSWERS_WITHIN))
        }
        _ => InstrumentFault::Disconnected(error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_of_rtu_are_three_and_a_half_characters_apart_and_no_less_than_1_75_ms() {
        let micros = [1_200, 9_600, 115_200].map(|baud| silence(baud).as_micros());
        assert_eq!(micros, [32_083, 4_010, 1_750]);
    }

    /// Goal: a USB instrument that says nothing costs the time of the question and no more, and what it says then is read.
    /// Method: a pseudo-terminal in place of its device, which waits for ever.
    #[cfg(unix)]
    #[test]
    fn reading_a_usb_device_ends_in_the_time_of_the_question() {
        let (mut instrument, device) = serialport::TTYPort::pair().expect("a pseudo-terminal");
        let path = device.name().expect("its path");
        let mut line = Line::open(&Reach::Usb(path)).expect("it opens");
        let mut answer = [0; 8];
        line.wait_for(Duration::from_millis(100)).expect("set");
        for _ in 0..2 {
            let began = Instant::now();
            let read = line.read(&mut answer).expect_err("nothing is said");
            assert_eq!(read.kind(), ErrorKind::TimedOut);
            assert!(began.elapsed() < Duration::from_secs(2));
        }
        instrument.write_all(b"1\n").expect("said");
        line.wait_for(Duration::from_secs(20)).expect("set");
        assert_eq!(line.read(&mut answer).expect("it is said"), 2);
        assert_eq!(&answer[..2], b"1\n");
    }
}
