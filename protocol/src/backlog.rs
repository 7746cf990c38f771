//! Distributes bytes that arrived while the program was held up among the scans that it makes up afterwards.
//!
//! If all of them were read in the first of those scans, frames would be ahead of the program's own time,
//! every later frame would seem late, and a partner that has sent all the while would seem silent.

use alloc::vec::Vec;

use crate::{Duration, SCAN};

/// Arrived and not taken yet.
#[derive(Debug, Default)]
pub struct Backlog {
    waiting: Vec<u8>,
}

impl Backlog {
    /// Adds what arrived and appends to `out` what belongs to this scan, which is `behind` its time.
    pub fn share(&mut self, arrived: &[u8], behind: Duration, out: &mut Vec<u8>) {
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
