//! How parts depend on each other, and the measurements that tell parts apart where checks alone do not: parts in a
//! row, such as an antenna, its modem and its processor, or parts that share something.

use std::collections::{BTreeMap, BTreeSet};

use protocol::{LruId, Verdict};
use serde::Serialize;

use super::belief::Belief;

/// What to measure, and where: a text of the file of relations.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Measure {
    pub english: String,
    pub korean: String,
}

/// An ambiguity group: parts that checks do not always tell apart, and the measurement that does.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Group {
    pub parts: Vec<LruId>,
    pub measure: Measure,
}

/// What several parts share: a supply, a ground, a link or an air pipe.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Shared {
    /// Part to replace if the shared supply, ground, link or pipe has failed.
    pub part: LruId,
    /// Parts that share it.
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
    /// Procedures that use no part of the bench.
    pub without_bench: Vec<String>,
    /// The parts that make each signal out of other signals.
    pub makers: BTreeMap<String, BTreeSet<LruId>>,
    /// By signal: its input signals that the bench records on their way to the unit. Where a wire of the bench breaks
    /// behind the recording, the first signal to deviate is the one that the unit makes.
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
    /// Whether a part makes this signal out of other signals.
    pub fn makes(&self, part: &LruId, signal: &str) -> bool {
        let makers = self.makers.get(signal);
        makers.is_some_and(|makers| makers.contains(part))
    }

    /// Whether two parts are in one group.
    pub fn are_near(&self, one: &LruId, other: &LruId) -> bool {
        let mut groups = self.groups.iter();
        groups.any(|group| group.parts.contains(one) && group.parts.contains(other))
    }

    /// The measurement that tells `parts` (the likeliest first) apart: of the smallest group with all of them; else, if
    /// one of the parts is shared by the others, the one for that shared part; else of the group that tells the
    /// likeliest from most others. Empty if there is none.
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

/// Parts of the bench in one group with `part` of the unit: a stimulus that does not arrive may be the fault of either.
/// None if traces deviate first at signals that a fault of the bench does not touch, or if a step failed that judges
/// `part` without the bench.
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

/// Whether a trace deviates first at a signal that `bench` makes, or at one made of a signal that the bench records on
/// its way to `part`. True if no trace was compared with a sound unit's, or none deviated.
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

/// Whether a step that judges `part` failed in a procedure without the bench.
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
