//! A computer that stands still with unit and tester on it gives neither of them time. Each finds out for itself, and not
//! to the millisecond: the tester then follows the unit's clock, so that what is left over does not add up.

use btu_rig::rig::UnitLink;
use protocol::{Duration, Instant, SCAN};

use super::Session;

/// Frames that come later than this after a pause are of the time after it.
const AFTER: Duration = Duration::from_us(3 * SCAN.as_us());
/// What a frame's way may differ by, ms.
const JITTER_MS: i64 = 20;

/// The unit's clock beside the bench's.
#[derive(Debug, Default)]
pub(super) struct InStep {
    /// Bench's clock less the unit's, ms, as last heard.
    offset_ms: Option<i64>,
    /// When unit and bench stood still, and the offset before.
    pause: Option<(Instant, i64)>,
}

impl InStep {
    /// How much later the bench's next scans are due, µs, so that the unit's clock is where it was beside the bench's.
    /// The unit's `stamp` came with a frame heard at that time of the bench.
    fn correction_us(&mut self, stamp: Option<(Instant, u32)>) -> i64 {
        let Some((at, stamp_ms)) = stamp else {
            return 0;
        };
        let offset_ms = i64::from(at.stamp_ms().wrapping_sub(stamp_ms) as i32);
        let Some((since, before_ms)) = self.pause else {
            self.offset_ms = Some(offset_ms);
            return 0;
        };
        if at < since + AFTER {
            return 0;
        }
        self.pause = None;
        let ahead_ms = offset_ms - before_ms;
        // A unit that started again has another clock.
        match (JITTER_MS..=1000).contains(&ahead_ms.abs()) {
            true => ahead_ms * 1000,
            false => 0,
        }
    }

    fn begin(&mut self, now: Instant) {
        self.pause = self.offset_ms.map(|before_ms| (now, before_ms));
    }
}

impl<L: UnitLink> Session<L> {
    /// Time in which the unit stood still as well is none, for both: nothing of what it does is spoiled.
    pub(super) fn keep_in_step(&mut self) {
        let pause = self.bench.link_mut().take_pause();
        let now = self.bench.now();
        if pause > Duration::ZERO {
            self.bench.rig_mut().note_pause(now, pause);
            self.in_step.begin(now);
            self.shift(pause.as_us() as i64);
        }
        if self.max_lag.is_some() {
            let stamp = self.bench.rig().unit_stamp_ms();
            let correction_us = self.in_step.correction_us(stamp);
            self.shift(correction_us);
        }
    }

    fn shift(&mut self, later_us: i64) {
        if later_us != 0 {
            self.pace.shift(later_us);
            self.bench.link_mut().shift_clock(later_us);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_two_pauses_differ_by_is_made_good_once() {
        let at = |ms| Some((Instant::from_ms(ms), ms as u32 - 100));
        let later = |ms, unit_ms| Some((Instant::from_ms(ms), unit_ms));
        let mut clocks = InStep::default();
        assert_eq!(clocks.correction_us(at(1000)), 0);
        clocks.begin(Instant::from_ms(1000));
        assert_eq!(clocks.correction_us(later(1010, 850)), 0, "of before");
        assert_eq!(clocks.correction_us(later(1040, 870)), 70_000);
        assert_eq!(clocks.correction_us(later(1050, 880)), 0);
        clocks.begin(Instant::from_ms(1100));
        assert_eq!(clocks.correction_us(later(1200, 1130)), -100_000);
        clocks.begin(Instant::from_ms(1300));
        assert_eq!(clocks.correction_us(later(1400, 5)), 0, "started again");
    }
}
