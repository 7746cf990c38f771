//! The next best check: the most expected information about the faulty part per second.
//!
//! A procedure sets the unit up at its start and its steps build on each other. So a check costs all steps
//! of its procedure before it, except those that have just run.

use std::collections::{BTreeMap, BTreeSet};

use protocol::LruId;
use serde::Serialize;

use super::belief::Belief;
use super::cell::StepOutcome;
use super::observation::CheckName;

/// A recommended check.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NextCheck {
    /// Procedure and step.
    #[serde(rename = "step", serialize_with = "as_text")]
    pub check: CheckName,
    /// Expected information about the faulty part, bits.
    pub gain_bits: f64,
    /// Duration, s, including the steps before it and the set-up of the unit.
    pub cost_s: f64,
}

fn as_text<S: serde::Serializer>(check: &CheckName, to: S) -> Result<S::Ok, S::Error> {
    to.collect_str(check)
}

/// The classes to tell apart: each part, no fault, and an unknown fault, with their probabilities.
struct Classes {
    of_hypothesis: Vec<usize>,
    count: usize,
    probabilities: Vec<f64>,
}

impl Belief<'_, '_> {
    /// The next best check, among the procedures in `may` if given. Checks in `done` are not repeated; the
    /// steps of the procedure `under_way` that have run need not be run again. `None` if no check gives
    /// enough information.
    pub fn next_check(
        &self,
        done: &BTreeSet<CheckName>,
        under_way: Option<&str>,
        may: Option<&BTreeSet<String>>,
    ) -> Option<NextCheck> {
        let classes = self.classes();
        let dictionary = self.model.dictionary;
        let settings = self.model.settings;
        let mut best: Option<(f64, NextCheck)> = None;
        let mut procedure = "";
        let mut cost_s = 0.0;
        for (place, check) in dictionary.checks.iter().enumerate() {
            if check.procedure != procedure {
                procedure = &check.procedure;
                cost_s = if under_way == Some(procedure) {
                    0.0
                } else {
                    settings.bring_up_s
                };
            }
            if may.is_some_and(|may| !may.contains(procedure)) {
                continue;
            }
            let again = done.contains(check);
            if under_way == Some(procedure) && again {
                continue;
            }
            cost_s += dictionary
                .healthy
                .cells
                .get(&place)
                .map_or(0.0, |cell| cell.time_s);
            if again {
                continue;
            }
            let gain_bits = self.gain_bits(place, &classes);
            if gain_bits < settings.least_gain_bits {
                continue;
            }
            let worth = gain_bits / cost_s.max(0.1);
            if best.as_ref().is_none_or(|(most, _)| worth > *most) {
                let check = check.clone();
                best = Some((
                    worth,
                    NextCheck {
                        check,
                        gain_bits,
                        cost_s,
                    },
                ));
            }
        }
        best.map(|(_, next)| next)
    }

    fn classes(&self) -> Classes {
        let mut names: BTreeMap<Option<&LruId>, usize> = BTreeMap::new();
        let mut of_hypothesis = Vec::new();
        let probabilities = self.probabilities();
        for (i, hypothesis) in self.model.hypotheses.iter().enumerate() {
            // No fault and the unknown one are the first two classes.
            let class = match self.model.lru(*hypothesis) {
                None => i,
                lru => {
                    let next = names.len() + 2;
                    *names.entry(lru).or_insert(next)
                }
            };
            of_hypothesis.push(class);
        }
        Classes {
            of_hypothesis,
            count: names.len() + 2,
            probabilities,
        }
    }

    /// Mutual information of the class and what the check at `place` shows, bits.
    fn gain_bits(&self, place: usize, classes: &Classes) -> f64 {
        let model = self.model;
        if model
            .hypotheses
            .iter()
            .all(|hypothesis| model.is_like_healthy(*hypothesis, place))
        {
            return 0.0;
        }
        let mut joint: BTreeMap<StepOutcome, Vec<f64>> = BTreeMap::new();
        for (i, hypothesis) in model.hypotheses.iter().enumerate() {
            let p = classes.probabilities[i];
            if p < 1e-9 {
                continue;
            }
            let expected = model.expected(*hypothesis, place);
            let runs = f64::from(expected.cell.runs());
            if runs == 0.0 {
                continue;
            }
            for (signature, count) in &expected.cell.signatures {
                let share = f64::from(*count) / runs;
                let row = joint
                    .entry(signature.clone())
                    .or_insert_with(|| vec![0.0; classes.count]);
                row[classes.of_hypothesis[i]] += p * share;
            }
        }
        information_bits(&joint.into_values().collect::<Vec<_>>())
    }
}

/// Mutual information of rows and columns of a table of joint probabilities, bits.
fn information_bits(joint: &[Vec<f64>]) -> f64 {
    let all: f64 = joint.iter().flatten().sum();
    if all <= 0.0 {
        return 0.0;
    }
    let columns = joint.first().map_or(0, Vec::len);
    let of_column: Vec<f64> = (0..columns)
        .map(|c| joint.iter().map(|row| row[c]).sum())
        .collect();
    let mut bits = 0.0;
    for row in joint {
        let of_row: f64 = row.iter().sum();
        for (p, of_column) in row.iter().zip(&of_column) {
            if *p > 0.0 {
                bits += p / all * (p * all / (of_row * of_column)).log2();
            }
        }
    }
    bits.max(0.0)
}
