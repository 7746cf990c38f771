//! Brakes that are not released (S4 figure 3).
//!
//! While no brake is asked for, TCMS asks each brake control unit. A car whose cylinders still hold pressure
//! after a time is found not released: powering is cut, ATO is informed, and the full service brake comes
//! on. With that brake on nothing can be learned by asking, so what was found is kept. It is dropped
//! - by force: while the driver releases brakes by force TCMS asks no unit, and the brake is released;
//! - for a car whose brake is cut out;
//! - when driver or ATO has braked and released again: then the full service brake is lifted for as
//!   long as a brake may take, each unit is asked again, and powering stays cut until all have
//!   released. The brake comes back when one has not.

use protocol::{Duration, Instant};

use crate::train::CarSet;

use super::timer::OnDelayCars;

/// Inputs of a scan.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReleaseCheck {
    /// No brake is ordered but by this search itself: no service, holding, full service, emergency, security or parking
    /// brake.
    pub nobody_brakes: bool,
    /// Brakes are released by force.
    pub by_force: bool,
    /// Cars whose cylinders hold pressure.
    pub pressed: CarSet,
    /// Cars whose brake is cut out.
    pub cut_out: CarSet,
}

/// The search for brakes that are not released.
#[derive(Clone, Debug)]
pub(super) struct NotReleased {
    after: Duration,
    pressed: OnDelayCars,
    found: CarSet,
    /// Driver or ATO has braked since a brake was found not released.
    braked: bool,
    asks_again: bool,
}

impl NotReleased {
    /// A detector that has found no brake; a brake may take `after` to release.
    pub fn new(after: Duration) -> Self {
        Self {
            after,
            pressed: OnDelayCars::default(),
            found: CarSet::NONE,
            braked: false,
            asks_again: false,
        }
    }

    /// Forgets what was found.
    pub fn clear(&mut self) {
        self.found = CarSet::NONE;
        self.asks_again = false;
        self.pressed.clear();
    }

    /// The cars found, and whether they bring the full service brake (BCXNRB).
    pub fn step(&mut self, now: Instant, asked: &ReleaseCheck) -> (CarSet, bool) {
        if asked.by_force {
            self.clear();
            return (CarSet::NONE, false);
        }
        self.found = self.found.without(asked.cut_out);
        if !asked.nobody_brakes {
            self.braked = true;
            self.asks_again = false;
            self.pressed.clear();
            return (self.found, !self.found.is_empty());
        }
        if !self.found.is_empty() && !self.asks_again {
            if !self.braked {
                return (self.found, true);
            }
            self.asks_again = true;
        }
        let lasting = self.pressed.update(now, asked.pressed, self.after);
        if self.asks_again {
            let released = self.found.without(asked.pressed);
            self.found = self.found.without(released);
        }
        if !lasting.is_empty() {
            self.found = self.found.with(lasting);
            self.asks_again = false;
            self.braked = false;
            self.pressed.clear();
        }
        let brakes = !self.found.is_empty() && !self.asks_again;
        self.asks_again &= !self.found.is_empty();
        (self.found, brakes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAR: usize = 3;

    struct Train {
        search: NotReleased,
        ms: u64,
    }

    impl Train {
        fn new() -> Self {
            Self {
                search: NotReleased::new(Duration::from_ms(3000)),
                ms: 0,
            }
        }

        /// Scans of 10 ms with or without pressure in a car.
        fn run(&mut self, ms: u64, nobody_brakes: bool, pressed: bool) -> (bool, bool) {
            let pressed = if pressed {
                CarSet::one(CAR)
            } else {
                CarSet::NONE
            };
            let mut last = (CarSet::NONE, false);
            for _ in 0..ms / 10 {
                self.ms += 10;
                let asked = ReleaseCheck {
                    nobody_brakes,
                    by_force: false,
                    pressed,
                    cut_out: CarSet::NONE,
                };
                last = self.search.step(Instant::from_ms(self.ms), &asked);
            }
            (!last.0.is_empty(), last.1)
        }
    }

    #[test]
    fn a_brake_that_releases_in_time_is_none() {
        let mut train = Train::new();
        assert_eq!(train.run(9000, false, true), (false, false), "it brakes");
        assert_eq!(train.run(2900, true, true), (false, false));
        assert_eq!(train.run(9000, true, false), (false, false));
    }

    /// The full service brake that the search itself orders neither hides nor ends its finding.
    #[test]
    fn stays_found_while_its_own_brake_holds() {
        let mut train = Train::new();
        assert_eq!(train.run(3010, true, true), (true, true));
        assert_eq!(train.run(60_000, true, true), (true, true));
        assert_eq!(train.run(60_000, true, false), (true, true));
        assert_eq!(train.run(1000, false, true), (true, true));
    }

    /// After driver or ATO has braked, units are asked again: the finding ends if the brake has released, else it is
    /// back.
    #[test]
    fn is_asked_again_after_a_brake() {
        let mut train = Train::new();
        train.run(3010, true, true);
        train.run(1000, false, true);
        assert_eq!(train.run(1000, true, true), (true, false), "being asked");
        assert_eq!(train.run(2500, true, true), (true, true), "still not");
        train.run(1000, false, true);
        train.run(1000, true, true);
        assert_eq!(train.run(10, true, false), (false, false), "released");
        assert_eq!(
            train.run(2900, true, true),
            (false, false),
            "from the start"
        );
    }

    #[test]
    fn force_and_cut_out_end_it() {
        let mut train = Train::new();
        train.run(3010, true, true);
        let asked = ReleaseCheck {
            nobody_brakes: true,
            by_force: true,
            pressed: CarSet::one(CAR),
            cut_out: CarSet::NONE,
        };
        let now = Instant::from_ms(train.ms + 10);
        assert_eq!(train.search.step(now, &asked), (CarSet::NONE, false));
        train.run(3010, true, true);
        let cut_out = ReleaseCheck {
            by_force: false,
            pressed: CarSet::NONE,
            cut_out: CarSet::one(CAR),
            ..asked
        };
        let now = Instant::from_ms(train.ms + 10);
        assert_eq!(train.search.step(now, &cut_out), (CarSet::NONE, false));
    }
}
