//! Serves a unit on a pseudo-terminal, a serial port or a TCP socket, in real time. The only part of this library
//! that needs the standard library: feature `serve`.
//!
//! What is served is anything [`Served`]: the unit at its harness, or one at the maintenance port of a train.

extern crate std;

mod platform;
mod serial_end;
mod sound;
mod steady;
mod tcp;
mod wire;

use core::ops::ControlFlow;
use std::fmt;
use std::io;
use std::string::String;
use std::time::Instant as WallClock;
use std::vec::Vec;

use protocol::{Backlog, Instant, SCAN, ScanDeadlines};

pub use platform::keep_time;
pub use serial_end::{PORT_WAITS, SerialEnd};
pub use sound::{DEFAULT, Listener, carrier, is_there};
pub use steady::{Pair, Steady, TAPS};
pub use tcp::{NO_AUTHENTICATION, check_exposed};
pub use wire::{PortAddress, Wire};

/// Device at the far end of a wire.
pub trait Served {
    /// One scan: takes what came and appends what goes out. A break ends serving.
    fn scan(&mut self, received: &[u8], to_send: &mut Vec<u8>) -> ControlFlow<()>;

    /// Frames accepted at this wire: a TCP client of which none is accepted is disconnected.
    fn frames_accepted(&self) -> u64;

    /// Another tester is connected from now on: nothing the last one sent is continued.
    fn reset_connection(&mut self);
}

/// The wire does not work.
#[derive(Debug)]
pub struct ServeError {
    /// Work that failed.
    doing: String,
    source: io::Error,
}

impl ServeError {
    fn new(doing: impl Into<String>) -> impl FnOnce(io::Error) -> Self {
        let doing = doing.into();
        move |source| Self { doing, source }
    }
}

impl fmt::Display for ServeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.doing, self.source)
    }
}

impl std::error::Error for ServeError {}

/// Runs one scan every 10 ms of the monotonic clock, or every `slower` times 10 ms, until `served` ends it; a late scan
/// is made up, not skipped.
///
/// # Errors
/// The wire broke.
pub fn in_real_time(
    served: &mut impl Served,
    wire: &mut Wire,
    slower: u32,
) -> Result<(), ServeError> {
    keep_time();
    let began = WallClock::now();
    let clock = || Instant::from_us(began.elapsed().as_micros() as u64);
    let mut deadlines = ScanDeadlines::new(clock(), slower);
    let mut now = Instant::ZERO;
    let (mut chunk, mut arrived) = ([0u8; 4096], Vec::with_capacity(4096));
    let mut backlog = Backlog::default();
    let mut received = Vec::with_capacity(1024);
    let mut to_send = Vec::with_capacity(1024);
    loop {
        let wait = deadlines.next(clock()).since(clock());
        std::thread::sleep(std::time::Duration::from_micros(wait.as_us()));
        let behind = deadlines.behind(clock());
        if wire.attend(now, behind, served.frames_accepted())? {
            backlog = Backlog::default();
            served.reset_connection();
        }
        // One chunk for this scan, and one for each scan that is late.
        arrived.clear();
        for _ in 0..=behind.as_us() / SCAN.as_us() {
            match wire.read(&mut chunk)? {
                0 => break,
                count => arrived.extend_from_slice(&chunk[..count]),
            }
        }
        received.clear();
        // Where the computer held up the tester as well, the scans shift: the unit has no time without inputs.
        let pause = backlog.share(&arrived, behind, &mut received);
        deadlines.shift(pause.as_us() as i64);
        to_send.clear();
        let flow = served.scan(&received, &mut to_send);
        wire.write(&to_send)?;
        if flow.is_break() {
            return Ok(());
        }
        now += SCAN;
    }
}
