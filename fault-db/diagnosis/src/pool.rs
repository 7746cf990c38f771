//! How likely each part is, whether its fault was counted or not.
//!
//! Bayes' rule finds a fault that the dictionary has counted. About a fault that nobody has counted the rule is too
//! sure, as such a fault may act like one of another part. There the logarithm of a part's posterior counts only with a
//! weight below 1 and down to a limit, beside what points at a part whatever its faults do: which parts make the
//! signals that deviate first, which parts signs and failed checks name, and which parts are in a row with the
//! likeliest. This is a log-linear pool (Genest and Zidek 1986), with the weights of a conditional logit (McFadden
//! 1974) over runs of modes that were left out. Both answers are mixed by how well the run fits the counts.

use std::collections::{BTreeMap, BTreeSet};

use protocol::{LruId, Verdict};

use super::belief::{Belief, WeighedStep};
use super::common::gains;
use super::counted::Misfit;
use super::groups::Shared;
use super::logarithms::normalised;
use super::model::{FIRST_EFFECT, Model};
use super::observation::Observation;

/// A part with at least this share of the likeliest part's probability counts as equally likely.
const AS_LIKELY: f64 = 0.5;

/// All evidence for each part.
pub struct Pooled {
    /// Probability, by part in the model's order, that this part has failed, given that one has; together 1.
    pub shares: Vec<f64>,
    /// Probability that the fault is one that was counted.
    pub counted: f64,
    /// Shared parts that may be the one cause at several parts.
    pub causes: BTreeSet<LruId>,
}

impl Pooled {
    /// Pools the evidence of a run that shows a fault; `ln` has the logarithms of its hypotheses' probabilities.
    pub fn of(belief: &Belief<'_, '_>, seen: &Observation, ln: &[f64]) -> Self {
        let settings = &belief.model.settings;
        let posterior = of_parts(belief.model, ln);
        let mut scores = scores(belief, seen, &posterior);
        let causes = causes(belief, seen);
        let greatest = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        for (score, part) in scores.iter_mut().zip(belief.model.parts()) {
            if causes.contains(*part) {
                *score = score.max(greatest - settings.pool.below_first);
            }
        }
        let counted =
            Misfit::of(belief, seen, ln).map_or(0.0, |fit| fit.counted(&settings.counted));
        let not_counted = normalised(&scores);
        let mixed = posterior.iter().zip(not_counted);
        Self {
            shares: mixed
                .map(|(known, new)| counted * known + (1.0 - counted) * new)
                .collect(),
            counted,
            causes,
        }
    }
}

/// Score of each part, a logarithm of odds, for the case that its fault was not counted.
fn scores(belief: &Belief<'_, '_>, seen: &Observation, posterior: &[f64]) -> Vec<f64> {
    let model = belief.model;
    let pool = &model.settings.pool;
    let greatest = posterior.iter().copied().fold(0.0, f64::max);
    let likely = model.parts().iter().zip(posterior);
    let likely: Vec<_> = likely
        .filter(|(_, p)| **p >= AS_LIKELY * greatest)
        .collect();
    let deviating = shares(belief.residuals().iter().map(Some));
    let signs = shares(belief.signs().all().map(|sign| sign.lru.as_ref()));
    let is_failed = |step: &&WeighedStep| seen.steps[step.seen].result != Verdict::Passed;
    let failed = belief.steps().iter().filter(is_failed);
    let suspects = &model.dictionary.suspects;
    let suspects = shares(failed.map(|step| suspects.get(step.place)?.as_ref()));
    let score = |(part, posterior): (&&LruId, &f64)| {
        let made = deviating.iter();
        let made = made.filter(|(signal, _)| model.relations.makes(part, signal));
        let made: f64 = made.map(|(_, share)| share).sum();
        let named = |shares: &BTreeMap<&LruId, f64>| shares.get(part).copied().unwrap_or(0.0);
        let mut likely = likely.iter().map(|(likely, _)| *likely);
        let is_near = likely.any(|likely| likely == part || model.relations.are_near(likely, part));
        pool.posterior * posterior.ln().max(-pool.limit)
            + pool.deviates * made
            + pool.signs * named(&signs)
            + pool.suspects * named(&suspects)
            + pool.near * f64::from(is_near)
    };
    model.parts().iter().zip(posterior).map(score).collect()
}

/// Shared parts that may be the cause at several of the parts they reach: signs name two of these, or effects of two of
/// these explain the run better than any one effect.
fn causes(belief: &Belief<'_, '_>, seen: &Observation) -> BTreeSet<LruId> {
    let model = belief.model;
    let named: BTreeSet<&LruId> = belief
        .signs()
        .all()
        .filter_map(|sign| sign.lru.as_ref())
        .collect();
    let gains = gains(belief, seen);
    let is_cause = |shared: &&Shared| {
        let reached = shared.reaches.iter().filter(|part| named.contains(part));
        let gain = gains.get(&shared.part).copied().unwrap_or(0.0);
        reached.count() > 1 || gain >= model.settings.pool.common
    };
    let causes = model.relations.shared.iter().filter(is_cause);
    causes.map(|shared| shared.part.clone()).collect()
}

/// The posterior of each part, given that one has failed; the posteriors add up to 1.
fn of_parts(model: &Model<'_>, ln: &[f64]) -> Vec<f64> {
    let faulty = normalised(&ln[FIRST_EFFECT..]);
    let mut parts = vec![0.0; model.parts().len()];
    for (hypothesis, probability) in model.hypotheses[FIRST_EFFECT..].iter().zip(faulty) {
        if let Some(part) = model.part(*hypothesis) {
            parts[part] += probability;
        }
    }
    parts
}

/// For each name, its share of all names.
fn shares<'a, T: Ord>(named: impl Iterator<Item = Option<&'a T>>) -> BTreeMap<&'a T, f64> {
    let mut counts: BTreeMap<&T, f64> = BTreeMap::new();
    for one in named.flatten() {
        *counts.entry(one).or_default() += 1.0;
    }
    let all: f64 = counts.values().sum();
    counts.values_mut().for_each(|count| *count /= all);
    counts
}
