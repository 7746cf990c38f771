//! Injected faults by place. Only the signal path reads them; no function that judges does.

use alloc::vec::Vec;

use protocol::injection::{Effect, FaultMode, OccurrenceState, Place};
use protocol::{Duration, Instant, Random, SCAN, Speed};

/// Time over which faults that depend on the wheels' speed average it: pulses of one scan are too few.
const FELT_OVER: Duration = Duration::from_ms(200);

/// The faults of this unit and how much of each acts at present.
///
/// All chances of faults are drawn here, and each mode's spells from a generator of its own: whatever
/// is injected, the other random draws of the unit stay the same.
#[derive(Debug)]
pub struct Faults {
    modes: Vec<Injected>,
    random: Random,
    rims: Speed,
}

#[derive(Debug)]
struct Injected {
    place: Place,
    effect: Effect,
    occurs: OccurrenceState,
    random: Random,
    acts: Option<Effect>,
}

impl Faults {
    /// Faults that begin at their onset.
    pub fn new(modes: &[FaultMode], seed: u64) -> Self {
        let mut random = Random::new(seed);
        let modes = modes.iter().map(|mode| {
            let from = Instant::ZERO + Duration::from_secs(mode.onset_s);
            Injected {
                place: mode.place,
                effect: mode.effect,
                occurs: OccurrenceState::new(mode.occurs, from),
                random: Random::new(random.bits()),
                acts: None,
            }
        });
        let modes = modes.collect();
        Self {
            modes,
            random,
            rims: Speed::ZERO,
        }
    }

    /// Moves on to the present, counted from the first power-up.
    pub fn step(&mut self, now: Instant) {
        for mode in &mut self.modes {
            let random = &mut mode.random;
            let strength = mode.occurs.step(now, self.rims, &mut || random.unit());
            mode.acts = mode.effect.at_strength(strength);
        }
    }

    /// Takes the way that the wheels turned in a scan, m.
    pub fn roll(&mut self, metres: f64) {
        let share = SCAN.as_secs() / FELT_OVER.as_secs();
        let mps = metres / SCAN.as_secs();
        self.rims = Speed::from_mps(self.rims.mps() + (mps - self.rims.mps()) * share);
    }

    pub fn at(&self, place: Place) -> Option<Effect> {
        let mut here = self.modes.iter().filter(|mode| mode.place == place);
        here.find_map(|mode| mode.acts)
    }

    /// Factor of a gain at `place`, 1 without one.
    pub fn gain(&self, place: Place) -> f64 {
        match self.at(place) {
            Some(Effect::Gain { factor }) => factor,
            _ => 1.0,
        }
    }

    /// True with probability `p`.
    pub fn chance(&mut self, p: f64) -> bool {
        self.random.chance(p)
    }

    /// Whether nothing works at a place now.
    pub fn dead(&self, place: Place) -> bool {
        matches!(self.at(place), Some(Effect::Dead))
    }

    /// A frame or pulse passing `place` is lost.
    pub fn loses(&mut self, place: Place) -> bool {
        match self.at(place) {
            Some(Effect::Dead) => true,
            Some(Effect::BitErrors { rate }) => self.chance(rate),
            _ => false,
        }
    }
}

/// Probability of an event in one scan, of a Poisson process of `per_s`.
pub fn one_in_scan(per_s: f64) -> f64 {
    per_s * SCAN.as_secs()
}

#[cfg(test)]
pub(crate) mod tests {
    use protocol::injection::Occurrence;

    use super::*;

    /// A fault of some part, from power-up on.
    pub fn fault(place: Place, effect: Effect, occurs: Occurrence) -> FaultMode {
        FaultMode {
            id: "a.b".into(),
            lru: protocol::LruId::from_static("a"),
            mode: "m".into(),
            severity: "major".into(),
            weight: 1.0,
            unsafe_: false,
            place,
            effect,
            out_of_reach: None,
            onset_s: 0.0,
            car: None,
            occurs,
            levels: Vec::new(),
        }
    }

    #[test]
    fn a_loose_contact_acts_while_the_wheels_turn_fast() {
        let loose = Occurrence::AboveSpeed { kmh: 40.0 };
        let mut faults = Faults::new(&[fault(Place::AtpAntenna, Effect::Dead, loose)], 1);
        let mut acts_at = |kmh: f64| {
            for i in 0..200u64 {
                faults.roll(kmh / 3.6 * SCAN.as_secs());
                faults.step(Instant::from_ms(10 * i));
            }
            faults.at(Place::AtpAntenna).is_some()
        };
        assert_eq!(
            [30.0, 42.0, 38.0, 30.0].map(&mut acts_at),
            [false, true, true, false]
        );
    }

    #[test]
    fn a_second_fault_does_not_change_the_spells_of_the_first() {
        let (on_s, off_s) = (0.5, 1.0);
        let at_times = |place| fault(place, Effect::Dead, Occurrence::AtTimes { on_s, off_s });
        let (at_times, other) = (at_times(Place::AtpAntenna), at_times(Place::Tra));
        let spells = |modes: &[FaultMode]| -> Vec<bool> {
            let mut faults = Faults::new(modes, 7);
            let at = |i: u64| {
                faults.step(Instant::from_ms(10 * i));
                faults.at(Place::AtpAntenna).is_some()
            };
            (0..3_000).map(at).collect()
        };
        let alone = spells(core::slice::from_ref(&at_times));
        assert_eq!(alone, spells(&[at_times, other]));
    }
}
