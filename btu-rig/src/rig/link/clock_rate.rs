//! Rate of the unit's clock against the bench's, by the stamps of frames: a unit whose clock is wrong measures all
//! times and speeds wrong, and refuses good frames as late.

use protocol::{Duration, Instant};

/// Span over which a rate is measured: a frame's way may take some tens of milliseconds more than another one's.
const SPAN: Duration = Duration::from_ms(3_500);
/// Spans in a row that must agree: a unit that stood still is off in one of them, and a frame that came late makes one
/// longer and the next one shorter.
const SPANS: u32 = 3;
/// Rate beyond which a clock is wrong, thousandths: a crystal is off by less than a hundredth of this.
const WRONG_PERMILLE: i32 = 10;

/// The measurement, span by span.
#[derive(Debug, Default)]
pub struct ClockRate {
    /// When the span began, and the unit's clock then, ms.
    begun: Option<(Instant, u32)>,
    /// Excess of the unit's clock over the bench's in the last span, thousandths.
    off_permille: i32,
    /// Spans in a row in which the unit's clock was wrong in the same direction.
    wrong: u32,
}

impl ClockRate {
    /// Takes when a frame came, and its stamp, ms.
    pub fn take(&mut self, at: Instant, stamp_ms: u32) {
        let (since, first_ms) = *self.begun.get_or_insert((at, stamp_ms));
        let by_bench = at.since(since);
        if by_bench < SPAN {
            return;
        }
        let by_unit_us = f64::from(stamp_ms.wrapping_sub(first_ms)) * 1e3;
        let rate = by_unit_us / by_bench.as_us() as f64;
        let off_permille = ((rate - 1.0) * 1e3).round() as i32;
        let as_before = off_permille.signum() == self.off_permille.signum();
        self.wrong = match off_permille.abs() > WRONG_PERMILLE {
            true if as_before => self.wrong + 1,
            true => 1,
            false => 0,
        };
        self.off_permille = off_permille;
        self.begun = Some((at, stamp_ms));
    }

    /// Excess of the unit's clock over the bench's, thousandths, if the unit's clock is wrong.
    pub fn wrong_by_permille(&self) -> Option<i32> {
        (self.wrong >= SPANS).then_some(self.off_permille)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rate measured after `seconds` of a clock at `rate`, whose frames take up to 40 ms longer, and which stands
    /// still at `stands_at_s` for half a second.
    fn measured(rate: f64, seconds: u32, stands_at_s: u32) -> Option<i32> {
        let mut clock = ClockRate::default();
        for cycle in 0..seconds * 20 {
            let way_ms = u64::from(cycle * 7 % 5) * 10;
            let at = Instant::from_ms(u64::from(cycle) * 50 + way_ms);
            let stood_ms = if cycle > stands_at_s * 20 { 500.0 } else { 0.0 };
            let stamp_ms = f64::from(cycle) * 50.0 * rate - stood_ms;
            clock.take(at, (stamp_ms + 1e9) as u32);
        }
        clock.wrong_by_permille()
    }

    #[test]
    fn a_clock_that_goes_wrong_is_measured_and_one_that_stands_still_once_is_not() {
        for (rate, permille) in [(1.03, 30), (1.02, 20), (0.97, -30)] {
            let found = measured(rate, 40, 100);
            assert!(
                found.is_some_and(|off| (off - permille).abs() <= 12),
                "{rate}: {found:?}"
            );
        }
        assert_eq!(measured(1.03, 10, 100), None, "not yet");
        for rate in [1.0, 1.005, 0.9999] {
            assert_eq!(measured(rate, 60, 12), None, "{rate}");
        }
    }
}
