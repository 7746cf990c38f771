//! The steps that speak for a fault mode and those that speak against it.

use protocol::Verdict;

use super::belief::Belief;
use super::model::{Hypothesis, Model, NO_FAULT};
use super::observation::{Observation, ObservedStep};

/// Most reasons in each direction.
const MOST: usize = 6;
/// A step is a reason if its likelihood ratio is at least e.
const SPEAKS_AT: f64 = 1.0;
/// Competing modes that a mode is compared with.
const CONFLICTING_EVENTS: usize = 5;

/// The reasons for and against a mode, the strongest first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reasons {
    /// For it: steps likelier than on a healthy unit.
    pub for_it: Vec<String>,
    /// Against it: steps likelier on a healthy unit, or under another part's fault.
    pub against: Vec<String>,
}

/// The reasons for and against a hypothesis, given by its place in the model.
pub fn reasons(belief: &Belief<'_, '_>, hypothesis: usize, seen: &Observation) -> Reasons {
    let model = belief.model;
    let rivals = rivals(belief, hypothesis);
    let mut for_it = Vec::new();
    let mut against = Vec::new();
    for weighed in belief.steps() {
        let own = weighed.ln[hypothesis];
        let healthy = weighed.ln[NO_FAULT];
        let rival = rivals.iter().map(|rival| weighed.ln[*rival]);
        let best_rival = rival.fold(healthy, f64::max);
        let step = &seen.steps[weighed.seen];
        let text = || text(model, model.hypotheses[hypothesis], weighed.place, step);
        if own - healthy > SPEAKS_AT {
            for_it.push((own - healthy, text()));
        } else if best_rival - own > SPEAKS_AT {
            against.push((best_rival - own, text()));
        }
    }
    let hypothesis = model.hypotheses[hypothesis];
    let strongest = |mut all: Vec<(f64, String)>| {
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        let all = all.into_iter().map(|(_, text)| text);
        all.take(MOST).collect()
    };
    let mut reasons = Reasons {
        for_it: strongest(for_it),
        against: strongest(against),
    };
    for sign in &seen.signs {
        let alone = std::collections::BTreeSet::from([sign.clone()]);
        let gain = model.ln_log(hypothesis, &alone) - model.ln_log(Hypothesis::NoFault, &alone);
        let text = format!("the unit's log: {} names {}", sign.fault, sign.part());
        if gain > SPEAKS_AT {
            reasons.for_it.push(text);
        } else if gain < -SPEAKS_AT {
            reasons.against.push(text);
        }
    }
    reasons
}

/// The likeliest hypotheses of another part, by index.
fn rivals(belief: &Belief<'_, '_>, hypothesis: usize) -> Vec<usize> {
    let model = belief.model;
    let own = model.lru(model.hypotheses[hypothesis]);
    let mut rivals: Vec<_> = belief.probabilities().into_iter().enumerate().collect();
    rivals.retain(|(i, _)| {
        let lru = model.lru(model.hypotheses[*i]);
        lru.is_some() && lru != own
    });
    rivals.sort_by(|a, b| b.1.total_cmp(&a.1));
    rivals.truncate(CONFLICTING_EVENTS);
    rivals.into_iter().map(|(i, _)| i).collect()
}

/// A step, its result, and its expected result under the mode and on a healthy unit.
fn text(model: &Model<'_>, hypothesis: Hypothesis, place: usize, step: &ObservedStep) -> String {
    let own = model.expected(hypothesis, place);
    let healthy = model.expected(Hypothesis::NoFault, place);
    let share = |expected: super::likelihood::Expected<'_>| {
        let runs = expected.cell.runs().max(1);
        format!(
            "{:.0} %",
            100.0 * f64::from(expected.cell.count(step.result)) / f64::from(runs)
        )
    };
    let mut text = format!(
        "{} {} (under this fault {}, healthy {})",
        step.check,
        step.result.label(),
        share(own),
        share(healthy)
    );
    for sign in &step.signs {
        text += &format!(", {} names {}", sign.fault, sign.part());
    }
    for (name, value) in &step.values {
        let (Some(of_own), Some(of_healthy)) =
            (own.cell.values.get(name), healthy.cell.values.get(name))
        else {
            continue;
        };
        let range = |v: &super::cell::Values| match v.n {
            0 => "none".to_owned(),
            _ => format!("{} to {}", rounded(v.low), rounded(v.high)),
        };
        let differs = range(of_own) != range(of_healthy);
        if differs || (step.result != Verdict::Passed && value.is_none()) {
            let value = value.map_or_else(|| "none".to_owned(), rounded);
            text += &format!(
                "; {name} = {value} (under this fault {}, healthy {})",
                range(of_own),
                range(of_healthy)
            );
        }
    }
    text
}

/// Four significant figures.
fn rounded(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let digits = (3 - value.abs().log10().floor() as i32).clamp(0, 6);
    let text = format!("{value:.*}", digits as usize);
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}
