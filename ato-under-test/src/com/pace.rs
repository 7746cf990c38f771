//! The unit's clock beside TCMS's: TCMS sends one frame in each cycle of the link and counts them.
//!
//! Only a fast clock is reported, after two comparisons in a row: frames that were held up come all at once, as they do
//! when the unit's clock is slow.

use protocol::{CYCLE, Duration, Instant};

/// Frames over which the two clocks are compared: 5 s, in which a frame that is late by 120 ms counts 2 %.
const FRAMES: u32 = 100;
/// Time between frames from which on a frame is missing or held up, and the comparison begins again. At a clock that is
/// half as fast again a frame comes every 75 ms.
const GAP: Duration = Duration::from_ms(150);
/// Counts from one frame to the next, beyond which the counter has jumped.
const MOST_COUNTS: u8 = 3;

/// Compares the unit's clock with TCMS's from frame to frame.
#[derive(Debug, Default)]
pub struct Pace {
    began: Option<Instant>,
    last: Instant,
    frames: u32,
    /// Shares of the last two comparisons.
    ahead: [f64; 2],
}

impl Pace {
    /// Counts a frame whose alive counter has moved on by `counts`.
    pub fn count(&mut self, now: Instant, counts: u8) {
        let in_time = now.since(self.last) <= GAP && counts <= MOST_COUNTS;
        self.last = now;
        let Some(began) = self.began.filter(|_| in_time) else {
            (self.began, self.frames) = (Some(now), 0);
            return;
        };
        self.frames += u32::from(counts);
        if self.frames >= FRAMES {
            let by_tcms = CYCLE.as_secs() * f64::from(self.frames);
            let ahead = now.since(began).as_secs() / by_tcms - 1.0;
            self.ahead = [self.ahead[1], ahead];
            (self.began, self.frames) = (Some(now), 0);
        }
    }

    /// Share by which the unit's clock is faster than TCMS's; 0 if it is not, or was not compared twice.
    pub fn clock_ahead(&self) -> f64 {
        let [before, last] = self.ahead;
        before.min(last).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Share by which a clock seems ahead whose frames come every `period_ms` of that clock.
    fn ahead(period_ms: u64, frames: u64, held_up: impl Fn(u64) -> u64) -> f64 {
        let mut pace = Pace::default();
        for frame in 0..frames {
            pace.count(Instant::from_ms(frame * period_ms + held_up(frame)), 1);
        }
        pace.clock_ahead()
    }

    #[test]
    fn a_clock_is_ahead_by_what_it_is_fast() {
        for (period_ms, share) in [(50, 0.0), (57, 0.14), (75, 0.5), (25, 0.0)] {
            let found = ahead(period_ms, 203, |_| 0);
            assert!((found - share).abs() < 0.001, "{period_ms} ms: {found}");
        }
        assert_eq!(ahead(57, 200, |_| 0), 0.0, "compared once");
    }

    #[test]
    fn frames_that_are_held_up_or_missing_tell_of_no_clock() {
        let late = |frame| if frame % 7 == 0 { 60 } else { 0 };
        assert!(ahead(50, 500, late) < 0.03);
        let silent = |frame: u64| frame / 40 * 400;
        assert_eq!(ahead(50, 500, silent), 0.0);
        // Sixty frames that a tester owes after 3 s come at once.
        let owed = |frame: u64| match frame {
            0..200 => 0,
            200..260 => (260 - frame) * 50,
            _ => 0,
        };
        assert!(ahead(50, 600, owed) < 0.01);
        // The next frame's counter includes a lost frame; a counter that jumps says nothing of the
        // clock.
        let mut pace = Pace::default();
        for frame in (0..600_u64).filter(|frame| frame % 5 != 0) {
            let counts = match (frame, frame % 5) {
                (299, _) => 90,
                (_, 1) => 2,
                _ => 1,
            };
            pace.count(Instant::from_ms(frame * 50), counts);
        }
        assert!(pace.clock_ahead() < 0.001, "{}", pace.clock_ahead());
    }
}
