//! The probabilities of an answer: one distribution over no fault, each part alone and each two parts.

use std::collections::BTreeMap;

use protocol::LruId;
use serde::Serialize;

use super::belief::Belief;
use super::dictionary::ModeName;
use super::model::{Hypothesis, Model};
use super::pairs::Pair;
use super::verdict::PartProbability;

/// Word for a fault of a part that is not in the dictionary, in place of a mode's.
const UNSEEN: &str = "unseen";

/// A fault of one part: a mode of the dictionary, or one that is not in it.
#[derive(Clone, Copy, Debug)]
pub struct Fault {
    pub hypothesis: Hypothesis,
    /// Of all its levels, alone or beside another.
    pub probability: f64,
    pub of_level: f64,
}

/// What is wrong under a fault.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FaultText {
    /// As the catalogue of faults has it.
    Mode(String),
    /// What confirmed repairs of a depot have settled.
    Confirmed { cases: u32, units: String },
    /// In a way that is not in the dictionary.
    Unseen {
        /// The mode that it acts like, and what is wrong under that.
        like: Option<(String, Box<FaultText>)>,
    },
}

/// Name of the fault of a part, and what is wrong.
pub fn name(belief: &Belief<'_, '_>, hypothesis: Hypothesis) -> (String, FaultText) {
    let model = belief.model;
    match hypothesis {
        Hypothesis::Mode { mode, .. } => {
            let mode = &model.dictionary.modes[mode];
            let (id, text) = (mode.name.id.clone(), mode.name.text.clone());
            match mode.name.kind == ModeName::CONFIRMED {
                false => (id, FaultText::Mode(text)),
                true => {
                    let cases = mode.columns.iter().map(|column| column.runs).sum();
                    (id, FaultText::Confirmed { cases, units: text })
                }
            }
        }
        Hypothesis::Unseen { part } => {
            let like = belief.acts_like(hypothesis);
            let like = like.map(|effect| name(belief, model.effects()[effect]));
            let like = like.map(|(id, text)| (id, Box::new(text)));
            let id = format!("{}.{UNSEEN}", model.parts()[part]);
            (id, FaultText::Unseen { like })
        }
        Hypothesis::NoFault => (String::new(), FaultText::Mode(String::new())),
    }
}

impl Fault {
    /// Takes in another level of the same fault, or the same in another company.
    fn take(&mut self, other: Self) {
        self.probability += other.probability;
        if other.of_level > self.of_level {
            (self.hypothesis, self.of_level) = (other.hypothesis, other.of_level);
        }
    }
}

/// Levels of one mode, or the same.
fn is_same_fault(one: Hypothesis, other: Hypothesis) -> bool {
    match (one, other) {
        (Hypothesis::Mode { mode, .. }, Hypothesis::Mode { mode: of_other, .. }) => {
            mode == of_other
        }
        _ => one == other,
    }
}

/// The probabilities. A part's share of two is half of it.
pub struct Weights {
    pub lrus: Vec<PartProbability>,
    /// Two parts at once, the likeliest first.
    pub both: Vec<([LruId; 2], f64)>,
    pub faults: Vec<Fault>,
    pub no_fault: f64,
}

impl Weights {
    /// Of the probabilities of single hypotheses, in the model's order, and of the pairs beside them.
    pub fn new(model: &Model<'_>, pairs: &[Pair], single: &[f64]) -> Self {
        let mut faults: Vec<Fault> = Vec::new();
        let mut parts: BTreeMap<&LruId, f64> = BTreeMap::new();
        let mut no_fault = 0.0;
        for (hypothesis, p) in model.hypotheses.iter().zip(single) {
            let of_level = *p;
            match *hypothesis {
                Hypothesis::NoFault => no_fault = of_level,
                Hypothesis::Mode { .. } | Hypothesis::Unseen { .. } => {
                    let fault = Fault {
                        hypothesis: *hypothesis,
                        probability: of_level,
                        of_level,
                    };
                    match faults
                        .last_mut()
                        .filter(|last| is_same_fault(last.hypothesis, *hypothesis))
                    {
                        Some(last) => last.take(fault),
                        None => faults.push(fault),
                    }
                }
            }
            if let Some(lru) = model.lru(*hypothesis) {
                *parts.entry(lru).or_default() += of_level;
            }
        }
        let mut both: BTreeMap<[&LruId; 2], f64> = BTreeMap::new();
        for pair in pairs {
            for hypothesis in pair.both {
                let of_pair = faults
                    .iter_mut()
                    .find(|fault| is_same_fault(fault.hypothesis, hypothesis));
                if let Some(fault) = of_pair {
                    let (probability, of_level) = (pair.probability, pair.probability);
                    fault.take(Fault {
                        hypothesis,
                        probability,
                        of_level,
                    });
                }
                if let Some(lru) = model.lru(hypothesis) {
                    *parts.entry(lru).or_default() += pair.probability / 2.0;
                }
            }
            if let [Some(one), Some(other)] = pair.both.map(|hypothesis| model.lru(hypothesis)) {
                *both.entry([one.min(other), one.max(other)]).or_default() += pair.probability;
            }
        }
        let mut lrus: Vec<_> = parts
            .into_iter()
            .map(|(lru, probability)| PartProbability {
                lru: lru.clone(),
                probability,
            })
            .collect();
        lrus.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        let both = both
            .into_iter()
            .map(|(parts, p)| (parts.map(LruId::clone), p));
        let mut both: Vec<_> = both.collect();
        both.sort_by(|a, b| b.1.total_cmp(&a.1));
        Self {
            lrus,
            both,
            faults,
            no_fault,
        }
    }

    /// The parts that have failed, alone or beside another, with probability `sure` at least, each with that
    /// probability.
    pub fn failed(&self, sure: f64) -> Vec<(&LruId, f64)> {
        let failed = self.lrus.iter().map(|part| {
            let beside: f64 = self.pairs_of(&part.lru).map(|(_, both)| both).sum();
            (&part.lru, part.probability + beside / 2.0)
        });
        failed.filter(|(_, p)| *p >= sure).collect()
    }

    /// All parts with the probability that each has failed, alone or beside another, the likeliest first.
    pub fn told(&self) -> Vec<PartProbability> {
        let all = self.failed(0.0).into_iter();
        let told = all.map(|(lru, probability)| PartProbability {
            lru: lru.clone(),
            probability,
        });
        let mut told: Vec<_> = told.collect();
        told.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        told
    }

    /// Probability that both of two parts have failed.
    pub fn both_failed(&self, one: &LruId, other: &LruId) -> f64 {
        let of_pair = self.pairs_of(one).filter(|(beside, _)| *beside == other);
        of_pair.map(|(_, both)| both).sum()
    }

    /// Least set of parts, the likeliest first, one of which has failed with probability `sure`.
    pub fn credible_parts(&self, sure: f64) -> Vec<&LruId> {
        let mut sum = 0.0;
        let mut parts: Vec<&LruId> = Vec::new();
        for part in &self.lrus {
            if sum >= sure {
                break;
            }
            sum += self.failed_without(part, &parts);
            parts.push(&part.lru);
        }
        parts
    }

    /// Probability that one of these parts has failed, alone or beside another.
    pub fn any_failed(&self, parts: &[LruId]) -> f64 {
        let of_group = self.lrus.iter().filter(|part| parts.contains(&part.lru));
        let mut before: Vec<&LruId> = Vec::new();
        let each = of_group.map(|part| {
            let more = self.failed_without(part, &before);
            before.push(&part.lru);
            more
        });
        each.sum()
    }

    /// Probability that a part has failed and none of those `before`: two parts that have failed at once count with the
    /// first of them.
    fn failed_without(&self, part: &PartProbability, before: &[&LruId]) -> f64 {
        let beside = self
            .pairs_of(&part.lru)
            .map(|(other, both)| match before.contains(&other) {
                true => -both / 2.0,
                false => both / 2.0,
            });
        part.probability + beside.sum::<f64>()
    }

    /// The parts that may have failed beside one, each with the probability of both.
    fn pairs_of<'a>(&'a self, lru: &'a LruId) -> impl Iterator<Item = (&'a LruId, f64)> {
        self.both
            .iter()
            .filter_map(move |([one, other], both)| match lru {
                _ if lru == one => Some((other, *both)),
                _ if lru == other => Some((one, *both)),
                _ => None,
            })
    }
}
