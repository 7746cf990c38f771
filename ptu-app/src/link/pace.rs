//! Paces scans: not at all in virtual time, by absolute deadlines of the monotonic clock otherwise.

use protocol::SCAN;
use rustix::thread::ClockId;
use rustix::time::Timespec;

const NANOS_PER_SECOND: i64 = 1_000_000_000;

/// When the next scan is due.
pub enum Pace {
    /// As fast as possible.
    Virtual,
    /// Every 10 ms; a late scan is made up, not skipped.
    Real {
        /// The last deadline.
        due: Timespec,
    },
}

impl Pace {
    /// Real time, beginning now.
    pub fn real() -> Self {
        Self::Real {
            due: rustix::time::clock_gettime(rustix::time::ClockId::Monotonic),
        }
    }

    /// Waits until the next scan is due.
    pub fn wait(&mut self) {
        let Self::Real { due } = self else { return };
        due.tv_nsec += SCAN.as_us() as i64 * 1000;
        if due.tv_nsec >= NANOS_PER_SECOND {
            due.tv_nsec -= NANOS_PER_SECOND;
            due.tv_sec += 1;
        }
        // An interrupted sleep goes on; nothing else can fail with a valid deadline.
        while rustix::thread::clock_nanosleep_absolute(ClockId::Monotonic, due)
            == Err(rustix::io::Errno::INTR)
        {}
    }
}
