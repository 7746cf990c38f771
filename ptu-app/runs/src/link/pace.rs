//! Paces scans: without waiting in virtual time, otherwise by the deadlines that the unit goes by, too.

use std::time::{Duration as WallTime, Instant as WallClock};

use protocol::{Duration, Instant, ScanDeadlines};

/// When the next scan is due.
pub enum Pace {
    Virtual,
    Real {
        /// Where the deadlines count from.
        began: WallClock,
        deadlines: ScanDeadlines,
    },
}

impl Pace {
    /// Real time, beginning now.
    pub fn real() -> Self {
        Self::slower(1)
    }

    /// A pace `slower` times slower than the clock, beginning now.
    pub fn slower(slower: u32) -> Self {
        Self::Real {
            began: WallClock::now(),
            deadlines: ScanDeadlines::new(Instant::ZERO, slower),
        }
    }

    /// Waits until the next scan is due.
    pub fn wait(&mut self) {
        if let Self::Real { began, deadlines } = self {
            let wake = *began + WallTime::from_micros(deadlines.next(since(*began)).as_us());
            std::thread::sleep(wake.saturating_duration_since(WallClock::now()));
        }
    }

    /// Moves the deadlines of the next scans by this number of µs of the bench, later or earlier.
    pub fn shift(&mut self, later_us: i64) {
        if let Self::Real { deadlines, .. } = self {
            deadlines.shift(later_us);
        }
    }

    /// Lag of the last scan, or of what came after it, in the time of the bench.
    pub fn behind(&self) -> Duration {
        match self {
            Self::Virtual => Duration::ZERO,
            Self::Real { began, deadlines } => deadlines.behind(since(*began)),
        }
    }
}

fn since(began: WallClock) -> Instant {
    Instant::from_us(u64::try_from(began.elapsed().as_micros()).unwrap_or(u64::MAX))
}
