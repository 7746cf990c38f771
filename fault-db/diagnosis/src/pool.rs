//! How likely each part is, whether its fault was counted or not: all evidence pooled.
//!
//! Bayes' rule alone is too sure of itself where a fault that nobody has counted acts like one of another part. So the
//! logarithm of a part's posterior counts with a weight below 1 and to a limit only, a nearer one where the run is not as
//! counted under the likeliest fault, beside what points at a part whatever its faults do: who makes the signals that
//! deviate first, whom signs and failed checks name, and which parts are in a row with the likeliest. It is a log-linear pool (Genest and Zidek 1986), whose weights are those of a conditional logit
//! (McFadden 1974) over runs of modes that were left out.

use std::collections::{BTreeMap, BTreeSet};

use protocol::{LruId, Verdict};

use super::belief::{Belief, WeighedStep, normalised};
use super::common::gains;
use super::groups::Shared;
use super::model::{FIRST_EFFECT, Hypothesis};
use super::observation::Observation;

/// Logarithm of a likelihood ratio that counts as certain.
const CERTAIN: f64 = 20.0;
/// A part is about as likely as the likeliest at this share of its probability.
const AS_LIKELY: f64 = 0.5;

/// All evidence for each part.
pub struct Pooled {
    /// The probability of each part in the model's order, together 1: that it is the one, if one has failed.
    pub shares: Vec<f64>,
    /// Steps that are not as counted under the likeliest fault.
    pub strange: usize,
    /// Parts that may be the cause at several others.
    pub causes: BTreeSet<LruId>,
}

impl Pooled {
    /// Of a run that shows a fault.
    pub fn of(belief: &Belief<'_, '_>, seen: &Observation) -> Self {
        let strange = strange_steps(belief, seen);
        let mut scores = scores(belief, seen, strange == 0);
        let causes = causes(belief, seen);
        let greatest = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        for (score, part) in scores.iter_mut().zip(belief.model.parts()) {
            if causes.contains(*part) {
                *score = score.max(greatest - belief.model.settings.pool.below_first);
            }
        }
        Self {
            shares: normalised(&scores),
            strange,
            causes,
        }
    }
}

/// Logarithm of what speaks for each part.
fn scores(belief: &Belief<'_, '_>, seen: &Observation, is_as_counted: bool) -> Vec<f64> {
    let model = belief.model;
    let pool = &model.settings.pool;
    let (weight, limit) = match is_as_counted {
        true => (pool.counted, CERTAIN),
        false => (pool.otherwise, pool.limit),
    };
    let posterior = of_parts(belief);
    let greatest = posterior.iter().copied().fold(0.0, f64::max);
    let likely = model.parts().iter().zip(&posterior);
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
        let made = deviating.iter().filter(|(signal, _)| {
            let makers = model.relations.makers.get(**signal);
            makers.is_some_and(|makers| makers.contains(*part))
        });
        let made: f64 = made.map(|(_, share)| share).sum();
        let named = |shares: &BTreeMap<&LruId, f64>| shares.get(part).copied().unwrap_or(0.0);
        let mut likely = likely.iter().map(|(likely, _)| *likely);
        let is_near = likely.any(|likely| likely == part || model.relations.are_near(likely, part));
        weight * posterior.ln().max(-limit)
            + pool.deviates * made
            + pool.signs * named(&signs)
            + pool.suspects * named(&suspects)
            + pool.near * f64::from(u8::from(is_near))
    };
    model.parts().iter().zip(&posterior).map(score).collect()
}

/// Parts whose failure may be what is wrong at several of the parts that they reach: signs name two of those, or effects of
/// two explain the run better than any one.
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

/// The posterior of each part, if one has failed.
fn of_parts(belief: &Belief<'_, '_>) -> Vec<f64> {
    let model = belief.model;
    let ln = belief.ln();
    let faulty = normalised(&ln[FIRST_EFFECT..]);
    let mut parts = vec![0.0; model.parts().len()];
    for (hypothesis, probability) in model.hypotheses[FIRST_EFFECT..].iter().zip(faulty) {
        if let Some(part) = model.part(*hypothesis) {
            parts[part] += probability;
        }
    }
    parts
}

/// Steps that end as they seldom did under the likeliest fault that was counted.
fn strange_steps(belief: &Belief<'_, '_>, seen: &Observation) -> usize {
    let model = belief.model;
    let ln = belief.ln();
    let effects = ln[FIRST_EFFECT..].iter().zip(model.effects());
    let likeliest = effects.max_by(|a, b| a.0.total_cmp(b.0));
    let likeliest = likeliest.map_or(Hypothesis::NoFault, |(_, effect)| *effect);
    let is_strange = |place, result| {
        model.expected(likeliest, place).result(result) < model.settings.pool.seldom
    };
    let steps = belief.steps().iter();
    steps
        .filter(|step| is_strange(step.place, seen.steps[step.seen].result))
        .count()
}

/// How often each is named, over all that name one.
fn shares<'a, T: Ord>(named: impl Iterator<Item = Option<&'a T>>) -> BTreeMap<&'a T, f64> {
    let mut counts: BTreeMap<&T, f64> = BTreeMap::new();
    for one in named.flatten() {
        *counts.entry(one).or_default() += 1.0;
    }
    let all: f64 = counts.values().sum();
    counts.values_mut().for_each(|count| *count /= all);
    counts
}
