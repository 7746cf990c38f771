//! One cause at several parts: a supply, a ground or a link whose failure shows at two of the parts that share it.
//!
//! A check passes under two effects at once only if it passes under each, and fails if either makes it fail. So a
//! passed check has the lesser of the two likelihoods; any other result is caused by one of the two effects.

use std::collections::BTreeMap;

use protocol::{LruId, Verdict};

use super::belief::Belief;
use super::model::{Hypothesis, Model};
use super::observation::{Observation, ObservedStep};

/// Number of modes that explain the run best; each of them is combined with all others.
const MOST_EXPLAINING: usize = 12;

/// For each shared part, how much better effects at two of the parts that share it explain a run than any one effect:
/// logarithm of the likelihood ratio.
pub fn gains<'m>(belief: &Belief<'m, '_>, seen: &Observation) -> BTreeMap<&'m LruId, f64> {
    let model = belief.model;
    let effects = model.effects();
    let steps = Steps::new(belief, seen);
    let evidence = |which: &[usize], ln_steps: f64| {
        let modes: Vec<Hypothesis> = which.iter().map(|effect| effects[*effect]).collect();
        ln_steps + belief.ln_residuals(which) + belief.signs().ln_under(model, &modes)
    };
    let alone = (0..effects.len()).map(|effect| evidence(&[effect], belief.ln_of_effect(effect)));
    let alone = alone.fold(f64::NEG_INFINITY, f64::max);
    let explaining = steps.explaining(model);
    let mut gains: BTreeMap<&LruId, f64> = BTreeMap::new();
    for (i, first) in explaining.iter().enumerate().take(MOST_EXPLAINING) {
        for second in &explaining[i + 1..] {
            let parts = [first, second].map(|effect| model.lru(effects[*effect]));
            let [Some(one), Some(other)] = parts else {
                continue;
            };
            if one == other {
                continue;
            }
            let shared = model.relations.shared.iter();
            let reach = shared.filter(|shared| {
                [one, other]
                    .iter()
                    .all(|part| shared.reaches.contains(part))
            });
            let mut reach = reach.peekable();
            if reach.peek().is_none() {
                continue;
            }
            let gain = evidence(&[*first, *second], steps.ln_of_both(*first, *second)) - alone;
            for shared in reach {
                let best = gains.entry(&shared.part).or_default();
                *best = best.max(gain);
            }
        }
    }
    gains
}

/// The steps' likelihoods under each effect, from which those under two effects follow.
struct Steps<'b> {
    /// Logarithms of the likelihood of each passed step under each effect.
    passed: Vec<&'b [f64]>,
    strange: Vec<StrangeStep<'b>>,
}

/// A step that did not pass, or showed a sign.
struct StrangeStep<'b> {
    ln_healthy: f64,
    /// Logarithms of the step's likelihood under each effect.
    ln: &'b [f64],
    /// Probability of the step's result under each effect, and the product of that probability and the likelihood.
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

    /// Indexes of the effects that explain the failures better than a healthy unit does, the best first; of each mode
    /// only its best level.
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
        // Either fault may have caused the result: each with the probability that the result has under that fault.
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
