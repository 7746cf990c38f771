//! The unit's clock beside TCMS's: TCMS sends one frame in each cycle of the link and counts them.

use protocol::{CYCLE, Duration, Instant};

/// Frames over which the two clocks are compared: 5 s, in which a frame that is late by 120 ms counts 2 %.
const FRAMES: u32 = 100;
/// Time between frames from which on a frame is missing or held up, and the comparison begins anew. At a clock that is
/// half as fast again a frame comes every 75 ms.
const GAP: Duration = Duration::from_ms(150);

/// Compares from frame to frame.
#[derive(Debug, Default)]
pub struct Pace {
    began: Option<Instant>,
    last: Instant,
    frames: u32,
    rate: f64,
}

impl Pace {
    /// A frame whose alive counter has moved on by `counts`.
    pub fn count(&mut self, now: Instant, counts: u8) {
        let in_time = now.since(self.last) <= GAP;
        self.last = now;
        let Some(began) = self.began.filter(|_| in_time) else {
            (self.began, self.frames) = (Some(now), 0);
            return;
        };
        self.frames += u32::from(counts);
        if self.frames >= FRAMES {
            let by_tcms = CYCLE.as_secs() * f64::from(self.frames);
            self.rate = now.since(began).as_secs() / by_tcms - 1.0;
            (self.began, self.frames) = (Some(now), 0);
        }
    }

    /// Share by which the unit's clock is faster than TCMS's, slower negative; 0 until they have been compared.
    pub fn clock_gains(&self) -> f64 {
        self.rate
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames every so many milliseconds of the unit's clock; what the clock gains.
    fn gains(period_ms: u64, frames: u64, held_up: impl Fn(u64) -> u64) -> f64 {
        let mut pace = Pace::default();
        for frame in 0..frames {
            pace.count(Instant::from_ms(frame * period_ms + held_up(frame)), 1);
        }
        pace.clock_gains()
    }

    #[test]
    fn a_clock_gains_what_it_is_fast_by() {
        for (period_ms, share) in [(50, 0.0), (57, 0.14), (75, 0.5), (25, -0.5)] {
            let found = gains(period_ms, 102, |_| 0);
            assert!((found - share).abs() < 0.001, "{period_ms} ms: {found}");
        }
        assert_eq!(gains(57, 100, |_| 0), 0.0, "not compared yet");
    }

    #[test]
    fn frames_that_are_held_up_or_missing_tell_of_no_clock() {
        let late = |frame| if frame % 7 == 0 { 60 } else { 0 };
        assert!(gains(50, 500, late).abs() < 0.03);
        let silent = |frame: u64| frame / 40 * 400;
        assert_eq!(gains(50, 500, silent), 0.0);
        // A frame that was lost was counted all the same.
        let mut pace = Pace::default();
        for frame in (0..300_u64).filter(|frame| frame % 5 != 0) {
            let counts = 1 + u8::from(frame % 5 == 1);
            pace.count(Instant::from_ms(frame * 50), counts);
        }
        assert!(pace.clock_gains().abs() < 0.001, "{}", pace.clock_gains());
    }
}
