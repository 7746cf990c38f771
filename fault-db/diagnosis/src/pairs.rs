//! Two effects at once: of two faults, or of one that was not seen yet.
//!
//! A check passes under two effects only if it passes under each, and fails if either makes it fail. So a passed check
//! has the lesser of the two likelihoods; any other result is that of one of them.

use protocol::Verdict;

use super::belief::{Belief, normalised};
use super::common::{CommonCause, common_causes};
use super::model::{FIRST_EFFECT, Hypothesis, Model, StepLikelihoods};
use super::observation::{Observation, ObservedStep};
use super::spells::AS_COUNTED;

/// Number of best explaining modes, each of which is combined with all others.
const MOST_EXPLAINING: usize = 12;

/// Pairs that are less likely than this, beside the likeliest single fault, are nowhere seen.
const LEAST_SHARE: f64 = 1e-12;

/// Levels of two modes of different parts, and the probability of both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    pub both: [Hypothesis; 2],
    pub probability: f64,
}

/// Faults of several parts, and the probabilities of the single hypotheses beside them.
#[derive(Default)]
pub struct Several<'m> {
    /// The pairs worth reporting, the likeliest first.
    pub pairs: Vec<Pair>,
    /// What several parts share.
    pub common: Vec<CommonCause<'m>>,
    /// Of the model's hypotheses.
    pub single: Vec<f64>,
}

/// Faults of several parts that explain a run.
pub fn several<'m>(belief: &Belief<'m, '_>, seen: &Observation) -> Several<'m> {
    let model = belief.model;
    let effects = model.effects();
    let counted = Steps::new(belief, seen, |ln| &ln.effects);
    let mut ln = belief.ln();
    let mut found = Vec::new();
    let best = ln.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let worth_a_look = best + LEAST_SHARE.ln();
    let explaining = counted.explaining(model);
    for (i, first) in explaining.iter().enumerate().take(MOST_EXPLAINING) {
        for second in &explaining[i + 1..] {
            let both = [effects[*first], effects[*second]];
            // Two intermittent modes would explain any intermittent failure.
            if both.iter().all(|mode| model.is_intermittent(*mode)) {
                continue;
            }
            if model.lru(both[0]) == model.lru(both[1]) {
                continue;
            }
            let prior = model.ln_priors[FIRST_EFFECT + first]
                + model.ln_priors[FIRST_EFFECT + second]
                + model.settings.second_fault.ln();
            let ln = prior + counted.ln_of_all(&[*first, *second]);
            // Signs make nothing likelier.
            if ln > worth_a_look {
                found.push((both, ln + belief.signs().ln_under(model, &both)));
            }
        }
    }
    let loosely = Steps::new(belief, seen, |ln| &ln.like_effects[AS_COUNTED]);
    let mut common = common_causes(belief, &loosely, &loosely.explaining(model));
    let singles = ln.len();
    ln.extend(found.iter().map(|(_, ln)| ln));
    ln.extend(common.iter().map(|cause| cause.probability));
    let mut single = normalised(&ln);
    let mut of_pairs = single.split_off(singles);
    let of_common = of_pairs.split_off(found.len());
    for (cause, probability) in common.iter_mut().zip(of_common) {
        cause.probability = probability;
    }
    common.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    let found = found.into_iter().zip(of_pairs);
    let pair = |((both, _), probability)| Pair { both, probability };
    let mut pairs: Vec<Pair> = found.map(pair).collect();
    pairs.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    Several {
        pairs,
        common,
        single,
    }
}

/// What the steps tell of effects at once.
pub struct Steps<'b> {
    /// Logarithms of the likelihood of each passed step under each effect.
    passed: Vec<&'b [f64]>,
    strange: Vec<StrangeStep<'b>>,
}

/// A step that did not pass, or showed a sign.
struct StrangeStep<'b> {
    ln_healthy: f64,
    /// Logarithms of its likelihood under each effect.
    ln: &'b [f64],
    /// Probability of its result under each effect, and that times the likelihood.
    weighted: Vec<(f64, f64)>,
}

impl<'b> Steps<'b> {
    /// `of_effects` takes from a step's likelihoods those under each effect.
    pub fn new(
        belief: &'b Belief<'_, '_>,
        seen: &Observation,
        of_effects: fn(&StepLikelihoods) -> &[f64],
    ) -> Self {
        let model = belief.model;
        let (mut passed, mut strange) = (Vec::new(), Vec::new());
        for weighed in belief.steps() {
            let step = &seen.steps[weighed.seen];
            let ln = of_effects(&weighed.ln);
            if !is_strange(step) {
                passed.push(ln);
                continue;
            }
            let weighted = model.effects().iter().zip(ln).map(|(effect, ln)| {
                let expected = model.expected(*effect, weighed.place);
                let result = expected.result(step.result);
                (result, result * ln.exp())
            });
            strange.push(StrangeStep {
                ln_healthy: weighed.ln.healthy,
                ln,
                weighted: weighted.collect(),
            });
        }
        Self { passed, strange }
    }

    /// Modes that explain the failures better than a healthy unit, with their best level, the best first; by the
    /// index of the effect.
    pub fn explaining(&self, model: &Model<'_>) -> Vec<usize> {
        let explained = |effect: usize| -> f64 {
            let strange = self.strange.iter();
            let gains = strange.map(|step| (step.ln[effect] - step.ln_healthy).max(0.0));
            gains.sum()
        };
        let mut best: Vec<(usize, usize, f64)> = Vec::new();
        for (effect, hypothesis) in model.effects().iter().enumerate() {
            let Hypothesis::Mode { mode, .. } = hypothesis else {
                continue;
            };
            let score = explained(effect);
            match best.last_mut().filter(|(_, of, _)| of == mode) {
                Some(known) if known.2 >= score => {}
                Some(known) => *known = (effect, *mode, score),
                None => best.push((effect, *mode, score)),
            }
        }
        best.retain(|(.., score)| *score > 0.0);
        best.sort_by(|a, b| b.2.total_cmp(&a.2));
        best.into_iter().map(|(effect, ..)| effect).collect()
    }

    /// Logarithm of the likelihood of all steps under effects at once.
    pub fn ln_of_all(&self, effects: &[usize]) -> f64 {
        let least = |ln: &&[f64]| {
            let of_each = effects.iter().map(|effect| ln[*effect]);
            of_each.fold(f64::INFINITY, f64::min)
        };
        // Whose the effect is, is not known: as likely each one's as it is its own.
        let strange = self.strange.iter().map(|step| {
            let of_each = effects.iter().map(|effect| step.weighted[*effect]);
            let (result, weighted) =
                of_each.fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
            (weighted / result).ln()
        });
        self.passed.iter().map(least).sum::<f64>() + strange.sum::<f64>()
    }
}

fn is_strange(step: &ObservedStep) -> bool {
    step.result != Verdict::Passed || !step.signs.is_empty()
}
