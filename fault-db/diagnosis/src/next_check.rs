//! The next best check: the most expected information about the faulty part per second.
//!
//! A procedure sets the unit up at its start and its steps build on each other. So a check costs all steps
//! of its procedure before it, except those that have just run.
//!
//! If no new check tells more, a check may be repeated: with an intermittent fault it may end otherwise, while a
//! lasting fault shows the same again.
//!
//! A check that a person is told to make is rated by pass or fail alone: the signs that come with the result may be
//! known already.

use std::collections::BTreeSet;

use protocol::{LruId, Verdict};
use serde::Serialize;

use super::belief::Belief;
use super::logarithms::normalised;
use super::model::{FIRST_EFFECT, Hypothesis, Model};
use super::observation::CheckName;
use super::verdict::PartProbability;
use super::weights::ratio;

/// A check decides about a part if, with that part failed, it passes (or does not pass) with at least this probability.
const MOSTLY: f64 = 0.7;

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NextCheck {
    /// Procedure and step.
    #[serde(rename = "step", serialize_with = "as_text")]
    pub check: CheckName,
    /// Expected information about the faulty part, bits.
    pub gain_bits: f64,
    /// Duration, s, including the steps before it and the set-up of the unit.
    pub cost_s: f64,
    /// The check was made already, and is worth making again.
    pub again: bool,
    /// Likely parts, with a fault of which the check mostly passes.
    pub passes_with: Vec<LruId>,
    /// Likely parts, with a fault of which the check mostly does not pass.
    pub fails_with: Vec<LruId>,
}

fn as_text<S: serde::Serializer>(check: &CheckName, to: S) -> Result<S::Ok, S::Error> {
    to.collect_str(check)
}

/// The classes to tell apart: no fault, and a fault of each part; each with the effects that it may have.
struct Classes {
    /// Probability of each class.
    all: Vec<f64>,
    /// Probability of each class with each effect, by effect and class.
    with_effect: Vec<Vec<f64>>,
}

impl Belief<'_, '_> {
    /// The next best check, among the procedures in `may` if given. Checks in `done` are not repeated, and the steps of
    /// the procedure `under_way` that have run are not run again. `None` if no check gives enough information.
    pub fn next_check(
        &self,
        done: &BTreeSet<CheckName>,
        under_way: Option<&str>,
        may: Option<&BTreeSet<String>>,
    ) -> Option<NextCheck> {
        let classes = self.classes(&[]);
        let least = self.model.settings.least_gain_bits;
        let costs = costs(self.model, done, under_way, may, false);
        let worth_making = costs.filter_map(|(place, cost_s)| {
            let gain_bits = self.gain_bits(place, &classes);
            (gain_bits >= least).then_some((place, cost_s, gain_bits))
        });
        most_per_second(worth_making).map(|best| self.recommended(best, false, &classes))
    }

    /// The check whose pass or fail gives a person the most information per second. If a run showed a fault (`failed`
    /// holds the parts' probabilities) and several parts are likely, the check must pass with some of these and not
    /// with others; if one part is likely, the check must decide about that part. A check in `done` is repeated only if
    /// no new check qualifies.
    pub fn told_check(
        &self,
        done: &BTreeSet<CheckName>,
        failed: Option<&Vec<PartProbability>>,
    ) -> Option<NextCheck> {
        let classes = self.classes(failed.map_or(&[], Vec::as_slice));
        let named =
            (FIRST_EFFECT..classes.all.len()).filter(|class| self.is_likely(classes.all[*class]));
        let named: Vec<_> = named.filter(|_| failed.is_some()).collect();
        let (least, columns) = match named.len() {
            0 => (
                self.model.settings.least_gain_bits,
                (0..classes.all.len()).collect(),
            ),
            1 => (
                self.model.settings.told_gain_bits,
                (0..classes.all.len()).collect(),
            ),
            _ => (self.model.settings.told_gain_bits, named.clone()),
        };
        [false, true].into_iter().find_map(|again| {
            let telling =
                costs(self.model, done, None, None, again).filter_map(|(place, cost_s)| {
                    let gain_bits = information_bits(&self.passing(place, &classes, &columns));
                    if gain_bits < least {
                        return None;
                    }
                    let sides = self.parted_by(place, &classes);
                    let decided = sides.iter().filter(|parts| !parts.is_empty()).count();
                    (again || decided >= named.len().min(2)).then_some((place, cost_s, gain_bits))
                });
            most_per_second(telling).map(|best| self.recommended(best, again, &classes))
        })
    }

    fn recommended(
        &self,
        (place, cost_s, gain_bits): (usize, f64, f64),
        again: bool,
        classes: &Classes,
    ) -> NextCheck {
        let [passes_with, fails_with] = self.parted_by(place, classes);
        NextCheck {
            check: self.model.dictionary.checks[place].clone(),
            gain_bits,
            cost_s,
            again,
            passes_with,
            fails_with,
        }
    }

    /// Joint probability of each class in `columns` with a pass of the check at `place`, and with no pass.
    fn passing(&self, place: usize, classes: &Classes, columns: &[usize]) -> [Vec<f64>; 2] {
        let joint = self.joint(place, classes);
        let mut passing = [vec![0.0; columns.len()], vec![0.0; columns.len()]];
        for (outcome, row) in joint.iter().enumerate() {
            let sums = &mut passing[usize::from(!self.passed(place, outcome))];
            for (sum, class) in sums.iter_mut().zip(columns) {
                *sum += row[*class];
            }
        }
        passing
    }

    /// Whether the check at `place` passes with this outcome.
    fn passed(&self, place: usize, outcome: usize) -> bool {
        let known = self.model.outlooks[place].outcomes.get(outcome);
        known.is_some_and(|known| known.result == Verdict::Passed)
    }

    fn is_likely(&self, probability: f64) -> bool {
        probability >= self.model.settings.conclusion.named_at
    }

    /// The likely parts with a fault of which the check at `place` mostly passes, and those with which it mostly does
    /// not.
    fn parted_by(&self, place: usize, classes: &Classes) -> [Vec<LruId>; 2] {
        let joint = self.joint(place, classes);
        let mut parted = [Vec::new(), Vec::new()];
        for (part, lru) in self.model.parts().iter().enumerate() {
            let class = FIRST_EFFECT + part;
            let all: f64 = joint.iter().map(|row| row[class]).sum();
            let of_passed = joint
                .iter()
                .enumerate()
                .filter(|(outcome, _)| self.passed(place, *outcome));
            let passes =
                of_passed.map(|(_, row)| row[class]).sum::<f64>() / all.max(f64::MIN_POSITIVE);
            if !self.is_likely(classes.all[class]) {
                continue;
            }
            if passes >= MOSTLY {
                parted[0].push((*lru).clone());
            } else if passes <= 1.0 - MOSTLY {
                parted[1].push((*lru).clone());
            }
        }
        parted
    }

    /// The classes with their probabilities: for parts in `pooled` those given there, for all others by Bayes' rule.
    fn classes(&self, pooled: &[PartProbability]) -> Classes {
        let parts = self.model.parts();
        let classes = FIRST_EFFECT + parts.len();
        let mut all = vec![0.0; classes];
        let mut with_effect = vec![vec![0.0; classes]; self.model.effects().len()];
        let hypotheses = self.model.hypotheses.iter().zip(self.probabilities());
        for (i, (hypothesis, p)) in hypotheses.enumerate() {
            // No fault is the first class.
            let part = self.model.part(*hypothesis);
            let class = part.map_or(i, |part| FIRST_EFFECT + part);
            all[class] += p;
            let shares = match *hypothesis {
                Hypothesis::NoFault => continue,
                Hypothesis::Mode { .. } => {
                    with_effect[i - FIRST_EFFECT][class] += p;
                    continue;
                }
                Hypothesis::Unseen { part } => normalised(&self.vaguely_like_effects(part)),
            };
            for (effect, share) in shares.into_iter().enumerate() {
                with_effect[effect][class] += p * share;
            }
        }
        for (class, part) in (FIRST_EFFECT..).zip(parts) {
            if let Some(pooled) = pooled.iter().find(|pooled| pooled.lru == **part) {
                let factor = ratio(pooled.probability, all[class]);
                all[class] = pooled.probability;
                with_effect
                    .iter_mut()
                    .for_each(|classes| classes[class] *= factor);
            }
        }
        Classes { all, with_effect }
    }

    /// Mutual information of the class and the outcome of the check at `place`, bits.
    fn gain_bits(&self, place: usize, classes: &Classes) -> f64 {
        match self.model.outlooks[place].effects.is_empty() {
            true => 0.0,
            false => information_bits(&self.joint(place, classes)),
        }
    }

    /// Joint probability of each outcome of the check at `place` (the counted ones, then any other) with each class.
    fn joint(&self, place: usize, classes: &Classes) -> Vec<Vec<f64>> {
        let outlook = &self.model.outlooks[place];
        // With a lasting fault the check shows what it showed before.
        let before = self.shown(place).map(|outcome| {
            let known = outlook.outcomes.iter().position(|known| known == outcome);
            known.unwrap_or(outlook.outcomes.len())
        });
        let is_new = |effect: usize| {
            before.is_none() || self.model.is_intermittent(self.model.effects()[effect])
        };
        let mut joint = vec![vec![0.0; classes.all.len()]; outlook.outcomes.len() + 1];
        let mut add = |outcomes: &[(usize, f64)], of_classes: &[f64]| {
            for (outcome, share) in outcomes {
                for (sum, p) in joint[*outcome].iter_mut().zip(of_classes) {
                    *sum += p * share;
                }
            }
        };
        let mut like_healthy = classes.all.clone();
        for (effect, outcomes) in outlook.effects.iter().filter(|(effect, _)| is_new(*effect)) {
            let of_classes = &classes.with_effect[*effect];
            for (left, p) in like_healthy.iter_mut().zip(of_classes) {
                *left = (*left - p).max(0.0);
            }
            add(outcomes, of_classes);
        }
        match before {
            Some(outcome) => add(&[(outcome, 1.0)], &like_healthy),
            None => add(&outlook.healthy, &like_healthy),
        }
        joint
    }
}

/// Indexes and costs, s, of the checks that may be made: of those in `done` if `again`, else of the others. A check
/// costs all steps of its procedure up to it, except those of the procedure `under_way` that have run.
pub fn costs<'a>(
    model: &'a Model<'_>,
    done: &'a BTreeSet<CheckName>,
    under_way: Option<&'a str>,
    may: Option<&'a BTreeSet<String>>,
    again: bool,
) -> impl Iterator<Item = (usize, f64)> + 'a {
    let mut procedure = "";
    let mut cost_s = 0.0;
    let checks = model.dictionary.checks.iter().enumerate();
    checks.filter_map(move |(place, check)| {
        let is_under_way = under_way == Some(&check.procedure);
        if check.procedure != procedure {
            procedure = &check.procedure;
            cost_s = match is_under_way {
                true => 0.0,
                false => model.settings.bring_up_s,
            };
        }
        let is_done = done.contains(check);
        if may.is_some_and(|may| !may.contains(procedure)) || (is_under_way && is_done) {
            return None;
        }
        cost_s += model.healthy_time_s(place);
        (is_done == again).then_some((place, cost_s))
    })
}

/// The check with the greatest worth per second, the first of equals; an item is its index, its cost in s, and its
/// worth.
pub fn most_per_second(
    checks: impl Iterator<Item = (usize, f64, f64)>,
) -> Option<(usize, f64, f64)> {
    let per_second = |(_, cost_s, worth): &(usize, f64, f64)| worth / cost_s.max(0.1);
    checks.reduce(|best, next| match per_second(&next) > per_second(&best) {
        true => next,
        false => best,
    })
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
