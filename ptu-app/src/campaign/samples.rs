//! What is run in a campaign: fault modes at all their levels, setting in at different times, on units
//! that differ; and good units.

use protocol::injection::FaultMode;

use super::Request;

/// Good runs behind a dictionary for each seed of a mode: at five seeds enough that what one in twenty of
/// them does is seen.
const HEALTHY_RUNS_A_SEED: u32 = 12;
/// A fault sets in at power-up for every other seed, and within this time after it for the rest, s.
const LATEST_ONSET_S: f64 = 10.0;
/// Seeds of one purpose are this far from those of the next, so that none is ever used twice.
const APART: u64 = 100_000_000;
/// And those of one variety this far from those of the next.
const VARIETY: u64 = 10_000;

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
    /// The fault, at its level and with its onset; none = a good unit.
    pub fault: Option<FaultMode>,
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
            level: 0,
            seed: from + APART / 2 + u64::from(i),
        }));
        let mut variety = 0;
        for mode in modes {
            for level in 0..=mode.levels.len() {
                variety += 1;
                samples.extend((0..seeds).filter_map(|i| {
                    Some(Sample {
                        purpose,
                        fault: Some(setting_in(mode.at_level(level)?, i)),
                        level,
                        // Units of their own for each variety: of the same few, what they have in common would
                        // look like the fault's doing.
                        seed: from + VARIETY * variety + u64::from(i),
                    })
                }));
            }
        }
    }
    samples
}

/// The mode as it sets in for the seed with this number: at its own time, or later by a part of
/// [`LATEST_ONSET_S`] that differs from seed to seed.
fn setting_in(mut mode: FaultMode, number: u32) -> FaultMode {
    if number % 2 == 1 && !mode.place.is_stored() {
        // The golden ratio's multiples spread evenly however many there are.
        let share = (f64::from(number) * 0.618_033_988_749_895).fract();
        mode.onset_s += share * LATEST_ONSET_S;
    }
    mode
}
