//! On-delay timers, for one condition and for one of each car, and a detector of frequent events.

use protocol::{Duration, Instant};

use crate::train::{CarSet, MAX_CARS};

/// On-delay timer: true once its condition has held without a break for a given time.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OnDelay {
    since: Option<Instant>,
}

impl OnDelay {
    /// Takes the present value; true once it has held for `at_least`.
    pub fn update(&mut self, now: Instant, holds: bool, at_least: Duration) -> bool {
        if !holds {
            self.since = None;
            return false;
        }
        let since = *self.since.get_or_insert(now);
        now.since(since) >= at_least
    }
}

/// An on-delay timer for each car.
#[derive(Clone, Debug)]
pub(super) struct OnDelayCars {
    holds: CarSet,
    since: [Instant; MAX_CARS],
}

impl Default for OnDelayCars {
    fn default() -> Self {
        Self {
            holds: CarSet::NONE,
            since: [Instant::ZERO; MAX_CARS],
        }
    }
}

impl OnDelayCars {
    /// Takes the cars for which the condition holds now; returns those for which it has held for `at_least`.
    pub fn update(&mut self, now: Instant, holds: CarSet, at_least: Duration) -> CarSet {
        let before = std::mem::replace(&mut self.holds, holds);
        let mut lasting = CarSet::NONE;
        // Mostly the condition holds for no car, and the loop is not needed.
        if holds.is_empty() {
            return lasting;
        }
        for car in holds.iter() {
            if !before.contains(car) {
                self.since[car] = now;
            }
            lasting.set(car, now.since(self.since[car]) >= at_least);
        }
        lasting
    }

    /// Starts again, as if the condition had held for no car.
    pub fn clear(&mut self) {
        self.holds = CarSet::NONE;
    }
}

/// Detects frequent events: at least a given number within a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct BurstDetector {
    at_least: u32,
    within: Duration,
    /// Begin of the time that is watched, and the count then.
    from: Option<(Instant, u32)>,
    count: u32,
    told: bool,
}

impl BurstDetector {
    /// A burst is at least `at_least` events within the time `within`.
    pub fn new(at_least: u32, within: Duration) -> Self {
        Self {
            at_least,
            within,
            from: None,
            count: 0,
            told: false,
        }
    }

    /// Takes the count of events so far; true when a burst begins. A burst ends when `within` passes without an event.
    pub fn begins(&mut self, now: Instant, count: u32) -> bool {
        let came = count != self.count;
        if !came && self.from.is_none() {
            return false;
        }
        if self
            .from
            .is_some_and(|(from, _)| now.since(from) > self.within)
        {
            self.told &= self.from.is_some_and(|(_, before)| before != self.count);
            // After a burst the count is watched on, so that the end of the burst is seen.
            self.from = self.told.then_some((now, self.count));
        }
        if came && self.from.is_none() {
            self.from = Some((now, self.count));
        }
        self.count = count;
        let many = self
            .from
            .is_some_and(|(_, before)| count.saturating_sub(before) >= self.at_least);
        let begins = many && !self.told;
        self.told |= many;
        begins
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lasts_without_a_gap() {
        let mut lasting = OnDelay::default();
        let held = |lasting: &mut OnDelay, ms: u64, holds: bool| {
            lasting.update(Instant::from_ms(ms), holds, Duration::from_ms(50))
        };
        assert!(!held(&mut lasting, 0, true));
        assert!(!held(&mut lasting, 40, true));
        assert!(held(&mut lasting, 50, true));
        assert!(!held(&mut lasting, 60, false));
        assert!(!held(&mut lasting, 70, true));
        assert!(!held(&mut lasting, 110, true));
    }

    /// Each car has its own time.
    #[test]
    fn cars_last_one_by_one() {
        let mut lasting = OnDelayCars::default();
        let mut held = |ms: u64, holds: CarSet| {
            lasting.update(Instant::from_ms(ms), holds, Duration::from_ms(50))
        };
        let (one, two) = (CarSet::one(1), CarSet::one(2));
        assert!(held(0, one).is_empty());
        assert!(held(30, one.with(two)).is_empty());
        assert_eq!(held(50, one.with(two)), one);
        assert_eq!(held(80, one.with(two)), one.with(two));
        assert_eq!(held(90, two), two);
        assert_eq!(held(100, one.with(two)), two);
    }

    #[test]
    fn a_burst_is_told_once_until_it_is_over() {
        let mut burst = BurstDetector::new(3, Duration::from_ms(1000));
        let mut begins = |ms: u64, count: u32| burst.begins(Instant::from_ms(ms), count);
        // Two and two, with a pause: never three within a second.
        assert!(!begins(0, 1) && !begins(100, 2) && !begins(1200, 2));
        assert!(!begins(1300, 3) && !begins(1400, 4));
        assert!(begins(1500, 5));
        // The burst goes on: nothing new.
        for i in 0..40 {
            assert!(!begins(1600 + i * 100, 6 + i as u32), "{i}");
        }
        // Over, and again from the start.
        for ms in (5600..8000).step_by(100) {
            assert!(!begins(ms, 45));
        }
        assert!(!begins(8000, 46) && !begins(8010, 47));
        assert!(begins(8020, 48));
    }
}
