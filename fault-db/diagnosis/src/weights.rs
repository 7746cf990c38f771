//! The probabilities of an answer: one distribution over no fault and each part.

use std::collections::BTreeSet;

use protocol::LruId;
use serde::Serialize;

use super::belief::Belief;
use super::dictionary::ModeName;
use super::groups::rivals;
use super::logarithms::normalised;
use super::model::Hypothesis;
use super::observation::Observation;
use super::pool::Pooled;
use super::verdict::PartProbability;

/// Word in the name of a fault that is not in the dictionary, in place of a mode's name.
const UNSEEN: &str = "unseen";

/// A fault of one part: a mode of the dictionary, or one that is not in it.
#[derive(Clone, Copy, Debug)]
pub struct Fault {
    pub hypothesis: Hypothesis,
    /// Probability of all levels of the fault together.
    pub probability: f64,
    pub of_level: f64,
}

/// What is wrong under a fault.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FaultText {
    /// As the catalogue of faults has it.
    Mode(String),
    /// A fault known from confirmed repairs: their number, and the units.
    Confirmed { cases: u32, units: String },
    /// A fault that is not in the dictionary.
    Unseen {
        /// The mode that the fault acts like, and what is wrong under that mode.
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
    /// Adds the probability of another level of the same fault.
    fn take(&mut self, other: Self) {
        self.probability += other.probability;
        if other.of_level > self.of_level {
            (self.hypothesis, self.of_level) = (other.hypothesis, other.of_level);
        }
    }
}

/// Whether two hypotheses are the same fault: equal, or two levels of one mode.
fn is_same_fault(one: Hypothesis, other: Hypothesis) -> bool {
    match (one, other) {
        (Hypothesis::Mode { mode, .. }, Hypothesis::Mode { mode: of_other, .. }) => {
            mode == of_other
        }
        _ => one == other,
    }
}

/// The probabilities of all parts and faults.
pub struct Weights {
    /// All parts, the likeliest first; their probabilities and that of no fault add up to 1.
    pub parts: Vec<PartProbability>,
    pub faults: Vec<Fault>,
    pub no_fault: f64,
    /// Probability that the fault is one that was counted.
    pub counted: f64,
    /// The parts of which one has failed for certain, the likeliest first. Empty if they were more than `most_of_set`,
    /// if the unit may be healthy, or if they have too small a probability together.
    pub set: Vec<PartProbability>,
}

impl Weights {
    /// Weighs all evidence; if the run shows no fault, by Bayes' rule alone.
    pub fn after(belief: &Belief<'_, '_>, seen: &Observation) -> Self {
        let model = belief.model;
        let ln = belief.ln();
        let mut faults: Vec<Fault> = Vec::new();
        let mut parts = vec![0.0; model.parts().len()];
        let mut no_fault = 0.0;
        for (hypothesis, p) in model.hypotheses.iter().zip(normalised(&ln)) {
            let Some(part) = model.part(*hypothesis) else {
                no_fault = p;
                continue;
            };
            parts[part] += p;
            let fault = Fault {
                hypothesis: *hypothesis,
                probability: p,
                of_level: p,
            };
            let last = faults.last_mut();
            match last.filter(|last| is_same_fault(last.hypothesis, *hypothesis)) {
                Some(last) => last.take(fault),
                None => faults.push(fault),
            }
        }
        let (mut counted, mut causes) = (1.0, BTreeSet::new());
        if seen.shows_a_fault() {
            let pooled = Pooled::of(belief, seen, &ln);
            let shares = pooled.shares.iter().map(|share| share * (1.0 - no_fault));
            let shares: Vec<f64> = shares.collect();
            for fault in &mut faults {
                if let Some(part) = model.part(fault.hypothesis) {
                    fault.probability *= ratio(shares[part], parts[part]);
                }
            }
            parts = shares;
            (counted, causes) = (pooled.counted, pooled.causes);
        }
        let parts = model.parts().iter().zip(parts);
        let parts = parts.map(|(lru, probability)| PartProbability {
            lru: (*lru).clone(),
            probability,
        });
        let mut parts: Vec<_> = parts.collect();
        parts.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        Self {
            set: set(belief, &parts, no_fault, &causes),
            parts,
            faults,
            no_fault,
            counted,
        }
    }
}

/// `one` divided by `other`; 0 if `other` is 0.
pub fn ratio(one: f64, other: f64) -> f64 {
    match other > 0.0 {
        true => one / other,
        false => 0.0,
    }
}

/// The parts of which one has failed for certain, and the parts of the bench that would act alike.
fn set(
    belief: &Belief<'_, '_>,
    parts: &[PartProbability],
    no_fault: f64,
    causes: &BTreeSet<LruId>,
) -> Vec<PartProbability> {
    let settings = belief.model.settings.conclusion;
    let least = settings.least_of_set;
    let (set, rest) = parts.split_at(parts.partition_point(|part| part.probability >= least));
    let has_cause = set.iter().any(|part| causes.contains(&part.lru));
    let most = settings.most_of_set + usize::from(has_cause);
    let in_all: f64 = set.iter().map(|part| part.probability).sum();
    if no_fault >= least || set.len() > most || in_all < settings.least_in_all {
        return Vec::new();
    }
    let of_unit = set.iter().map(|part| &part.lru);
    let rivals: BTreeSet<&LruId> = of_unit.flat_map(|part| rivals(belief, part)).collect();
    let rivals = rest.iter().filter(|part| rivals.contains(&part.lru));
    set.iter().chain(rivals).cloned().collect()
}
