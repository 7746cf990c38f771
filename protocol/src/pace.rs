//! When the next scan is due. Unit and tester pace their scans by this rule, each with its own clock.

use crate::{Duration, Instant, SCAN};

/// Least time between scans that are made up, so that the other end can answer scan by scan: a machine that held
/// both ends up must not look like a slow unit.
const MAKE_UP: Duration = Duration::from_ms(1);

/// Deadlines of scans: every 10 ms of a monotonic clock, times `slower`. A late scan is made up, not skipped.
#[derive(Clone, Copy, Debug)]
pub struct ScanDeadlines {
    /// The last deadline, by the clock.
    due: Instant,
    slower: u32,
}

impl ScanDeadlines {
    /// The first scan is due one period after `now`; periods are `slower` times as long.
    pub const fn new(now: Instant, slower: u32) -> Self {
        Self { due: now, slower }
    }

    /// When to wake up for the next scan.
    pub fn next(&mut self, now: Instant) -> Instant {
        self.due += SCAN.times(self.slower);
        self.due.max(now + MAKE_UP.times(self.slower))
    }

    /// Moves the deadlines of the next scans by this number of µs of the bench, later or earlier.
    pub fn shift(&mut self, later_us: i64) {
        let by = Duration::from_us(later_us.unsigned_abs()).times(self.slower);
        self.due = match later_us >= 0 {
            true => self.due + by,
            false => self.due.back(by),
        };
    }

    /// Time from the last deadline to `now`, in bench time.
    pub const fn behind(&self, now: Instant) -> Duration {
        Duration::from_us(now.since(self.due).as_us() / self.slower as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn late_scans_are_made_up_one_by_one() {
        let at = Instant::from_ms;
        let mut deadlines = ScanDeadlines::new(at(0), 1);
        assert_eq!(deadlines.next(at(0)), at(10));
        // Held up for 35 ms: the scans due at 20, 30 and 40 follow each other by a millisecond.
        assert_eq!(deadlines.next(at(45)), at(46));
        assert_eq!(deadlines.behind(at(46)), Duration::from_ms(26));
        assert_eq!(deadlines.next(at(46)), at(47));
        assert_eq!(deadlines.next(at(47)), at(48));
        assert_eq!(deadlines.next(at(48)), at(50));
        assert_eq!(deadlines.behind(at(50)), Duration::ZERO);
    }

    #[test]
    fn a_slower_pace_stretches_periods_and_counts_lag_in_bench_time() {
        let at = Instant::from_ms;
        let mut deadlines = ScanDeadlines::new(at(5), 4);
        assert_eq!(deadlines.next(at(5)), at(45));
        assert_eq!(deadlines.behind(at(85)), Duration::from_ms(10));
        assert_eq!(deadlines.next(at(85)), at(89));
    }
}
