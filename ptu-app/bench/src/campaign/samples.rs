//! Which runs a campaign makes: fault modes at all their levels, with different onset times, on different
//! units.

use protocol::injection::{FaultKind, FaultMode};

use super::Request;

/// Good runs behind a dictionary for each seed of a mode: at five seeds enough that what one in twenty of
/// them does is seen.
const HEALTHY_RUNS_A_SEED: u32 = 12;
/// Seeds for one of a mode that comes and goes: what it hits is another check each time.
const INTERMITTENT_SEEDS: u32 = 4;
/// A fault is there from the beginning for every other seed; for the rest it sets in within this time after
/// the first power-up of the run, s.
const LATEST_ONSET_S: f64 = 20.0;
/// Seeds of one purpose are this far from those of the next, so that none is ever used twice.
const APART: u64 = 100_000_000;
/// And those of one level this far from those of the next.
const LEVEL: u64 = 10_000;

/// What a run is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Counted in the dictionary.
    Dictionary,
    /// Kept out of it, to see what it is worth.
    Assessment,
}

/// One run of the suite.
#[derive(Clone, Debug)]
pub struct Sample {
    /// What it is for.
    pub purpose: Purpose,
    /// The fault at its level; none = a good unit.
    pub fault: Option<FaultMode>,
    /// When it sets in, s after the first power-up; what has set in is there at the next one.
    pub sets_in_s: f64,
    /// Which of the mode's levels, 0 = nominal.
    pub level: usize,
    /// Seed of everything random.
    pub seed: u64,
}

impl Sample {
    /// Name of its fault mode.
    pub fn mode(&self) -> Option<&str> {
        self.fault.as_ref().map(|fault| fault.id.as_str())
    }
}

/// All runs of a campaign: those of a dictionary first.
pub fn samples(modes: &[&FaultMode], asked: &Request) -> Vec<Sample> {
    let purposes = [
        (
            Purpose::Dictionary,
            asked.seeds,
            HEALTHY_RUNS_A_SEED * asked.seeds,
            APART,
        ),
        (Purpose::Assessment, asked.held_out, asked.good, 2 * APART),
    ];
    let mut samples = Vec::new();
    for (purpose, seeds, good, from) in purposes {
        samples.extend((0..good).map(|i| Sample {
            purpose,
            fault: None,
            sets_in_s: 0.0,
            level: 0,
            seed: from + APART / 2 + u64::from(i),
        }));
        let mut number = 0;
        for mode in modes {
            for level in 0..=mode.levels.len() {
                number += 1;
                let intermittent = mode.kind() == FaultKind::Intermittent;
                let seeds = match (purpose, intermittent) {
                    (Purpose::Dictionary, true) => INTERMITTENT_SEEDS * seeds,
                    _ => seeds,
                };
                samples.extend((0..seeds).filter_map(|i| {
                    Some(Sample {
                        purpose,
                        fault: Some(mode.at_level(level)?),
                        sets_in_s: sets_in(mode, i),
                        level,
                        // Units of their own for each level: of the same few, what they have in common would
                        // look like the fault's doing.
                        seed: from + LEVEL * number + u64::from(i),
                    })
                }));
            }
        }
    }
    samples
}

/// When the mode sets in for the seed with this number, s.
fn sets_in(mode: &FaultMode, number: u32) -> f64 {
    if number.is_multiple_of(2) || mode.place.is_stored() {
        return 0.0;
    }
    // The golden ratio's multiples spread evenly however many there are.
    (f64::from(number) * 0.618_033_988_749_895).fract() * LATEST_ONSET_S
}
