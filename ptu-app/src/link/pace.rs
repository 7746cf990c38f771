//! Paces scans: not at all in virtual time, by absolute deadlines of the monotonic clock otherwise.

use protocol::SCAN;
use rustix::thread::ClockId;
use rustix::time::Timespec;

const NANOS_PER_SECOND: i64 = 1_000_000_000;
/// Time between scans that are made up.
const MAKE_UP_NANOS: i64 = 1_000_000;

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
        *due = later(*due, SCAN.as_us() as i64 * 1000);
        // Made up no faster than this, so that the other end can answer scan by scan: a machine that
        // held both up must not look like a slow unit.
        let soonest = later(
            rustix::time::clock_gettime(rustix::time::ClockId::Monotonic),
            MAKE_UP_NANOS,
        );
        let due = if (due.tv_sec, due.tv_nsec) < (soonest.tv_sec, soonest.tv_nsec) {
            soonest
        } else {
            *due
        };
        // An interrupted sleep goes on; nothing else can fail with a valid deadline.
        while rustix::thread::clock_nanosleep_absolute(ClockId::Monotonic, &due)
            == Err(rustix::io::Errno::INTR)
        {}
    }
}

fn later(mut at: Timespec, nanos: i64) -> Timespec {
    at.tv_nsec += nanos;
    if at.tv_nsec >= NANOS_PER_SECOND {
        at.tv_nsec -= NANOS_PER_SECOND;
        at.tv_sec += 1;
    }
    at
}
