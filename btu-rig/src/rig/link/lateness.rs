//! Lateness of the unit's frames: while a link holds bytes back, the bench learns late what the unit did.
//!
//! A frame's stamp says when the unit made it. The fastest of the latest frames took the link's own time; the time that
//! another frame took beyond this is its lateness.

use std::collections::VecDeque;

use protocol::{Duration, Instant};

/// Time over which frames are compared: so short that a clock wrong by some percent makes no lateness.
const SPAN: Duration = Duration::from_ms(600);
/// Stamps further apart than this are of a unit that was started again, ms.
const JUMPS_MS: i64 = 5_000;

#[derive(Debug, Default)]
pub struct Lateness {
    /// When frames came, and by how much the bench's clock was ahead of their stamps, ms: the fastest first, and after each
    /// the fastest of those that came later.
    past: VecDeque<(Instant, i64)>,
}

impl Lateness {
    /// How late a frame comes that the unit stamped with `stamp_ms`.
    pub fn take(&mut self, at: Instant, stamp_ms: u32) -> Duration {
        let ahead_ms = (at.as_us() / 1_000) as i64 - i64::from(stamp_ms);
        let jumps = |(_, before_ms): &(Instant, i64)| (ahead_ms - before_ms).abs() > JUMPS_MS;
        if self.past.back().is_some_and(jumps) {
            self.past.clear();
        }
        while self.past.back().is_some_and(|(_, ms)| *ms >= ahead_ms) {
            self.past.pop_back();
        }
        self.past.push_back((at, ahead_ms));
        while self.past[0].0 + SPAN < at {
            self.past.pop_front();
        }
        Duration::from_ms((ahead_ms - self.past[0].1) as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The greatest lateness of a second of frames, one in 10 ms, of a clock at this rate; those made from 500 to 590 ms come
    /// together at 590 ms where the link holds them.
    fn latest_ms(rate: f64, holds: bool, first_ms: u32) -> u64 {
        let mut lateness = Lateness::default();
        let mut latest = Duration::ZERO;
        for made_ms in (0..1_000).step_by(10) {
            let held = holds && (500..590).contains(&made_ms);
            let at = Instant::from_ms(if held { 590 } else { made_ms });
            let stamp_ms = first_ms.wrapping_add((made_ms as f64 * rate) as u32);
            latest = latest.max(lateness.take(at, stamp_ms));
        }
        latest.as_ms()
    }

    #[test]
    fn a_link_that_holds_frames_is_late_and_a_clock_that_is_slow_is_not() {
        for first_ms in [0, 1_000_000, u32::MAX - 500] {
            assert_eq!(latest_ms(1.0, false, first_ms), 0);
            assert_eq!(latest_ms(1.0, true, first_ms), 90);
            for rate in [0.97, 1.03] {
                assert!(latest_ms(rate, false, first_ms) <= 20);
            }
        }
    }
}
