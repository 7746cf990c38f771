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
use super::conclusion::Conclusion;
use super::explained::named_beside;
use super::model::{Hypothesis, Model};
use super::observation::Sign;
use super::weights::Weights;

/// What to measure, and where, as the file of relations has it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Measure {
    pub english: String,
    pub korean: String,
}

/// Parts that are not always told apart, and what tells which has failed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Group {
    pub parts: Vec<LruId>,
    pub measure: Measure,
}

/// What several parts share: a supply, a ground, a link or an air pipe.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Shared {
    /// Part to replace where it has failed.
    pub part: LruId,
    /// Parts that it reaches.
    pub reaches: Vec<LruId>,
    pub measure: Measure,
}

/// How parts depend on each other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Relations {
    /// Parts that checks do not always tell apart.
    pub groups: Vec<Group>,
    pub shared: Vec<Shared>,
}

/// Parts that do not depend on each other, as far as is known.
pub static NO_RELATIONS: Relations = Relations {
    groups: Vec::new(),
    shared: Vec::new(),
};

impl Relations {
    /// What two parts share; of several the one that reaches the fewest parts.
    pub fn shared_by(&self, parts: [&LruId; 2]) -> Option<&Shared> {
        let all = self.shared.iter();
        let of_both = all.filter(|shared| parts.iter().all(|part| shared.reaches.contains(part)));
        of_both.min_by_key(|shared| shared.reaches.len())
    }
}

impl Group {
    fn has(&self, part: &LruId) -> bool {
        self.parts.contains(part)
    }

    fn others<'a>(&'a self, part: &'a LruId) -> impl Iterator<Item = &'a LruId> {
        self.parts.iter().filter(move |other| *other != part)
    }
}

/// Several parts that are the answer; `None` if they can be told apart, or if it is not certain that one of them has failed.
pub fn answer(belief: &Belief<'_, '_>, weights: &Weights) -> Option<Conclusion> {
    common_cause(belief.model, weights)
        .or_else(|| group(belief, weights))
        .or_else(|| not_alone(belief, weights))
}

/// A part that is found, where a sign names another part and no fault of the first shows that sign: something that both
/// share may be the cause; and if they share nothing, it is not certain.
fn not_alone(belief: &Belief<'_, '_>, weights: &Weights) -> Option<Conclusion> {
    let model = belief.model;
    let failed = weights.failed(model.settings.found_at);
    let [(one, probability)] = failed[..] else {
        return None;
    };
    let others = named_beside(belief, weights, one);
    let other = others.first()?;
    let sharing = others.iter().find_map(|other| {
        let shared = model.relations.shared_by([one, other])?;
        Some((other, shared))
    });
    let part = one.clone();
    Some(match sharing {
        Some((other, cause)) => Conclusion::OneOrCommon {
            cause: cause.clone(),
            part,
            probability,
            other: other.clone(),
        },
        None => Conclusion::NotAlone {
            part,
            probability,
            other: other.clone(),
        },
    })
}

/// Two parts that are found to have failed and share something: one cause of both is likelier than two faults, and nothing
/// on the bench parts the two.
fn common_cause(model: &Model<'_>, weights: &Weights) -> Option<Conclusion> {
    let found = weights.failed(model.settings.found_at).into_iter();
    let mut found: Vec<&LruId> = found.map(|(part, _)| part).collect();
    found.sort();
    let [one, other] = found[..] else {
        return None;
    };
    let shared = model.relations.shared_by([one, other])?;
    Some(Conclusion::Common {
        cause: shared.clone(),
        parts: [one.clone(), other.clone()],
        probability: weights.both_failed(one, other),
    })
}

/// A group of which one part has failed for certain, unless something tells which.
fn group(belief: &Belief<'_, '_>, weights: &Weights) -> Option<Conclusion> {
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
    (probability >= found_at && !is_one).then(|| Conclusion::OneOf {
        group: group.clone(),
        probability,
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
                && modes(part) >= belief.model.settings.conclusion.modes_with_sign
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
