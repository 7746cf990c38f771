//! Ambiguity groups: parts in a row, such as an antenna, its modem and its processor, that checks alone do not always tell
//! apart, with the measurement that does.
//!
//! Of a group one part is named only if what was seen tells it from the others: the run is as it was counted under a mode
//! of the part, or the log holds a sign that faults of this part show and faults of the others do not. Else the answer is
//! the group.

use std::collections::{BTreeMap, BTreeSet};

use protocol::{LruId, Verdict};
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
    /// Parts that belong to the bench, not to the unit or its train.
    pub of_bench: BTreeSet<LruId>,
    /// Procedures in which the bench has no part.
    pub without_bench: Vec<String>,
    /// Of each signal the parts that make it of others.
    pub makers: BTreeMap<String, BTreeSet<LruId>>,
}

/// Parts that do not depend on each other, as far as is known.
pub static NO_RELATIONS: Relations = Relations {
    groups: Vec::new(),
    shared: Vec::new(),
    of_bench: BTreeSet::new(),
    without_bench: Vec::new(),
    makers: BTreeMap::new(),
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

    /// With the likeliest part first.
    fn likeliest_first(&self, weights: &Weights) -> Self {
        let rank = |part: &LruId| weights.lrus.iter().position(|one| one.lru == *part);
        let mut group = self.clone();
        group
            .parts
            .sort_by_key(|part| rank(part).unwrap_or(usize::MAX));
        group
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
    let others: Vec<LruId> = others.into_iter().collect();
    let (other, more) = others.split_first()?;
    Some(beside(model, (one, probability), (other, more)))
}

/// A part beside which something of others shows, of `other` first: what both share, if they share anything, may be the
/// cause.
fn beside(
    model: &Model<'_>,
    (part, probability): (&LruId, f64),
    (other, more): (&LruId, &[LruId]),
) -> Conclusion {
    let mut others = std::iter::once(other).chain(more);
    let sharing = others.find_map(|other| {
        let shared = model.relations.shared_by([part, other])?;
        Some((other, shared))
    });
    let part = part.clone();
    match sharing {
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
    }
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
    let of_all = of_all.filter(|group| {
        let is_known = |part: &LruId| model.parts().contains(&part);
        let has_all = found.iter().all(|part| group.has(part));
        group.has(first) && has_all && group.parts.iter().all(is_known)
    });
    let with = of_all.map(|group| (group, weights.any_failed(&group.parts)));
    let open = with.filter(|(group, probability)| {
        let is_one = found.len() == 1 && tells_apart(belief, weights, first, group);
        *probability >= found_at && !is_one
    });
    let mut open: Vec<_> = open.collect();
    // The fewest parts first; the likeliest of those.
    open.sort_by(|(one, p), (other, q)| {
        let fewer = one.parts.len().cmp(&other.parts.len());
        fewer.then(q.total_cmp(p))
    });
    let (smallest, _) = open.first()?;
    // A part that is certain, and not told from the others of several groups, is one of all of them.
    let as_few = open
        .iter()
        .filter(|(group, _)| found.len() == 1 && group.parts.len() == smallest.parts.len());
    let all: BTreeSet<&LruId> = as_few.flat_map(|(group, _)| &group.parts).collect();
    let holds_all = |(group, _): &&(&Group, f64)| all.iter().all(|part| group.has(part));
    let (group, probability) = open.iter().find(holds_all).or(open.first())?;
    let elsewhere = belief.residuals().iter().find(|signal| {
        let mut parts = group.parts.iter();
        !parts.any(|part| model.deviates_with(part, signal))
    });
    match elsewhere.and_then(|signal| model.likeliest_of(signal)) {
        Some(other) => Some(beside(model, (first, *probability), (other, &[]))),
        None => Some(Conclusion::OneOf {
            group: group.likeliest_first(weights),
            probability: *probability,
        }),
    }
}

/// Whether what was seen tells a part from the others of a group; a part of the bench that would not be named is none
/// of them.
fn tells_apart(belief: &Belief<'_, '_>, weights: &Weights, part: &LruId, group: &Group) -> bool {
    let relations = belief.model.relations;
    let is_of_bench = |part: &LruId| relations.of_bench.contains(part);
    let told = weights.told();
    let may_be = |part: &LruId| {
        let least = belief.model.settings.conclusion.named_at;
        told.iter()
            .any(|one| one.lru == *part && one.probability >= least)
    };
    let bench: Vec<_> = group
        .parts
        .iter()
        .filter(|part| is_of_bench(part) && may_be(part))
        .collect();
    if !bench.is_empty() && deviates_at_one_of(belief, &bench) {
        // What comes from the bench cannot tell the bench from the part that it comes to.
        return !is_of_bench(part) && fails_without_bench(belief, part);
    }
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

/// Whether a trace deviates first at a signal that one of these parts makes; any trace may where none could be had again.
fn deviates_at_one_of(belief: &Belief<'_, '_>, parts: &[&LruId]) -> bool {
    let makers = &belief.model.relations.makers;
    let made_here = |signal: &String| {
        let makers = makers.get(signal);
        makers.is_some_and(|makers| parts.iter().any(|part| makers.contains(*part)))
    };
    belief.residuals().is_empty() || belief.residuals().iter().any(made_here)
}

/// Whether a step failed that judges the part and that the bench has no part in.
fn fails_without_bench(belief: &Belief<'_, '_>, part: &LruId) -> bool {
    let dictionary = belief.model.dictionary;
    let procedures = &belief.model.relations.without_bench;
    belief.steps().iter().any(|step| {
        let is_judged = dictionary.suspects.get(step.place) == Some(&Some(part.clone()));
        let shown = belief.shown(step.place);
        is_judged
            && procedures.contains(&dictionary.checks[step.place].procedure)
            && shown.is_some_and(|shown| shown.result != Verdict::Passed)
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
