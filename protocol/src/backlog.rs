//! Distributes bytes that arrived while the program was held up over the scans that it makes up afterwards.
//!
//! If all of them were read in the first of those scans, frames would be ahead of the program's own time,
//! every later frame would seem late, and a partner that has sent all the while would seem silent.
//!
//! A partner that has sent nothing meanwhile stood still itself: both are programs on one computer, which held both up.
//! Then neither has anything to make up, and the time counts for neither.

use alloc::vec::Vec;

use crate::{Duration, SCAN};

/// Bytes that have arrived and that no scan has taken yet.
#[derive(Debug, Default)]
pub struct Backlog {
    waiting: Vec<u8>,
    /// Bytes that usually arrive in a scan, times [`PARTS`].
    usual: usize,
    /// The last scan was late, too.
    late: bool,
}

/// Shortest delay that counts as a standstill; scans missed by a shorter one are made up whatever the partner did.
const PAUSE: Duration = Duration::from_ms(100);
/// Number of scans over which the usual number of bytes is averaged; the average is kept times this number.
const PARTS: usize = 64;

impl Backlog {
    /// Adds the bytes that arrived, and appends to `out` those of this scan, which is late by `behind`. Returns how
    /// much of `behind` does not count as time, because the partner stood still as well.
    pub fn share(&mut self, arrived: &[u8], behind: Duration, out: &mut Vec<u8>) -> Duration {
        let pause = self.pause(arrived.len(), behind);
        self.spread(
            arrived,
            Duration::from_us(behind.as_us() - pause.as_us()),
            out,
        );
        pause
    }

    /// `behind` itself, if this is the first scan after a standstill and less than half of what usually arrives in that
    /// time has arrived; else 0.
    fn pause(&mut self, arrived: usize, behind: Duration) -> Duration {
        let late = behind >= PAUSE;
        let was_late = core::mem::replace(&mut self.late, late);
        let first = late && !was_late;
        if behind < SCAN {
            self.usual = self.usual - self.usual / PARTS + arrived;
        }
        let scans = usize::try_from(behind.as_us() / SCAN.as_us()).unwrap_or(usize::MAX);
        let usual = self.usual.saturating_mul(scans) / PARTS;
        if !first || arrived.saturating_mul(2) >= usual {
            return Duration::ZERO;
        }
        self.late = false;
        behind
    }

    fn spread(&mut self, arrived: &[u8], behind: Duration, out: &mut Vec<u8>) {
        let scans_to_make_up = behind.as_us() / SCAN.as_us();
        if scans_to_make_up == 0 {
            out.append(&mut self.waiting);
            out.extend_from_slice(arrived);
            return;
        }
        self.waiting.extend_from_slice(arrived);
        let scans = usize::try_from(scans_to_make_up + 1).unwrap_or(usize::MAX);
        let share = self.waiting.len().div_ceil(scans);
        out.extend(self.waiting.drain(..share));
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec;

    use super::*;

    fn shares(backlog: &mut Backlog, arrived: usize, behind_ms: &[u64]) -> Vec<usize> {
        let mut arrived = vec![0; arrived];
        let mut one = |behind: &u64| {
            let mut out = Vec::new();
            backlog.share(&arrived, Duration::from_ms(*behind), &mut out);
            arrived.clear();
            out.len()
        };
        behind_ms.iter().map(&mut one).collect()
    }

    #[test]
    fn in_time_nothing_waits() {
        assert_eq!(shares(&mut Backlog::default(), 20, &[0, 9, 3]), [20, 0, 0]);
    }

    #[test]
    fn waiting_bytes_are_spread_over_the_scans_that_are_made_up() {
        let mut backlog = Backlog::default();
        assert_eq!(
            shares(&mut backlog, 100, &[40, 31, 22, 13, 4]),
            [20, 20, 20, 20, 20]
        );
        assert_eq!(shares(&mut backlog, 10, &[500, 0]), [1, 9]);
    }

    /// The pause after 200 scans with 20 bytes each, when `arrived` bytes came while the program stood still.
    fn pause(arrived: usize, behind_ms: u64) -> Duration {
        let (mut backlog, mut out) = (Backlog::default(), Vec::new());
        for _ in 0..200 {
            let none = backlog.share(&[0; 20], Duration::ZERO, &mut out);
            assert_eq!(none, Duration::ZERO);
        }
        out.clear();
        let pause = backlog.share(&vec![0; arrived], Duration::from_ms(behind_ms), &mut out);
        let taken = if pause > Duration::ZERO {
            arrived
        } else {
            arrived.div_ceil(behind_ms as usize / 10 + 1)
        };
        assert_eq!(out.len(), taken);
        pause
    }

    #[test]
    fn a_partner_that_stood_still_as_well_leaves_nothing_to_make_up() {
        assert_eq!(pause(20, 300), Duration::from_ms(300));
        assert_eq!(pause(0, 5_000), Duration::from_ms(5_000));
    }

    #[test]
    fn a_partner_that_went_on_is_heard_scan_by_scan() {
        assert_eq!(pause(600, 300), Duration::ZERO);
        assert_eq!(pause(350, 300), Duration::ZERO);
    }

    #[test]
    fn a_short_standstill_and_a_partner_that_never_spoke_are_made_up() {
        assert_eq!(pause(0, 90), Duration::ZERO);
        let mut backlog = Backlog::default();
        assert_eq!(
            backlog.share(&[], Duration::from_ms(300), &mut Vec::new()),
            Duration::ZERO
        );
    }

    /// Only the first scan after a standstill can tell: the scans made up after it find nothing more on the wire.
    #[test]
    fn scans_that_are_made_up_are_no_pause() {
        let (mut backlog, mut out) = (Backlog::default(), Vec::new());
        for _ in 0..200 {
            backlog.share(&[0; 20], Duration::ZERO, &mut out);
        }
        let mut late = |arrived: usize, ms: u64| {
            backlog.share(&vec![0; arrived], Duration::from_ms(ms), &mut out)
        };
        assert_eq!(late(600, 300), Duration::ZERO);
        assert_eq!(late(0, 290), Duration::ZERO);
        assert_eq!(late(0, 280), Duration::ZERO);
    }

    /// A standstill that was made up, for instance before the first byte of the partner, says nothing about the next
    /// one.
    #[test]
    fn a_pause_is_seen_after_a_standstill_that_was_made_up() {
        let (mut backlog, mut out) = (Backlog::default(), Vec::new());
        for ms in [300, 200, 100] {
            let none = backlog.share(&[], Duration::from_ms(ms), &mut out);
            assert_eq!(none, Duration::ZERO);
        }
        for _ in 0..200 {
            backlog.share(&[0; 20], Duration::ZERO, &mut out);
        }
        let took = Duration::from_ms(300);
        assert_eq!(backlog.share(&[0; 20], took, &mut out), took);
    }

    #[test]
    fn bytes_stay_in_order() {
        let (mut backlog, mut out) = (Backlog::default(), Vec::new());
        let behind = Duration::from_ms(30);
        backlog.share(&[1, 2, 3, 4, 5], behind, &mut out);
        backlog.share(&[6, 7], behind, &mut out);
        backlog.share(&[8], Duration::ZERO, &mut out);
        assert_eq!(out, [1, 2, 3, 4, 5, 6, 7, 8]);
    }
}
