//! The result of a diagnosis: ranked parts and modes, reasons, the next best check, and a conclusion,
//! which is "cannot tell" where the evidence is not enough.

use std::collections::BTreeSet;

use protocol::LruId;
use serde::Serialize;

use super::belief::Belief;
use super::conclusion::Conclusion;
use super::explained::{Cause, cause};
use super::model::Model;
use super::next_check::NextCheck;
use super::observation::Observation;
use super::reasons::{Reason, reasons};
use super::settings::ConclusionSettings;
use super::weights::{Fault, FaultText, Weights, name};

/// A fault mode that may explain the run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Candidate {
    /// Part to replace.
    pub lru: LruId,
    /// Name of the fault mode.
    pub fault: String,
    pub text: FaultText,
    /// Probability of the mode.
    pub probability: f64,
    #[serde(rename = "for")]
    pub for_it: Vec<Reason>,
    pub against: Vec<Reason>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartProbability {
    pub lru: LruId,
    /// Probability that the part has failed.
    pub probability: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Finding {
    Found,
    /// A part of the bench has failed, no part of the unit.
    OfBench,
    /// One of a few parts has failed.
    OneOf,
    NoFault,
    /// Something is wrong, and it cannot be told in which part.
    CannotTell,
    /// The steps that were run show nothing wrong, and are not enough to say that nothing is.
    NotEnough,
}

impl Finding {
    pub fn label(self) -> &'static str {
        match self {
            Self::Found => "found",
            Self::OfBench => "of the bench",
            Self::OneOf => "one of a few",
            Self::NoFault => "no fault",
            Self::CannotTell => "cannot tell",
            Self::NotEnough => "not enough was run",
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Diagnosis {
    /// Modes, those of the likeliest part first.
    pub candidates: Vec<Candidate>,
    /// The check to make next; `None` if the question is settled or no check would help.
    pub next_check: Option<NextCheck>,
    pub conclusion: Conclusion,
    /// Parts, the likeliest first; their probabilities and `no_fault` add up to 1. A part's probability is the sum over its
    /// faults.
    pub parts: Vec<PartProbability>,
    /// Probability that nothing is wrong.
    pub no_fault: f64,
}

/// A run weighed with a model, from which all answers about the run are taken.
pub struct Assessment<'m, 'd, 's> {
    belief: Belief<'m, 'd>,
    seen: &'s Observation,
    weights: Weights,
}

impl<'m, 'd, 's> Assessment<'m, 'd, 's> {
    pub fn of(model: &'m Model<'d>, seen: &'s Observation) -> Self {
        let belief = Belief::after(model, seen);
        Self {
            weights: Weights::after(&belief, seen),
            belief,
            seen,
        }
    }

    pub fn diagnosis(&self) -> Diagnosis {
        let (belief, weights) = (&self.belief, &self.weights);
        Diagnosis {
            candidates: weights.candidates(belief, self.seen),
            next_check: weights.next_check(belief, self.seen),
            conclusion: weights.conclusion(belief.model, self.seen),
            no_fault: weights.no_fault,
            parts: weights.parts.clone(),
        }
    }

    /// The part that is found, with what it explains.
    pub fn cause(&self) -> Option<Cause> {
        cause(&self.belief, &self.weights, self.seen)
    }

    /// The likeliest fault mode of a part, however unlikely, with its reasons. A fault that is not in the dictionary is
    /// returned only for a part without modes, as it may act like any mode. `None` for an unknown part.
    pub fn likeliest_of(&self, part: &LruId) -> Option<Candidate> {
        let model = self.belief.model;
        let faults = self.weights.faults.iter();
        let of_part = faults.filter(|fault| model.lru(fault.hypothesis) == Some(part));
        let is_known = |fault: &Fault| model.effect(fault.hypothesis).is_some();
        let likeliest = of_part.max_by(|a, b| {
            let by_kind = is_known(a).cmp(&is_known(b));
            by_kind.then(a.probability.total_cmp(&b.probability))
        })?;
        candidate(&self.belief, self.seen, likeliest)
    }
}

impl Diagnosis {
    /// The diagnosis of what was `seen`.
    pub fn of(model: &Model<'_>, seen: &Observation) -> Self {
        Assessment::of(model, seen).diagnosis()
    }
}

/// A fault of a part with its reasons.
fn candidate(belief: &Belief<'_, '_>, seen: &Observation, fault: &Fault) -> Option<Candidate> {
    let why = reasons(belief, fault.hypothesis, seen);
    let (id, text) = name(belief, fault.hypothesis);
    Some(Candidate {
        lru: belief.model.lru(fault.hypothesis)?.clone(),
        fault: id,
        text,
        probability: fault.probability,
        for_it: why.for_it,
        against: why.against,
    })
}

impl Weights {
    /// Candidates in the order of their parts, within a part the likeliest first.
    fn candidates(&self, belief: &Belief<'_, '_>, seen: &Observation) -> Vec<Candidate> {
        let model = belief.model;
        let ConclusionSettings {
            least_shown,
            most_shown,
            ..
        } = model.settings.conclusion;
        let rank = |fault: &Fault| {
            let lru = model.lru(fault.hypothesis);
            let mut parts = self.parts.iter();
            parts.position(|part| Some(&part.lru) == lru)
        };
        let mut faults: Vec<&Fault> = self.faults.iter().collect();
        faults.sort_by(|a, b| {
            let by_part = rank(a).cmp(&rank(b));
            by_part.then(b.probability.total_cmp(&a.probability))
        });
        let likely =
            |(shown, fault): &(usize, &Fault)| *shown == 0 || fault.probability >= least_shown;
        let shown = faults
            .into_iter()
            .enumerate()
            .filter(likely)
            .take(most_shown);
        shown
            .filter_map(|(_, fault)| candidate(belief, seen, fault))
            .collect()
    }

    fn next_check(&self, belief: &Belief<'_, '_>, seen: &Observation) -> Option<NextCheck> {
        let settings = belief.model.settings;
        if self.set.len() == 1 || self.no_fault >= settings.healthy_at {
            return None;
        }
        let done: BTreeSet<_> = seen.steps.iter().map(|step| step.check.clone()).collect();
        belief.told_check(&done, seen.shows_a_fault().then_some(&self.parts))
    }

    fn conclusion(&self, model: &Model<'_>, seen: &Observation) -> Conclusion {
        let settings = model.settings;
        match &self.set[..] {
            [] => {}
            [one] => {
                let (part, probability) = (one.lru.clone(), one.probability);
                return match model.relations.of_bench.contains(&part) {
                    true => Conclusion::OfBench { part, probability },
                    false => Conclusion::Found { part, probability },
                };
            }
            several => {
                let named: Vec<&LruId> = several.iter().map(|part| &part.lru).collect();
                return Conclusion::OneOf {
                    measure: model.relations.measure(&named),
                    parts: several.to_vec(),
                };
            }
        }
        if self.no_fault >= settings.healthy_at {
            let probability = self.no_fault;
            return Conclusion::NoFault { probability };
        }
        if !seen.shows_a_fault() {
            // A check that was made twice counts once.
            let places = seen
                .steps
                .iter()
                .map(|step| model.dictionary.place(&step.check));
            let made: BTreeSet<_> = places.flatten().collect();
            return Conclusion::NothingSeen {
                made: made.len(),
                of: model.dictionary.checks.len(),
            };
        }
        let named_at = settings.conclusion.named_at;
        let likely = self
            .parts
            .iter()
            .filter(|part| part.probability >= named_at);
        Conclusion::CannotTell {
            likely: likely.cloned().collect(),
            is_unlike_any: self.counted < settings.conclusion.unlike_any,
        }
    }
}
