//! How parts depend on each other, and the measurements that tell parts apart which checks alone do not: parts in a row, such
//! as an antenna, its modem and its processor, and what several parts share.

use std::collections::{BTreeMap, BTreeSet};

use protocol::{LruId, Verdict};
use serde::Serialize;

use super::belief::Belief;

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
    /// The parts that make each signal out of other signals.
    pub makers: BTreeMap<String, BTreeSet<LruId>>,
    /// For each signal the signals that it is made of and that the bench records on their way to the unit. A wire of the bench
    /// that breaks behind the place of recording shows first at the signal that the unit makes.
    pub on_the_way: BTreeMap<String, BTreeSet<String>>,
}

/// No relation between parts is known.
pub static NO_RELATIONS: Relations = Relations {
    groups: Vec::new(),
    shared: Vec::new(),
    of_bench: BTreeSet::new(),
    without_bench: Vec::new(),
    makers: BTreeMap::new(),
    on_the_way: BTreeMap::new(),
};

impl Relations {
    /// Whether a part makes a signal of others.
    pub fn makes(&self, part: &LruId, signal: &str) -> bool {
        let makers = self.makers.get(signal);
        makers.is_some_and(|makers| makers.contains(part))
    }

    /// Whether two parts are of one group.
    pub fn are_near(&self, one: &LruId, other: &LruId) -> bool {
        let mut groups = self.groups.iter();
        groups.any(|group| group.parts.contains(one) && group.parts.contains(other))
    }

    /// The measurement that tells `parts` (the likeliest first) apart: the one of the smallest group that has them all; else,
    /// where one of the parts is what the others share, the one for what they share; else the one of the group that tells the
    /// likeliest from most others. Empty where there is none.
    pub fn measure(&self, parts: &[&LruId]) -> Measure {
        let told = |group: &&Group| {
            let told = parts.iter().filter(|part| group.parts.contains(part));
            told.count()
        };
        let groups = || self.groups.iter();
        let of_all = groups().filter(|group| told(group) == parts.len());
        let smallest = of_all.min_by_key(|group| group.parts.len());
        let of_shared = || {
            let is_cause = |shared: &&Shared| {
                let mut parts = parts.iter();
                parts.clone().any(|part| **part == shared.part)
                    && parts.all(|part| **part == shared.part || shared.reaches.contains(part))
            };
            let shared = self.shared.iter().find(is_cause);
            shared.map(|shared| &shared.measure)
        };
        let of_most = || {
            let first = parts.first()?;
            let of_first = groups().filter(|group| group.parts.contains(first) && told(group) > 1);
            let most =
                of_first.max_by_key(|group| (told(group), std::cmp::Reverse(group.parts.len())));
            most.map(|group| &group.measure)
        };
        let measure = smallest.map(|group| &group.measure);
        let measure = measure.or_else(of_shared).or_else(of_most);
        measure.cloned().unwrap_or_default()
    }
}

/// Parts of the bench that stand in one group with a part of the unit: a stimulus that does not arrive may be the fault of
/// either. There are none where traces deviate first at signals that a fault of the bench does not touch, or where a step
/// failed that judges the part of the unit without the bench.
pub fn rivals<'m>(belief: &Belief<'m, '_>, part: &LruId) -> BTreeSet<&'m LruId> {
    let relations = belief.model.relations;
    if relations.of_bench.contains(part) || fails_without_bench(belief, part) {
        return BTreeSet::new();
    }
    let groups = relations.groups.iter();
    let with = groups.filter(|group| group.parts.contains(part));
    let bench = with
        .flat_map(|group| &group.parts)
        .filter(|part| relations.of_bench.contains(*part));
    bench
        .filter(|bench| may_deviate_at(belief, bench, part))
        .collect()
}

/// Whether a trace deviates first at a signal that the part of the bench makes, or at a signal that is made of one which the
/// bench records on its way to the part of the unit. True where no trace was held against a sound unit's, or none deviated.
fn may_deviate_at(belief: &Belief<'_, '_>, bench: &LruId, part: &LruId) -> bool {
    let relations = belief.model.relations;
    let reaches = |from: &String| relations.makes(bench, from) && relations.makes(part, from);
    let shows = |signal: &String| {
        let mut from = relations.on_the_way.get(signal).into_iter().flatten();
        relations.makes(bench, signal) || from.any(reaches)
    };
    let deviating = belief.residuals();
    deviating.is_empty() || deviating.iter().any(shows)
}

/// Whether a step failed that judges the part in a procedure without the bench.
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
