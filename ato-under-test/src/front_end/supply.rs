//! Power supply and clock of the unit, where injected faults act before everything else.

use protocol::injection::{Effect, Place};
use protocol::{Duration, Instant};

use crate::faults::{Faults, one_in_scan};
use crate::timer::at_rate;

/// Length of a single dip: enough to reset the processors.
const DIP: Duration = Duration::from_ms(100);

/// State of the supply in a scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Supply {
    /// Voltage is there.
    Up,
    Down,
    /// The supply has just come back.
    Back,
}

#[derive(Clone, Copy, Debug, Default)]
pub struct PowerAndClock {
    /// There is no voltage: the unit takes no bytes.
    pub down: bool,
    down_until: Instant,
    last: Instant,
    own: Instant,
}

impl PowerAndClock {
    /// Powered up again at `now`; the unit's own time restarts at 0.
    pub fn restarted(now: Instant) -> Self {
        Self {
            last: now,
            ..Self::default()
        }
    }

    pub fn supply(&mut self, now: Instant, faults: &mut Faults) -> Supply {
        let dips = match faults.at(Place::PowerSupply) {
            Some(Effect::Dead) => true,
            Some(Effect::Noise { per_s }) => faults.chance(one_in_scan(per_s)),
            _ => false,
        };
        if dips {
            self.down_until = now + DIP;
        }
        let was_down = self.down;
        self.down = now < self.down_until;
        match (was_down, self.down) {
            (_, true) => Supply::Down,
            (true, false) => Supply::Back,
            (false, false) => Supply::Up,
        }
    }

    /// The unit's own time for the true time since power-up.
    pub fn own(&mut self, now: Instant, rate: f64) -> Instant {
        let passed = now.since(self.last);
        self.last = now;
        self.own += at_rate(passed, rate);
        self.own
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use protocol::injection::Occurrence;

    use super::*;
    use crate::faults::tests::fault;

    fn faults(place: Place, effect: Effect) -> Faults {
        let mode = fault(place, effect, Occurrence::Always);
        Faults::new(&[mode], 1)
    }

    #[test]
    fn a_dip_takes_the_voltage_for_its_time_and_tells_when_it_is_back() {
        let mut faults = faults(Place::PowerSupply, Effect::Noise { per_s: 1.0 });
        let mut power = PowerAndClock::default();
        let mut course = Vec::new();
        for i in 0..3_000 {
            let now = Instant::from_ms(10 * i);
            faults.step(now);
            course.push(power.supply(now, &mut faults));
        }
        let backs = course.iter().filter(|s| **s == Supply::Back).count();
        let downs = course.iter().filter(|s| **s == Supply::Down).count();
        assert!((20..40).contains(&backs), "{backs} dips in 30 s");
        assert!(downs >= 10 * backs, "{downs} scans without voltage");
    }

    #[test]
    fn a_fast_clock_gains_what_it_is_fast_by() {
        let mut power = PowerAndClock::restarted(Instant::from_ms(5_000));
        let at = |ms| Instant::from_ms(ms);
        assert_eq!(power.own(at(5_000), 1.03), Instant::ZERO);
        assert_eq!(power.own(at(6_000), 1.03), at(1_030));
        assert_eq!(power.own(at(7_000), 1.0), at(2_030));
    }
}
