//! When a fault mode acts: always, intermittently, above a speed, or increasingly as the unit warms up.
//!
//! Unit and bench step the same [`OccurrenceState`] with random numbers that nothing else draws, so that a
//! good twin with the same seed draws the same numbers everywhere else.

use serde::{Deserialize, Serialize};

use crate::{Duration, Instant, Speed};

/// A mode that acts above a speed ends when the wheels are slower than this speed by this share of it.
const HYSTERESIS: f64 = 0.1;

/// When a fault mode acts, once it has begun.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case", tag = "when", deny_unknown_fields)]
pub enum Occurrence {
    /// All the time.
    #[default]
    Always,
    /// In spells of random length with pauses of random length, both exponentially distributed; a
    /// pause comes first.
    AtTimes {
        /// Mean length of a spell, s.
        on_s: f64,
        /// Mean length of a pause, s.
        off_s: f64,
    },
    /// While the wheels turn faster than this speed: a contact that shakes loose.
    AboveSpeed {
        /// Speed at the rims, km/h.
        kmh: f64,
    },
    /// More and more as the unit warms up after power-up. An effect without a number acts from half of the rise on.
    WhenWarm {
        /// Time after power-up at which the rise begins, s.
        after_s: f64,
        /// Time from the begin of the rise to the full effect, s.
        full_s: f64,
    },
}

impl Occurrence {
    /// All the time.
    pub fn is_always(&self) -> bool {
        *self == Self::Always
    }
}

/// State of an occurrence, stepped in each scan.
#[derive(Clone, Debug)]
pub struct OccurrenceState {
    occurs: Occurrence,
    from: Instant,
    acts: bool,
    changes_at: Option<Instant>,
}

impl OccurrenceState {
    /// Begins at `from`, counted from power-up like all times here.
    pub fn new(occurs: Occurrence, from: Instant) -> Self {
        Self {
            occurs,
            from,
            acts: false,
            changes_at: None,
        }
    }

    /// How much of the mode acts now, 0 to 1. `draw` gives numbers uniform in 0 .. 1 and is asked only
    /// when a spell or pause begins.
    pub fn step(&mut self, now: Instant, rims: Speed, draw: &mut impl FnMut() -> f64) -> f64 {
        if now < self.from {
            return 0.0;
        }
        match self.occurs {
            Occurrence::Always => 1.0,
            Occurrence::AtTimes { on_s, off_s } => {
                let pause = || self.from + lasts(off_s, draw());
                let changes_at = self.changes_at.get_or_insert_with(pause);
                // At most one change a scan: a shorter spell or pause lasts a scan.
                if now >= *changes_at {
                    self.acts = !self.acts;
                    *changes_at = now + lasts(if self.acts { on_s } else { off_s }, draw());
                }
                whole(self.acts)
            }
            Occurrence::AboveSpeed { kmh } => {
                let least = if self.acts {
                    kmh * (1.0 - HYSTERESIS)
                } else {
                    kmh
                };
                self.acts = rims.kmh() > least;
                whole(self.acts)
            }
            Occurrence::WhenWarm { after_s, full_s } => {
                let warm_s = now.since(Instant::ZERO).as_secs() - after_s;
                if warm_s < 0.0 {
                    0.0
                } else if warm_s >= full_s {
                    1.0
                } else {
                    warm_s / full_s
                }
            }
        }
    }
}

fn whole(acts: bool) -> f64 {
    f64::from(acts)
}

/// Exponentially distributed time of this mean.
fn lasts(mean_s: f64, draw: f64) -> Duration {
    Duration::from_secs(-libm::log(1.0 - draw.clamp(0.0, 0.999_999)) * mean_s)
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use super::*;

    /// Strength each 10 ms up to `end_s`, at this speed.
    fn course(occurs: Occurrence, end_s: u64, kmh: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut state = OccurrenceState::new(occurs, Instant::ZERO);
        let mut seed = 1u64;
        let mut draw = || {
            // Numerical Recipes' LCG; the high bits are good enough here.
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..end_s * 100)
            .map(|i| {
                let now = Instant::from_ms(10 * i);
                let rims = Speed::from_kmh(kmh(i as f64 / 100.0));
                state.step(now, rims, &mut draw)
            })
            .collect()
    }

    #[test]
    fn spells_and_pauses_have_their_means() {
        let occurs = Occurrence::AtTimes {
            on_s: 1.5,
            off_s: 8.0,
        };
        let strengths = course(occurs, 50_000, |_| 0.0);
        let begun = strengths.windows(2).filter(|w| w[0] < w[1]).count() as f64;
        let on_s = strengths.iter().sum::<f64>() / 100.0 / begun;
        assert_eq!(strengths[0], 0.0, "a pause comes first");
        assert!((begun - 50_000.0 / 9.5).abs() < 200.0, "{begun} spells");
        assert!((on_s - 1.5).abs() < 0.06, "{on_s} s");
    }

    #[test]
    fn a_fault_by_speed_acts_above_its_speed_and_on_to_a_little_below() {
        let occurs = Occurrence::AboveSpeed { kmh: 40.0 };
        let strengths = course(occurs, 100, |t| if t < 50.0 { t } else { 100.0 - t });
        let at = |kmh: usize| (strengths[kmh * 100], strengths[10_000 - kmh * 100]);
        assert_eq!(at(39), (0.0, 1.0));
        assert_eq!(at(41), (1.0, 1.0));
        assert_eq!(at(35), (0.0, 0.0));
    }

    #[test]
    fn warmth_rises_from_its_beginning_to_the_whole() {
        let occurs = Occurrence::WhenWarm {
            after_s: 10.0,
            full_s: 20.0,
        };
        let strengths = course(occurs, 60, |_| 0.0);
        assert_eq!(
            [5, 10, 20, 30, 50].map(|s| strengths[s * 100]),
            [0.0, 0.0, 0.5, 1.0, 1.0]
        );
        let at_once = Occurrence::WhenWarm {
            after_s: 1.0,
            full_s: 0.0,
        };
        assert_eq!(course(at_once, 2, |_| 0.0)[100], 1.0);
    }

    #[test]
    fn no_fault_acts_before_its_onset() {
        let mut state = OccurrenceState::new(Occurrence::Always, Instant::from_ms(3_000));
        let mut at = |ms| state.step(Instant::from_ms(ms), Speed::ZERO, &mut || 0.5);
        assert_eq!([at(2_990), at(3_000)], [0.0, 1.0]);
    }
}
