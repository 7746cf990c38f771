//! Two faults at once: looked at when one fault alone leaves results unexplained.
//!
//! A check passes under two faults only if it passes under each; a sign shows if either makes it
//! show; a value is what the one that changes it makes of it.

use super::belief::{Belief, normalised};
use super::cell::Signature;
use super::likelihood::Expected;
use super::model::{Hypothesis, Model};
use super::observation::{Observation, Result, StepSeen};

/// Modes that explain the most, of which pairs are made.
const MOST_EXPLAINING: usize = 12;

/// Two varieties of modes of different parts, and their probability together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// The two.
    pub both: [Hypothesis; 2],
    /// Probability.
    pub probability: f64,
}

/// The pairs worth a thought, the likeliest first, and the factor that their existence puts on the
/// probabilities of single hypotheses.
pub fn pairs(belief: &Belief<'_, '_>, seen: &Observation) -> (Vec<Pair>, f64) {
    let model = belief.model;
    let explaining = explaining(model, seen);
    let mut both = Vec::new();
    let mut ln = belief.ln().to_vec();
    let singles = ln.len();
    for (i, first) in explaining.iter().enumerate() {
        for second in &explaining[i + 1..] {
            if model.lru(model.hypotheses[*first]) == model.lru(model.hypotheses[*second]) {
                continue;
            }
            let hypotheses = [model.hypotheses[*first], model.hypotheses[*second]];
            let prior = model.ln_priors[*first]
                + model.ln_priors[*second]
                + model.settings.second_fault.ln();
            both.push(hypotheses);
            ln.push(prior + ln_pair(model, hypotheses, seen));
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

/// Hypotheses that make what went wrong likelier than on a healthy unit, the best variety of each
/// mode, the most explaining first; by their place in the model.
fn explaining(model: &Model<'_>, seen: &Observation) -> Vec<usize> {
    let wrong = seen.steps.iter().filter_map(|step| {
        let strange = step.result != Result::Passed || !step.signs.is_empty();
        let place = model.dictionary.place(&step.check)?;
        strange.then_some((place, step))
    });
    let wrong: Vec<_> = wrong.collect();
    let explained = |hypothesis: Hypothesis| -> f64 {
        let of_step = |(place, step): &(usize, &StepSeen)| {
            let healthy = model.ln_likelihood(Hypothesis::NoFault, *place, step);
            (model.ln_likelihood(hypothesis, *place, step) - healthy).max(0.0)
        };
        wrong.iter().map(of_step).sum()
    };
    let mut best: Vec<(usize, usize, f64)> = Vec::new();
    for (i, hypothesis) in model.hypotheses.iter().enumerate() {
        let Hypothesis::Mode { mode, .. } = hypothesis else {
            continue;
        };
        let score = explained(*hypothesis);
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

fn ln_pair(model: &Model<'_>, both: [Hypothesis; 2], seen: &Observation) -> f64 {
    let of_step = |step: &StepSeen| {
        let Some(place) = model.dictionary.place(&step.check) else {
            return 0.0;
        };
        let [first, second] = both;
        match both.map(|hypothesis| model.is_like_healthy(hypothesis, place)) {
            [true, _] => model.ln_likelihood(second, place, step),
            [_, true] => model.ln_likelihood(first, place, step),
            _ => ln_both(model, both, place, step),
        }
    };
    let log = match seen.signs.is_empty() {
        true => 0.0,
        false => {
            let of = both.map(|hypothesis| model.ln_log(hypothesis, &seen.signs));
            of[0].max(of[1])
        }
    };
    seen.steps.iter().map(of_step).sum::<f64>() + log
}

/// Both change the check.
fn ln_both(model: &Model<'_>, both: [Hypothesis; 2], place: usize, step: &StepSeen) -> f64 {
    let expected = both.map(|hypothesis| model.expected(hypothesis, place));
    let kind = signature(&expected, &Signature::of(step));
    // Values without the signature: of the one under which they are likelier.
    let values = [0, 1].map(|i| {
        model.ln_likelihood(both[i], place, step) - expected[i].signature(&Signature::of(step)).ln()
    });
    kind.ln() + values[0].max(values[1])
}

fn signature(expected: &[Expected<'_>; 2], seen: &Signature) -> f64 {
    let of = |result| expected.map(|e| e.result(result));
    let [a, b] = of(Result::Passed);
    let passed = a * b;
    let result = match seen.result {
        Result::Passed => passed,
        other => {
            let share = of(other)[0] + of(other)[1];
            let not_passed = (1.0 - a) + (1.0 - b);
            (1.0 - passed) * share / not_passed
        }
    };
    let signs = expected
        .iter()
        .flat_map(|e| e.cell.signatures.iter().flat_map(|(s, _)| &s.signs))
        .chain(&seen.signs);
    let signs: std::collections::BTreeSet<_> = signs.collect();
    let showing = |sign| {
        let silent: f64 = expected.iter().map(|e| 1.0 - e.sign(sign)).product();
        if seen.signs.contains(sign) {
            1.0 - silent
        } else {
            silent
        }
    };
    result * signs.into_iter().map(showing).product::<f64>()
}
