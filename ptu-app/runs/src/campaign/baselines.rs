//! Two yardsticks that read the same counts, verdicts and signs alone: what a diagnosis has to be better than.

use std::collections::{BTreeMap, BTreeSet};

use diagnosis::{Column, Dictionary, Observation};
use protocol::{LruId, Verdict};

use super::evaluate::Share;
use super::samples::Sample;
use super::suite::SuiteRun;

/// Neighbours that vote.
const NEIGHBOURS: usize = 5;
/// A part is certain with this share of the votes, or of the probability.
const SURE: f64 = 0.95;

/// How often the right part comes first, and a wrong one for certain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Baseline {
    pub first: Share,
    pub wrong: Share,
}

/// Nearest neighbours, and naive Bayes.
pub type Baselines = [Baseline; 2];

/// Adds the answers of both yardsticks to each of these runs with a fault, by a dictionary.
pub(super) fn judge(sums: &mut Baselines, dictionary: &Dictionary, runs: &[(&Sample, &SuiteRun)]) {
    let columns: Vec<_> = dictionary
        .modes
        .iter()
        .flat_map(|mode| {
            mode.columns
                .iter()
                .map(|column| (&mode.name.lru, shares(column), column.runs))
        })
        .collect();
    for (sample, run) in runs.iter().filter(|(_, run)| !run.passed) {
        let shown = shown(dictionary, &run.seen);
        let mut near: Vec<(&LruId, f64)> = Vec::new();
        let mut likely: Vec<(&LruId, f64)> = Vec::new();
        for (lru, shares, n) in &columns {
            let (mut distance, mut ln) = (0.0, 0.0);
            for feature in shares
                .keys()
                .chain(shown.iter().filter(|one| !shares.contains_key(*one)))
            {
                let share = shares.get(feature).copied().unwrap_or(0.0);
                let smooth = (share * f64::from(*n) + 0.5) / (f64::from(*n) + 1.0);
                let is_shown = shown.contains(feature);
                distance += if is_shown { 1.0 - share } else { share };
                ln += if is_shown {
                    smooth.ln()
                } else {
                    (1.0 - smooth).ln()
                };
            }
            near.push((lru, distance));
            likely.push((lru, ln));
        }
        near.sort_by(|a, b| a.1.total_cmp(&b.1));
        near.truncate(NEIGHBOURS);
        let greatest = likely
            .iter()
            .map(|(_, ln)| *ln)
            .fold(f64::NEG_INFINITY, f64::max);
        let votes = near.into_iter().map(|(lru, _)| (lru, 1.0));
        let weights = likely
            .into_iter()
            .map(|(lru, ln)| (lru, (ln - greatest).exp()));
        for (sum, (part, share)) in sums.iter_mut().zip([first(votes), first(weights)]) {
            let is_right = part == Some(&sample.faults[0].lru);
            sum.first.count(is_right);
            sum.wrong.count(!is_right && share >= SURE);
        }
    }
}

/// The part with the most weight, and its share of all.
fn first<'a>(all: impl Iterator<Item = (&'a LruId, f64)>) -> (Option<&'a LruId>, f64) {
    let mut parts: BTreeMap<&LruId, f64> = BTreeMap::new();
    all.for_each(|(part, weight)| *parts.entry(part).or_default() += weight);
    let sum: f64 = parts.values().sum();
    let first = parts.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
    first.map_or((None, 0.0), |(part, weight)| (Some(part), weight / sum))
}

/// How often a mode's level fails each check and shows each sign.
fn shares(column: &Column) -> BTreeMap<String, f64> {
    let cells = column.cells.iter();
    let failed = cells.map(|(place, cell)| (place.to_string(), cell.not_passed()));
    let signs = column.signs.iter().map(|(sign, count)| {
        let share = f64::from(*count) / f64::from(column.runs.max(1));
        (String::from(sign.clone()), share)
    });
    failed.chain(signs).collect()
}

/// The checks that failed, and the signs that showed.
fn shown(dictionary: &Dictionary, seen: &Observation) -> BTreeSet<String> {
    let failed = seen
        .steps
        .iter()
        .filter(|step| step.result != Verdict::Passed);
    let failed = failed.filter_map(|step| Some(dictionary.place(&step.check)?.to_string()));
    let signs = seen.steps.iter().flat_map(|step| &step.signs);
    failed
        .chain(signs.map(|sign| String::from(sign.clone())))
        .collect()
}
