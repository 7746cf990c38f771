//! What a part's fault explains of a run: the signs and failed checks that are its consequences.

use std::collections::BTreeSet;

use protocol::{LruId, Verdict};

use super::belief::Belief;
use super::model::Hypothesis;
use super::observation::{CheckName, Observation, Sign};
use super::weights::Weights;

/// The likeliest of the parts of which one has failed for certain, with what its fault explains of the run.
#[derive(Clone, Debug, PartialEq)]
pub struct Cause {
    pub lru: LruId,
    /// Probability that the part has failed.
    pub probability: f64,
    /// Signs of the run that the part's fault shows.
    pub signs: BTreeSet<Sign>,
    /// Failed checks of the run that the part's fault makes fail.
    pub checks: BTreeSet<CheckName>,
}

/// The part with a probability above 0.5 among those of which one has failed for certain; `None` if there is none.
pub fn cause(belief: &Belief<'_, '_>, weights: &Weights, seen: &Observation) -> Option<Cause> {
    let model = belief.model;
    let found = weights.set.first().filter(|part| part.probability > 0.5)?;
    let effects = effects_of(belief, weights, &found.lru);
    let is_explained = |share: &dyn Fn(usize) -> f64| {
        let shares = effects
            .iter()
            .map(|(effect, weight)| weight * share(*effect));
        shares.sum::<f64>() >= model.settings.conclusion.explained_at
    };
    let signs = belief.signs().all();
    let signs = signs.filter(|sign| is_explained(&|effect| model.share_of_sign(effect, sign)));
    let failed = belief.steps().iter().filter(|weighed| {
        let step = &seen.steps[weighed.seen];
        if step.result == Verdict::Passed {
            return false;
        }
        // A check may fail under several faults; its measured values tell under which.
        let values = |effect| model.likelihood_of_values(effect, weighed.place, step);
        let likeliest = (0..model.effects().len()).map(values);
        let likeliest = likeliest.fold(f64::MIN_POSITIVE, f64::max);
        let share = |effect| {
            let counted = model.expected(model.effects()[effect], weighed.place);
            counted.share(counted.cell.count(step.result)) * values(effect) / likeliest
        };
        is_explained(&share)
    });
    Some(Cause {
        lru: found.lru.clone(),
        probability: found.probability,
        signs: signs.cloned().collect(),
        checks: failed
            .map(|weighed| seen.steps[weighed.seen].check.clone())
            .collect(),
    })
}

/// The effects that the fault of a part may have, each with its weight; the weights add up to 1. A fault that was not seen
/// yet has the effect that it most likely acts like.
fn effects_of(belief: &Belief<'_, '_>, weights: &Weights, part: &LruId) -> Vec<(usize, f64)> {
    let of_part = |hypothesis: Hypothesis| belief.model.lru(hypothesis) == Some(part);
    let faults = weights
        .faults
        .iter()
        .filter(|fault| of_part(fault.hypothesis));
    let effects = faults.filter_map(|fault| {
        let effect = belief.acts_like(fault.hypothesis)?;
        Some((effect, fault.probability))
    });
    let effects: Vec<(usize, f64)> = effects.collect();
    let all: f64 = effects.iter().map(|(_, p)| p).sum();
    let share = |(effect, p): (usize, f64)| (effect, p / all.max(f64::MIN_POSITIVE));
    effects.into_iter().map(share).collect()
}
