//! Two effects at once: of two faults, or of one cause at two parts that share something.
//!
//! A check passes under two effects only if it passes under each, and fails if either makes it fail. So a passed check
//! has the lesser of the two likelihoods; any other result is that of one of them.

use protocol::Verdict;

use super::belief::{Belief, normalised};
use super::model::{FIRST_EFFECT, Hypothesis, Model};
use super::observation::{Observation, ObservedStep};

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

/// The pairs worth reporting, the likeliest first, and the probabilities of the single hypotheses beside them.
pub fn pairs(belief: &Belief<'_, '_>, seen: &Observation) -> (Vec<Pair>, Vec<f64>) {
    let model = belief.model;
    let effects = model.effects();
    let counted = Steps::new(belief, seen);
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
            let [Some(one), Some(other)] = both.map(|mode| model.lru(mode)) else {
                continue;
            };
            if one == other {
                continue;
            }
            let beside = match model.relations.shared_by([one, other]) {
                Some(_) => model.settings.common_cause,
                None => model.settings.second_fault,
            };
            let prior = model.ln_priors[FIRST_EFFECT + first]
                + model.ln_priors[FIRST_EFFECT + second]
                + beside.ln();
            let ln = prior
                + counted.ln_of_both(*first, *second)
                + belief.ln_residuals(&[*first, *second]);
            // Signs make nothing likelier.
            if ln > worth_a_look {
                found.push((both, ln + belief.signs().ln_under(model, &both)));
            }
        }
    }
    let singles = ln.len();
    ln.extend(found.iter().map(|(_, ln)| ln));
    let mut single = normalised(&ln);
    let of_pairs = single.split_off(singles);
    let found = found.into_iter().zip(of_pairs);
    let pair = |((both, _), probability)| Pair { both, probability };
    let mut found: Vec<Pair> = found.map(pair).collect();
    found.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    (found, single)
}

/// What the steps tell of each two effects.
struct Steps<'b> {
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
    fn new(belief: &'b Belief<'_, '_>, seen: &Observation) -> Self {
        let model = belief.model;
        let (mut passed, mut strange) = (Vec::new(), Vec::new());
        for weighed in belief.steps() {
            let step = &seen.steps[weighed.seen];
            let ln = &*weighed.ln.effects;
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
    fn explaining(&self, model: &Model<'_>) -> Vec<usize> {
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

    /// Logarithm of the likelihood of all steps under two effects.
    fn ln_of_both(&self, first: usize, second: usize) -> f64 {
        let passed = self.passed.iter().map(|ln| ln[first].min(ln[second]));
        // Whose the effect is, is not known: as likely each one's as it is its own.
        let strange = self.strange.iter().map(|step| {
            let (result, weighted) = step.weighted[first];
            let (other_result, other_weighted) = step.weighted[second];
            ((weighted + other_weighted) / (result + other_result)).ln()
        });
        passed.sum::<f64>() + strange.sum::<f64>()
    }
}

fn is_strange(step: &ObservedStep) -> bool {
    step.result != Verdict::Passed || !step.signs.is_empty()
}
