//! Keeps tester and unit in step where both are on one computer, and it stands still: each finds out for itself, and
//! not to the millisecond. The tester then follows the unit's clock, so that what is left over does not add up.

use protocol::{Duration, Instant, SCAN};

/// Frames that come later than this after a pause are of the time after it.
const AFTER: Duration = Duration::from_us(3 * SCAN.as_us());
/// Tolerance of a frame's time on its way, ms.
const JITTER_MS: i64 = 20;
/// The most that the unit stands still for longer than the bench, ms.
const MOST_MS: i64 = 1000;

/// The unit's clock beside the bench's.
#[derive(Debug, Default)]
pub(super) struct InStep {
    /// Bench's clock less the unit's, ms, as last heard.
    offset_ms: Option<i64>,
    pause: Option<Pause>,
}

/// Unit and bench stood still, as it seems.
#[derive(Clone, Copy, Debug)]
struct Pause {
    since: Instant,
    before_ms: i64,
    took_ms: i64,
}

impl InStep {
    /// How much later the bench's next scans are due, µs, so that the unit's clock is where it was beside the bench's.
    /// The unit's `stamp` came with a frame heard at that time of the bench. A unit that went on, and whose frames were lost
    /// meanwhile, is as far ahead as the pause was long: the bench then has all of it to make up.
    pub fn correction_us(&mut self, stamp: Option<(Instant, u32)>) -> i64 {
        let Some((at, stamp_ms)) = stamp else {
            return 0;
        };
        let offset_ms = i64::from(at.stamp_ms().wrapping_sub(stamp_ms) as i32);
        let Some(pause) = self.pause else {
            self.offset_ms = Some(offset_ms);
            return 0;
        };
        if at < pause.since + AFTER {
            return 0;
        }
        self.pause = None;
        let ahead_ms = offset_ms - pause.before_ms;
        // A unit that started again has another clock.
        let of_the_pause = -(pause.took_ms + JITTER_MS)..=MOST_MS;
        match of_the_pause.contains(&ahead_ms) && ahead_ms.abs() >= JITTER_MS {
            true => ahead_ms * 1000,
            false => 0,
        }
    }

    /// Unit and bench stood still for so long.
    pub fn begin(&mut self, now: Instant, took: Duration) {
        self.pause = self.offset_ms.map(|before_ms| Pause {
            since: now,
            before_ms,
            took_ms: took.as_ms() as i64,
        });
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
        let took = Duration::from_ms(300);
        clocks.begin(Instant::from_ms(1000), took);
        assert_eq!(clocks.correction_us(later(1010, 850)), 0, "of before");
        assert_eq!(clocks.correction_us(later(1040, 870)), 70_000);
        assert_eq!(clocks.correction_us(later(1050, 880)), 0);
        clocks.begin(Instant::from_ms(1100), took);
        assert_eq!(clocks.correction_us(later(1200, 1130)), -100_000);
        clocks.begin(Instant::from_ms(1300), took);
        assert_eq!(clocks.correction_us(later(1400, 5)), 0, "started again");
    }

    #[test]
    fn a_unit_that_went_on_leaves_the_whole_pause_to_make_up() {
        let took = Duration::from_ms(3_000);
        let ahead_by = |ms: u32| {
            let mut clocks = InStep::default();
            clocks.correction_us(Some((Instant::from_ms(1000), 900)));
            clocks.begin(Instant::from_ms(1000), took);
            clocks.correction_us(Some((Instant::from_ms(1100), 1000 + ms)))
        };
        assert_eq!(ahead_by(2_990), -2_990_000);
        assert_eq!(ahead_by(60_000), 0, "no clock of that unit");
    }
}
