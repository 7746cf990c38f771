//! The parts that scripts suspect: each check may name the part that it judges, so the failed checks of a run point at
//! parts. The parts at which the modes of a part point are counted; a mode that was not seen yet points at its own
//! part, or where the counted modes of that part point.

use std::collections::BTreeMap;

use protocol::{LruId, Verdict};

use super::dictionary::{Column, Dictionary};
use super::logarithms::normalised;
use super::observation::ObservedStep;

/// Assumed modes of a part, added to those counted; half of their weight points at the part itself.
const ASSUMED_MODES: f64 = 2.0;
/// Least probability of a suspect.
const LEAST: f64 = 1e-3;

/// The part that a check names; `None` if the check names none.
type Suspect = Option<LruId>;

/// Number of failed checks, by the part that they suspect.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Suspicion {
    failed: BTreeMap<Suspect, f64>,
}

impl Suspicion {
    /// Adds a step, whose check is at `place`.
    pub fn see(&mut self, dictionary: &Dictionary, place: usize, step: &ObservedStep) {
        if step.result != Verdict::Passed {
            self.add(dictionary, place, 1.0);
        }
    }

    /// The failed checks of a mode at one level, on average over its runs.
    fn of(dictionary: &Dictionary, column: &Column) -> Self {
        let mut suspicion = Self::default();
        for (place, cell) in &column.cells {
            suspicion.add(dictionary, *place, cell.not_passed());
        }
        suspicion
    }

    fn add(&mut self, dictionary: &Dictionary, place: usize, count: f64) {
        if count > 0.0 {
            let suspect = dictionary.suspects.get(place).cloned().flatten();
            *self.failed.entry(suspect).or_default() += count;
        }
    }

    fn shares(&self) -> impl Iterator<Item = (&Suspect, f64)> {
        let all: f64 = self.failed.values().sum();
        let failed = self.failed.iter();
        failed.map(move |(suspect, count)| (suspect, count / all))
    }
}

/// The parts that failed checks suspect under the faults of each part.
#[derive(Debug)]
pub struct Suspects {
    /// For each part, in order, the probability of each suspect.
    of_parts: Vec<BTreeMap<Suspect, f64>>,
}

impl Suspects {
    /// Counts the dictionary's modes.
    pub fn new(dictionary: &Dictionary, parts: &[&LruId]) -> Self {
        let named = parts.iter().map(|part| Some((*part).clone()));
        let mut of_all: BTreeMap<Suspect, f64> = BTreeMap::new();
        for suspect in dictionary.suspects.iter().cloned().chain(named) {
            *of_all.entry(suspect).or_default() += 1.0;
        }
        normalise(&mut of_all);
        let of_part = |part: &&LruId| {
            let assumed = of_all.iter().map(|(suspect, share)| {
                let own = f64::from(suspect.as_ref() == Some(part));
                (suspect.clone(), ASSUMED_MODES * (share + own) / 2.0)
            });
            let mut counts: BTreeMap<_, f64> = assumed.collect();
            let modes = dictionary.modes.iter();
            for mode in modes.filter(|mode| mode.name.lru == **part) {
                for column in &mode.columns {
                    for (suspect, share) in Suspicion::of(dictionary, column).shares() {
                        let count = counts.entry(suspect.clone()).or_default();
                        *count += share / mode.columns.len() as f64;
                    }
                }
            }
            normalise(&mut counts);
            counts
        };
        Self {
            of_parts: parts.iter().map(of_part).collect(),
        }
    }

    /// Logarithm of the likelihood of the suspects seen, under an unseen mode of each part, relative to the mean over
    /// the parts. The failed checks of a run depend on each other, so all of them count as one check.
    pub fn ln(&self, seen: &Suspicion) -> Vec<f64> {
        let of_part = |table: &BTreeMap<Suspect, f64>| {
            let of_each = seen.shares().map(|(suspect, share)| {
                let chance = table.get(suspect).copied().unwrap_or(0.0);
                share * chance.max(LEAST).ln()
            });
            of_each.sum()
        };
        let shares = normalised(&self.of_parts.iter().map(of_part).collect::<Vec<f64>>());
        let parts = shares.len() as f64;
        shares
            .into_iter()
            .map(|share| (share * parts).ln())
            .collect()
    }
}

fn normalise(counts: &mut BTreeMap<Suspect, f64>) {
    let all: f64 = counts.values().sum();
    counts.values_mut().for_each(|count| *count /= all);
}
