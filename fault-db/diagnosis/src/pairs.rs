//! Double faults, considered when no single fault explains the results.
//!
//! A check passes under two faults only if it passes under each, and fails if either makes it fail. So a
//! passed check has the lesser of the two likelihoods; any other result is the effect of one of them.

use protocol::Verdict;

use super::belief::{Belief, normalised};
use super::model::{FIRST_EFFECT, Hypothesis};
use super::observation::{Observation, ObservedStep};

/// Number of best explaining modes that are combined to pairs.
const MOST_EXPLAINING: usize = 12;

/// Levels of two modes of different parts, and the probability of both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    pub both: [Hypothesis; 2],
    pub probability: f64,
}

/// The pairs worth reporting, the likeliest first, and the factor by which they reduce the probabilities of
/// single hypotheses.
pub fn pairs(belief: &Belief<'_, '_>, seen: &Observation) -> (Vec<Pair>, f64) {
    let model = belief.model;
    let explaining = explaining(belief, seen);
    let mut both = Vec::new();
    let mut ln = belief.ln();
    let singles = ln.len();
    for (i, first) in explaining.iter().enumerate() {
        for second in &explaining[i + 1..] {
            let hypotheses = [model.hypotheses[*first], model.hypotheses[*second]];
            if model.lru(hypotheses[0]) == model.lru(hypotheses[1]) {
                continue;
            }
            let prior = model.ln_priors[*first]
                + model.ln_priors[*second]
                + model.settings.second_fault.ln();
            both.push(hypotheses);
            ln.push(prior + ln_pair(belief, [*first, *second], seen));
        }
    }
    let all = normalised(&ln);
    let left: f64 = all[..singles].iter().sum();
    let found = both.into_iter().zip(&all[singles..]);
    let mut found: Vec<_> = found
        .map(|(both, probability)| Pair {
            both,
            probability: *probability,
        })
        .collect();
    found.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    (found, left)
}

fn is_strange(step: &ObservedStep) -> bool {
    step.result != Verdict::Passed || !step.signs.is_empty()
}

/// Permanent modes that explain the failures better than a healthy unit, with their best level, the best
/// first; by index in the model.
fn explaining(belief: &Belief<'_, '_>, seen: &Observation) -> Vec<usize> {
    let steps = belief.steps().iter();
    let wrong: Vec<_> = steps.filter(|w| is_strange(&seen.steps[w.seen])).collect();
    let explained = |hypothesis: usize| -> f64 {
        let gains = wrong
            .iter()
            .map(|w| w.ln.effects[hypothesis - FIRST_EFFECT] - w.ln.healthy);
        gains.map(|gain| gain.max(0.0)).sum()
    };
    let mut best: Vec<(usize, usize, f64)> = Vec::new();
    for (i, hypothesis) in belief.model.hypotheses.iter().enumerate() {
        let Hypothesis::Mode { mode, .. } = hypothesis else {
            continue;
        };
        // Two intermittent modes would explain any intermittent failure.
        if belief.model.is_intermittent(*hypothesis) {
            continue;
        }
        let score = explained(i);
        match best.last_mut().filter(|(_, of, _)| of == mode) {
            Some(known) if known.2 >= score => {}
            Some(known) => *known = (i, *mode, score),
            None => best.push((i, *mode, score)),
        }
    }
    best.retain(|(.., score)| *score > 0.0);
    best.sort_by(|a, b| b.2.total_cmp(&a.2));
    best.truncate(MOST_EXPLAINING);
    best.into_iter().map(|(i, ..)| i).collect()
}

fn ln_pair(belief: &Belief<'_, '_>, [first, second]: [usize; 2], seen: &Observation) -> f64 {
    let of_steps = belief.steps().iter().map(|weighed| {
        let ln = |hypothesis: usize| weighed.ln.effects[hypothesis - FIRST_EFFECT];
        let (a, b) = (ln(first), ln(second));
        let step = &seen.steps[weighed.seen];
        if is_strange(step) {
            // Whose the effect is, is not known: as likely each one's as it is its own.
            let result = |i: usize| {
                let expected = belief
                    .model
                    .expected(belief.model.hypotheses[i], weighed.place);
                expected.result(step.result)
            };
            let (of_a, of_b) = (result(first), result(second));
            ((of_a * a.exp() + of_b * b.exp()) / (of_a + of_b)).ln()
        } else {
            a.min(b)
        }
    });
    let model = belief.model;
    let both = [first, second].map(|i| model.hypotheses[i]);
    of_steps.sum::<f64>() + belief.signs().ln_under(model, &both)
}
