//! Reasons for and against a fault mode: steps, signs and traces of the run.

use std::collections::BTreeSet;

use protocol::Verdict;
use serde::Serialize;

use super::belief::Belief;
use super::model::{FIRST_EFFECT, Hypothesis, Model};
use super::observation::{CheckName, Observation, ObservedStep, Sign};
use super::signs::SignsSeen;

/// Greatest number of reasons for a mode, and against it.
const MOST: usize = 6;
/// A step is a reason if the logarithm of its likelihood ratio exceeds this: if the ratio exceeds e.
const SPEAKS_AT: f64 = 1.0;
/// Number of modes of other parts, the likeliest, with which a mode is compared.
const MOST_RIVALS: usize = 5;

/// What speaks for a fault, or against it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    Step(StepReason),
    /// A sign in the unit's log.
    Logged(Sign),
    /// The signal at which a trace deviates first from a sound unit's.
    Deviated {
        signal: String,
        /// Shares of the traces in which that signal is the first: under the fault, and under any fault.
        shares: [f64; 2],
    },
    /// What is known of a part from elsewhere.
    Known(Known),
}

/// What a step showed, compared with the dictionary: under the fault, and on a healthy unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StepReason {
    pub check: CheckName,
    /// Verdict of the step.
    pub result: Verdict,
    /// Shares of runs in which the step ends with this verdict: under the fault, and on a healthy unit.
    pub shares: [f64; 2],
    /// Signs that showed in the step.
    pub signs: Vec<Sign>,
    /// Values that tell the fault from a healthy unit, or were not measured.
    pub values: Vec<ValueReason>,
}

/// A measured value, to four significant figures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ValueReason {
    pub name: String,
    /// The value; `None` if nothing could be measured.
    pub value: Option<f64>,
    /// Least and greatest value in the counted runs: under the fault, and on a healthy unit.
    pub ranges: [Option<[f64; 2]>; 2],
}

/// What the history knows of a part.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Known {
    /// Faults of earlier runs named the part.
    Recurred {
        runs: u32,
        /// The repair since which these runs are counted, if there was one.
        since: Option<Repaired>,
    },
    /// The part was repaired, and the fault came back.
    CameBack(Repaired),
    /// Whoever brought the unit reported this symptom.
    BroughtWith { symptom: String },
    /// Diagnoses had attributed faults to the part before the faults' repairs were confirmed.
    WasRight {
        /// Repairs of this part among those.
        right: u32,
        named: u32,
    },
    OftenRepaired {
        /// Confirmed repairs of the part.
        of_part: u32,
        /// Confirmed repairs of any part.
        all: u32,
    },
}

/// A repair of a part.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Repaired {
    /// The part was replaced, not only worked on.
    pub replaced: bool,
    /// Time of the repair, µs since 1970 UTC.
    pub at_us: i64,
}

impl Reason {
    /// The step, if the reason is a step.
    pub fn step(&self) -> Option<&CheckName> {
        match self {
            Self::Step(step) => Some(&step.check),
            Self::Logged(_) | Self::Deviated { .. } | Self::Known(_) => None,
        }
    }
}

/// The reasons for and against a mode; in each list first the strongest step of each procedure, then the other steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reasons {
    /// Steps likelier under the mode than on a healthy unit, then signs and traces.
    pub for_it: Vec<Reason>,
    /// Steps likelier on a healthy unit or under another part's fault, then signs and traces.
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
        let reason = || {
            Reason::Step(held_against(
                model,
                model.effects()[own],
                weighed.place,
                step,
            ))
        };
        // A step that a healthy unit hardly ever shows is likelier under any fault; if another part's fault explains
        // the step better, the step speaks against this fault.
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
            let step = reason.step();
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
    reasons.add_deviations(belief, hypothesis);
    reasons
}

impl Reasons {
    /// Adds the signs that speak for a hypothesis, or against it.
    fn add_signs(&mut self, signs: &SignsSeen, model: &Model<'_>, hypothesis: Hypothesis) {
        let all = signs.in_steps.union(&signs.in_log);
        for sign in all {
            let alone = SignsSeen {
                in_log: BTreeSet::from([sign.clone()]),
                ..SignsSeen::default()
            };
            let gain = alone.ln(model, hypothesis) - alone.ln(model, Hypothesis::NoFault);
            if gain > SPEAKS_AT {
                self.for_it.push(Reason::Logged(sign.clone()));
            } else if gain < -SPEAKS_AT {
                self.against.push(Reason::Logged(sign.clone()));
            }
        }
    }

    /// Adds the first deviations that speak for a hypothesis, or against it.
    fn add_deviations(&mut self, belief: &Belief<'_, '_>, hypothesis: Hypothesis) {
        let model = belief.model;
        let signals: BTreeSet<&String> = belief.residuals().iter().collect();
        for signal in signals {
            let Some(shares) = model.share_of_residual(hypothesis, signal) else {
                continue;
            };
            let signal = signal.clone();
            let gain = (shares[0] / shares[1]).ln();
            if gain > SPEAKS_AT {
                self.for_it.push(Reason::Deviated { signal, shares });
            } else if gain < -SPEAKS_AT {
                self.against.push(Reason::Deviated { signal, shares });
            }
        }
    }
}

/// The likeliest modes of other parts, as indexes of effects.
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
    rivals.truncate(MOST_RIVALS);
    rivals
}

/// A step, its result, and its expected result under the mode and on a healthy unit.
fn held_against(
    model: &Model<'_>,
    hypothesis: Hypothesis,
    place: usize,
    step: &ObservedStep,
) -> StepReason {
    let expected = [hypothesis, Hypothesis::NoFault].map(|of| model.expected(of, place).cell);
    let shares = expected.map(|cell| {
        let runs = cell.runs().max(1);
        f64::from(cell.count(step.result)) / f64::from(runs)
    });
    let values = step.values.iter().filter_map(|(name, value)| {
        let [own, healthy] = expected.map(|cell| cell.values.get(name));
        let ranges = [own?, healthy?].map(|values| {
            let range = || [values.low, values.high].map(rounded);
            (values.n > 0).then(range)
        });
        let tells = ranges[0] != ranges[1] || (step.result != Verdict::Passed && value.is_none());
        tells.then(|| ValueReason {
            name: name.clone(),
            value: value.map(rounded),
            ranges,
        })
    });
    StepReason {
        check: step.check.clone(),
        result: step.result,
        shares,
        values: values.collect(),
        signs: step.signs.iter().cloned().collect(),
    }
}

/// The value to four significant figures.
fn rounded(value: f64) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    let digits = (3 - value.abs().log10().floor() as i32).clamp(0, 6);
    let scale = 10f64.powi(digits);
    (value * scale).round() / scale
}
