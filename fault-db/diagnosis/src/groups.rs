//! Ambiguity groups: parts in a row, such as an antenna, its modem and its processor, that checks alone do not always tell
//! apart, with the measurement that does.
//!
//! Of a group one part is named only if what was seen tells it from the others: the run is as it was counted under a mode
//! of the part, or the log holds a sign that faults of this part show and faults of the others do not. Else the answer is
//! the group.

use std::collections::BTreeSet;

use protocol::LruId;
use serde::Serialize;

use super::belief::Belief;
use super::common::Shared;
use super::conclusion::Sentence;
use super::model::{Hypothesis, Model};
use super::observation::Sign;
use super::pairs::Several;
use super::weights::Weights;

/// A sign tells a part from the others of its group if so many modes of the part show it, and none of theirs.
const MODES_WITH_SIGN: usize = 2;

/// Parts that are not always told apart, and what tells which has failed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Group {
    /// The parts.
    pub parts: Vec<LruId>,
    /// What to measure, and where.
    pub measure: Sentence,
}

/// How parts depend on each other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Relations {
    /// Parts that checks do not always tell apart.
    pub groups: Vec<Group>,
    /// What several parts share.
    pub shared: Vec<Shared>,
}

/// Parts that do not depend on each other, as far as is known.
pub static NO_RELATIONS: Relations = Relations {
    groups: Vec::new(),
    shared: Vec::new(),
};

impl Group {
    fn has(&self, part: &LruId) -> bool {
        self.parts.contains(part)
    }

    fn others<'a>(&'a self, part: &'a LruId) -> impl Iterator<Item = &'a LruId> {
        self.parts.iter().filter(move |other| *other != part)
    }
}

/// Several parts, one of which has failed, and what tells which.
pub struct Answer {
    /// The parts.
    pub group: Group,
    /// In words, without what to run next.
    pub said: Sentence,
}

/// Several parts that are the answer; `None` if they can be told apart, or if it is not certain that one of them has failed.
pub fn answer(belief: &Belief<'_, '_>, weights: &Weights, several: &Several<'_>) -> Option<Answer> {
    common_cause(belief, weights, several).or_else(|| group(belief, weights))
}

/// A cause that parts share, with the parts that it reaches: where it is likelier than not, and where two parts that share
/// something are found to have failed. Several effects explain more than one, of whatever is in no dictionary, too: so the
/// part that alone explains the run best is named with them.
fn common_cause(
    belief: &Belief<'_, '_>,
    weights: &Weights,
    several: &Several<'_>,
) -> Option<Answer> {
    let model = belief.model;
    let likely = several.common.first();
    let likely = likely.filter(|cause| cause.probability > 0.5);
    let (shared, reached, alone) = match likely {
        Some(cause) => {
            let alone = alone(model, &several.single);
            (cause.shared, cause.parts.clone(), alone)
        }
        None => {
            let (shared, reached) = shared_by_found(model, weights)?;
            (shared, reached, None)
        }
    };
    let of_cause = |part: &LruId| *part == shared.part || reached.contains(part);
    let alone = alone.filter(|part| !of_cause(part));
    let mut parts = vec![shared.part.clone()];
    parts.extend(reached.iter().filter(|part| **part != shared.part).cloned());
    parts.extend(alone.cloned());
    let probability = weights.any_failed(&parts);
    (probability >= model.settings.found_at).then(|| Answer {
        said: Sentence::common((shared, &reached), alone, probability, model.names),
        group: Group {
            parts,
            measure: shared.measure.clone(),
        },
    })
}

/// What two parts share that are found to have failed, of several the one that reaches the fewest.
fn shared_by_found<'m>(model: &Model<'m>, weights: &Weights) -> Option<(&'m Shared, Vec<LruId>)> {
    let found = weights.failed(model.settings.found_at).into_iter();
    let mut found: Vec<LruId> = found.map(|(part, _)| part.clone()).collect();
    found.sort();
    let all = model.relations.shared.iter();
    let reaching = all.filter(|shared| found.iter().all(|part| shared.reaches.contains(part)));
    let shared = reaching.min_by_key(|shared| shared.reaches.len())?;
    (found.len() > 1).then_some((shared, found))
}

/// The part that alone explains a run best.
fn alone<'d>(model: &Model<'d>, single: &[f64]) -> Option<&'d LruId> {
    let mut of_parts = vec![0.0; model.parts().len()];
    for (hypothesis, probability) in model.hypotheses.iter().zip(single) {
        if let Some(part) = model.part(*hypothesis) {
            of_parts[part] += probability;
        }
    }
    let parts = model.parts().iter().zip(of_parts);
    let best = parts.max_by(|a, b| a.1.total_cmp(&b.1));
    best.map(|(part, _)| *part)
}

fn group(belief: &Belief<'_, '_>, weights: &Weights) -> Option<Answer> {
    let model = belief.model;
    let found_at = model.settings.found_at;
    let found: Vec<&LruId> = weights
        .failed(found_at)
        .into_iter()
        .map(|(part, _)| part)
        .collect();
    let likeliest = || weights.lrus.first().map(|part| &part.lru);
    let first = found.first().copied().or_else(likeliest)?;
    let of_all = model.relations.groups.iter();
    let of_all =
        of_all.filter(|group| group.has(first) && found.iter().all(|part| group.has(part)));
    let with = of_all.map(|group| (group, weights.any_failed(&group.parts)));
    let (group, probability) = with.reduce(|best, next| match next.1 > best.1 {
        true => next,
        false => best,
    })?;
    let is_one = found.len() == 1 && tells_apart(belief, first, group);
    (probability >= found_at && !is_one).then(|| Answer {
        said: Sentence::one_of(group, probability, model.names),
        group: group.clone(),
    })
}

/// Whether what was seen tells a part from the others of a group.
fn tells_apart(belief: &Belief<'_, '_>, part: &LruId, group: &Group) -> bool {
    let signs = belief.signs();
    let mut shown = signs.in_steps.union(&signs.in_log);
    is_as_counted(belief, part)
        || shown.any(|sign| {
            let modes = |part| modes_with(belief.model, sign, part);
            sign.lru.as_ref() == Some(part)
                && modes(part) >= MODES_WITH_SIGN
                && group.others(part).all(|other| modes(other) == 0)
        })
}

/// Whether a part, if it has failed, has more likely than not failed in a way that acts as it was counted. What comes and
/// goes acts otherwise each time.
fn is_as_counted(belief: &Belief<'_, '_>, part: &LruId) -> bool {
    let model = belief.model;
    let (mut counted, mut all) = (0.0, 0.0);
    for (i, probability) in belief.probabilities().into_iter().enumerate() {
        let hypothesis = model.hypotheses[i];
        if model.lru(hypothesis) == Some(part) {
            all += probability;
            if model.is_lasting(hypothesis) {
                counted += probability;
            }
        }
    }
    counted > all / 2.0
}

/// Modes of a part that show a sign.
fn modes_with(model: &Model<'_>, sign: &Sign, part: &LruId) -> usize {
    let modes = model.effects().iter().filter_map(|effect| match *effect {
        Hypothesis::Mode { mode, .. } if model.lru(*effect) == Some(part) => {
            let shown = model.signs(*effect).iter().any(|shown| shown.sign == sign);
            shown.then_some(mode)
        }
        _ => None,
    });
    modes.collect::<BTreeSet<_>>().len()
}
