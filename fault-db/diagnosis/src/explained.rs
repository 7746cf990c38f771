//! Which of what a run showed the faults that it was found to have explain: consequences of one cause, each by the
//! part that it comes from.

use std::collections::BTreeSet;

use protocol::{LruId, Verdict};

use super::belief::Belief;
use super::model::Hypothesis;
use super::observation::{CheckName, Observation, Sign};
use super::weights::Weights;

/// A part that was found, and what it explains of the run.
#[derive(Clone, Debug, PartialEq)]
pub struct Cause {
    pub lru: LruId,
    /// Probability that it has failed.
    pub probability: f64,
    /// Signs that its fault shows.
    pub signs: BTreeSet<Sign>,
    /// Checks that its fault makes fail.
    pub checks: BTreeSet<CheckName>,
}

/// The parts that were found, each with what it explains; none unless one part or two are found. What two parts show
/// is the one's that shows it more often.
pub fn causes(belief: &Belief<'_, '_>, weights: &Weights, seen: &Observation) -> Vec<Cause> {
    let mut causes = found(weights, belief.model.settings.found_at);
    if causes.is_empty() {
        return causes;
    }
    let effects = causes
        .iter()
        .map(|cause| effects_of(belief, weights, &cause.lru));
    let effects: Vec<Vec<(usize, f64)>> = effects.collect();
    let model = belief.model;
    // The part whose fault shows it most often, if it is often enough.
    let explaining = |share: &dyn Fn(usize) -> f64| {
        let of_part = |effects: &Vec<(usize, f64)>| share_under(effects, share);
        let shares = effects.iter().map(of_part).enumerate();
        let (place, share) = shares.max_by(|a, b| a.1.total_cmp(&b.1))?;
        (share >= model.settings.conclusion.explained_at).then_some(place)
    };
    for sign in belief.signs().in_steps.union(&belief.signs().in_log) {
        if let Some(place) = explaining(&|effect| model.share_of_sign(effect, sign)) {
            causes[place].signs.insert(sign.clone());
        }
    }
    for weighed in belief.steps() {
        let step = &seen.steps[weighed.seen];
        if step.result == Verdict::Passed {
            continue;
        }
        // A check may fail under several faults; what it measured tells which.
        let values = |effect| model.likelihood_of_values(effect, weighed.place, step);
        let likeliest = (0..model.effects().len()).map(values);
        let likeliest = likeliest.fold(f64::MIN_POSITIVE, f64::max);
        let share = |effect| {
            let counted = model.expected(model.effects()[effect], weighed.place);
            counted.share(counted.cell.count(step.result)) * values(effect) / likeliest
        };
        if let Some(place) = explaining(&share) {
            causes[place].checks.insert(step.check.clone());
        }
    }
    causes
}

/// Other parts that signs name, where no fault of this part shows the signs.
pub fn named_beside(belief: &Belief<'_, '_>, weights: &Weights, part: &LruId) -> BTreeSet<LruId> {
    let model = belief.model;
    let effects = effects_of(belief, weights, part);
    let is_shown = |sign: &Sign| {
        let share = share_under(&effects, |effect| model.share_of_sign(effect, sign));
        share >= model.settings.conclusion.explained_at
    };
    let shown = belief.signs().in_steps.union(&belief.signs().in_log);
    let others = shown.filter(|sign| !is_shown(sign)).filter_map(|sign| {
        let other = sign.lru.as_ref()?;
        (other != part).then(|| other.clone())
    });
    let deviated = belief.residuals().iter();
    let elsewhere = deviated.filter(|signal| !model.deviates_with(part, signal));
    let of_signals = elsewhere.filter_map(|signal| model.likeliest_of(signal).cloned());
    others.chain(of_signals).collect()
}

/// The parts that were found, without what they explain.
fn found(weights: &Weights, found_at: f64) -> Vec<Cause> {
    let failed = weights.failed(found_at).into_iter();
    let causes = failed.map(|(lru, probability)| Cause {
        lru: lru.clone(),
        probability,
        signs: BTreeSet::new(),
        checks: BTreeSet::new(),
    });
    causes.collect()
}

/// The effects that the fault of a part may have, each with its weight; together 1. A fault that was not seen yet has
/// the one that it most likely acts like.
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

/// Share of the runs that show something, under effects with their weights, where `share` is that of one effect.
fn share_under(effects: &[(usize, f64)], share: impl Fn(usize) -> f64) -> f64 {
    let shares = effects
        .iter()
        .map(|(effect, weight)| weight * share(*effect));
    shares.sum()
}
