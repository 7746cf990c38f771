//! Which runs a campaign makes: fault modes at all their levels, with different onset times, on different
//! units.

use diagnosis::Shared;
use protocol::LruId;
use protocol::Random;
use protocol::injection::{Effect, FaultKind, FaultMode};

use serde_json::json;

use super::Request;
use crate::data::sha256;

/// Runs of good units for each seed of a mode: with five seeds enough to see what one good run in twenty does.
const HEALTHY_RUNS_A_SEED: u32 = 12;
/// Seeds of an intermittent mode for each seed of another: what it hits is another check each time.
const INTERMITTENT_SEEDS: u32 = 4;
/// A fault is there from the beginning for every other seed; for the rest it sets in within this time after
/// the first power-up of the run, s.
const LATEST_ONSET_S: f64 = 20.0;
/// Distance between the first seeds of two purposes, so that no seed is ever used twice.
const APART: u64 = 100_000_000;
/// Distance between the first seeds of two levels.
const LEVEL: u64 = 10_000;
/// First seeds of good units, and of units with two faults (`PAIRS`): beyond the seeds of all levels.
const GOOD: u64 = APART / 2;
const PAIRS: u64 = APART / 4 * 3;
/// First seed of units with one cause at several parts.
const COMMON: u64 = APART / 16 * 15;
/// Most draws in search of two faults of different parts, which takes far fewer.
const MOST_TRIES: u32 = 1000;

/// What a run is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Counted in the dictionary.
    Dictionary,
    /// Kept out of the dictionary, to see what it is worth.
    Assessment,
    /// Kept out of the dictionary, to see what it is worth for one cause at several parts.
    CommonCause,
}

/// One run of the suite.
#[derive(Clone, Debug)]
pub struct Sample {
    pub purpose: Purpose,
    /// The faults, each at its level: none in a good unit, most often one.
    pub faults: Vec<FaultMode>,
    /// When the faults set in, s after the first power-up; a fault that has set in is there at the next power-up.
    pub sets_in_s: f64,
    /// The shared part to replace, where all faults are effects of it at other parts.
    pub cause: Option<LruId>,
    /// Level of the fault's mode, 0 = nominal; 0 where there is not one fault alone.
    pub level: usize,
    /// Seed of everything random.
    pub seed: u64,
}

impl Sample {
    /// Name of the run: SHA-256 of all that decides its results, besides program and scripts.
    pub fn name(&self) -> String {
        let Self {
            faults,
            sets_in_s,
            seed,
            purpose: _,
            cause: _,
            level: _,
        } = self;
        sha256(&json!({ "faults": faults, "sets_in_s": sets_in_s, "seed": seed }).to_string())
    }

    /// The fault of a run with one fault alone.
    pub fn fault(&self) -> Option<&FaultMode> {
        match &self.faults[..] {
            [fault] => Some(fault),
            _ => None,
        }
    }

    /// Names of the modes of all faults, in one text.
    pub fn modes(&self) -> String {
        let names: Vec<_> = self.faults.iter().map(|fault| fault.id.as_str()).collect();
        names.join(" and ")
    }

    /// Name of the fault's mode, in a run with one fault alone.
    pub fn mode(&self) -> Option<&str> {
        self.fault().map(|fault| fault.id.as_str())
    }
}

/// All runs of a campaign: those of a dictionary first.
pub fn samples(modes: &[&FaultMode], shared: &[Shared], asked: &Request) -> Vec<Sample> {
    let purposes = [
        (
            Purpose::Dictionary,
            asked.seeds,
            HEALTHY_RUNS_A_SEED * asked.seeds,
        ),
        (Purpose::Assessment, asked.held_out, asked.good),
    ];
    let mut samples = Vec::new();
    let mut from = 2 * APART * u64::from(asked.units);
    for (purpose, seeds, good) in purposes {
        from += APART;
        samples.extend((0..good).map(|i| Sample {
            purpose,
            faults: Vec::new(),
            sets_in_s: 0.0,
            cause: None,
            level: 0,
            seed: from + GOOD + u64::from(i),
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
                        faults: vec![mode.at_level(level)?],
                        sets_in_s: sets_in(mode, i),
                        cause: None,
                        level,
                        // Each level has units of its own: what a few units have in common would look like an effect of
                        // the fault.
                        seed: from + LEVEL * number + u64::from(i),
                    })
                }));
            }
        }
    }
    samples.extend((0..asked.pairs).filter_map(|i| pair(modes, from + PAIRS + u64::from(i))));
    let common =
        (0..asked.common).filter_map(|i| common(modes, shared, from + COMMON + u64::from(i)));
    samples.extend(common);
    samples
}

/// A unit with two faults of different parts, drawn by its seed; none where the modes are of one part.
fn pair(modes: &[&FaultMode], seed: u64) -> Option<Sample> {
    let mut random = Random::new(seed);
    let mut draw = || {
        let mode = modes.get(random.below(modes.len()))?;
        mode.at_level(random.below(1 + mode.levels.len()))
    };
    let two = |_| Some([draw()?, draw()?]);
    let faults = (0..MOST_TRIES)
        .filter_map(two)
        .find(|[one, other]| one.lru != other.lru)?;
    Some(Sample {
        purpose: Purpose::Assessment,
        faults: faults.into(),
        sets_in_s: 0.0,
        cause: None,
        level: 0,
        seed,
    })
}

/// A unit with a shared part that acts at two to four of the parts it reaches, drawn by its seed: at each a mode that a
/// supply or a link may cause, all with the same occurrence. `None` where too few of these parts have modes.
fn common(modes: &[&FaultMode], shared: &[Shared], seed: u64) -> Option<Sample> {
    let mut random = Random::new(seed);
    let modes: Vec<_> = modes
        .iter()
        .filter(|mode| may_have_outer_cause(mode))
        .collect();
    // A shared part that reaches more modes is drawn more often.
    let drawn = |random: &mut Random| {
        let part = &modes.get(random.below(modes.len()))?.lru;
        let all = shared.iter();
        let reaching: Vec<_> = all.filter(|shared| shared.reaches.contains(part)).collect();
        reaching.get(random.below(reaching.len().max(1))).copied()
    };
    let cause = (0..MOST_TRIES).find_map(|_| drawn(&mut random))?;
    let places = 2 + random.below(3);
    let mut faults: Vec<FaultMode> = Vec::new();
    for _ in 0..MOST_TRIES {
        let mode = modes.get(random.below(modes.len()))?;
        let new = faults
            .iter()
            .all(|fault| fault.lru != mode.lru && fault.place != mode.place);
        if faults.len() < places && new && cause.reaches.contains(&mode.lru) {
            let mut fault = mode.at_level(random.below(1 + mode.levels.len()))?;
            if let Some(first) = faults.first() {
                fault.occurs = first.occurs;
            }
            faults.push(fault);
        }
    }
    (faults.len() > 1).then(|| Sample {
        purpose: Purpose::CommonCause,
        faults,
        sets_in_s: 0.0,
        cause: Some(cause.part.clone()),
        level: 0,
        seed,
    })
}

/// Whether a cause outside the part may make the part act so: nothing, less, or something else comes through. A guard
/// that is lost in a part's own program is that part's fault.
fn may_have_outer_cause(mode: &FaultMode) -> bool {
    let outer = matches!(
        mode.effect,
        Effect::Dead | Effect::Gain { .. } | Effect::Noise { .. } | Effect::BitErrors { .. }
    );
    outer && !mode.unsafe_ && !mode.place.is_stored()
}

/// When the mode sets in for the seed with this number, s.
fn sets_in(mode: &FaultMode, number: u32) -> f64 {
    if number.is_multiple_of(2) || mode.place.is_stored() {
        return 0.0;
    }
    // The golden ratio's multiples spread evenly however many there are.
    (f64::from(number) * 0.618_033_988_749_895).fract() * LATEST_ONSET_S
}
