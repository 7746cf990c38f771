//! The steps that speak for a fault mode and those that speak against it.

use std::collections::BTreeSet;

use protocol::Verdict;
use serde::Serialize;

use super::belief::Belief;
use super::model::{FIRST_EFFECT, Hypothesis, Model};
use super::observation::{CheckName, Observation, ObservedStep, Sign};
use super::signs::SignsSeen;

/// Most reasons in each direction.
const MOST: usize = 6;
/// A step is a reason if its likelihood ratio is at least e.
const SPEAKS_AT: f64 = 1.0;
/// Competing modes that a mode is compared with.
const CONFLICTING_EVENTS: usize = 5;

/// What speaks for a fault, or against it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reason {
    /// In short: what was seen.
    pub said: String,
    /// Held against the dictionary; none of what it does not have.
    pub detail: Option<String>,
    /// The step that showed it.
    pub step: Option<CheckName>,
}

impl Reason {
    /// What is known of a part from elsewhere.
    pub fn told(said: String) -> Self {
        Self {
            said,
            detail: None,
            step: None,
        }
    }
}

/// The reasons for and against a mode, the strongest first; those of one procedure after the first of each other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reasons {
    /// For it: steps likelier than on a healthy unit.
    pub for_it: Vec<Reason>,
    /// Against it: steps likelier on a healthy unit, or under another part's fault.
    pub against: Vec<Reason>,
}

/// The reasons for and against a fault of a part.
pub fn reasons(belief: &Belief<'_, '_>, hypothesis: Hypothesis, seen: &Observation) -> Reasons {
    let model = belief.model;
    let Some(own) = belief.acts_like(hypothesis) else {
        return Reasons::default();
    };
    let rivals = rivals(belief, hypothesis);
    let mut for_it = Vec::new();
    let mut against = Vec::new();
    for weighed in belief.steps() {
        let ln_own = weighed.ln.effects[own];
        let healthy = weighed.ln.healthy;
        let rival = rivals.iter().map(|rival| weighed.ln.effects[*rival]);
        let best_rival = rival.fold(healthy, f64::max);
        let step = &seen.steps[weighed.seen];
        let reason = || Reason {
            said: format!("{} — {}", step.check, step.result.label()),
            detail: Some(text(model, model.effects()[own], weighed.place, step)),
            step: Some(step.check.clone()),
        };
        // What a healthy unit hardly ever shows is likelier under any fault: what another part's explains better speaks
        // against this one.
        if best_rival - ln_own > SPEAKS_AT {
            against.push((best_rival - ln_own, reason()));
        } else if ln_own - healthy > SPEAKS_AT {
            for_it.push((ln_own - healthy, reason()));
        }
    }
    let strongest = |mut all: Vec<(f64, Reason)>| {
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut procedures = BTreeSet::new();
        let is_first = |reason: &Reason| {
            let step = reason.step.as_ref();
            step.is_none_or(|step| procedures.insert(step.procedure.clone()))
        };
        let all = all.into_iter().map(|(_, reason)| reason);
        let (first, more): (Vec<_>, Vec<_>) = all.partition(is_first);
        first.into_iter().chain(more).take(MOST).collect()
    };
    let mut reasons = Reasons {
        for_it: strongest(for_it),
        against: strongest(against),
    };
    reasons.add_signs(belief.signs(), model, hypothesis);
    reasons
}

impl Reasons {
    /// Signs that speak for a hypothesis, or against it.
    fn add_signs(&mut self, signs: &SignsSeen, model: &Model<'_>, hypothesis: Hypothesis) {
        let all = signs.in_steps.union(&signs.in_log);
        for sign in all {
            let alone = SignsSeen {
                in_log: BTreeSet::from([sign.clone()]),
                ..SignsSeen::default()
            };
            let gain = alone.ln(model, hypothesis) - alone.ln(model, Hypothesis::NoFault);
            let text = format!("the unit's log has {}{}", sign.fault, points_at(sign));
            if gain > SPEAKS_AT {
                self.for_it.push(Reason::told(text));
            } else if gain < -SPEAKS_AT {
                self.against.push(Reason::told(text));
            }
        }
    }
}

/// The likeliest modes of another part, by the index of their effect.
fn rivals(belief: &Belief<'_, '_>, hypothesis: Hypothesis) -> Vec<usize> {
    let model = belief.model;
    let own = model.lru(hypothesis);
    let probabilities = belief.probabilities();
    let effects = model.effects().iter().enumerate();
    let others = effects.filter(|(_, effect)| model.lru(**effect) != own);
    let mut rivals: Vec<_> = others.map(|(i, _)| i).collect();
    rivals.sort_by(|a, b| {
        probabilities[FIRST_EFFECT + b].total_cmp(&probabilities[FIRST_EFFECT + a])
    });
    rivals.truncate(CONFLICTING_EVENTS);
    rivals
}

/// The part that a fault is a sign of.
fn points_at(sign: &Sign) -> String {
    match &sign.lru {
        Some(part) => format!(", which points at the {part}"),
        None => ", which points at no part".to_owned(),
    }
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
        text += &format!(", with {}{}", sign.fault, points_at(sign));
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
