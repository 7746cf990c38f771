//! Paces scans: without waiting in virtual time, otherwise by absolute deadlines of the monotonic clock.

use protocol::{Duration, SCAN};
use rustix::thread::ClockId;
use rustix::time::Timespec;

const NANOS_PER_SECOND: i64 = 1_000_000_000;
/// Time between scans that are made up.
const MAKE_UP_NANOS: i64 = 1_000_000;

/// When the next scan is due.
pub enum Pace {
    /// As fast as possible.
    Virtual,
    /// Every 10 ms, or so many times that; a late scan is made up, not skipped.
    Real {
        /// The last deadline.
        due: Timespec,
        /// Times slower than the clock.
        slower: u32,
    },
}

impl Pace {
    /// Real time, beginning now.
    pub fn real() -> Self {
        Self::slower(1)
    }

    /// So many times slower than the clock, beginning now.
    pub fn slower(slower: u32) -> Self {
        Self::Real {
            slower,
            due: rustix::time::clock_gettime(rustix::time::ClockId::Monotonic),
        }
    }

    /// Waits until the next scan is due.
    pub fn wait(&mut self) {
        let Self::Real { due, slower } = self else {
            return;
        };
        let slower = i64::from(*slower);
        *due = later(*due, SCAN.as_us() as i64 * 1000 * slower);
        // Made up no faster than this, so that the other end can answer scan by scan: a machine that
        // held both up must not look like a slow unit.
        let soonest = later(
            rustix::time::clock_gettime(rustix::time::ClockId::Monotonic),
            MAKE_UP_NANOS * slower,
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

    /// How far the last scan, or what came after it, is behind its time, in the time of the bench.
    pub fn behind(&self) -> Duration {
        let Self::Real { due, slower } = self else {
            return Duration::ZERO;
        };
        let now = rustix::time::clock_gettime(rustix::time::ClockId::Monotonic);
        let nanos = (now.tv_sec - due.tv_sec) * NANOS_PER_SECOND + now.tv_nsec - due.tv_nsec;
        Duration::from_us(u64::try_from(nanos / 1000 / i64::from(*slower)).unwrap_or_default())
    }
}

fn later(mut at: Timespec, nanos: i64) -> Timespec {
    at.tv_nsec += nanos;
    at.tv_sec += at.tv_nsec / NANOS_PER_SECOND;
    at.tv_nsec %= NANOS_PER_SECOND;
    at
}
