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
use super::conclusion::Sentence;
use super::model::{Hypothesis, Model};
use super::observation::Sign;
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

impl Group {
    fn has(&self, part: &LruId) -> bool {
        self.parts.contains(part)
    }

    fn others<'a>(&'a self, part: &'a LruId) -> impl Iterator<Item = &'a LruId> {
        self.parts.iter().filter(move |other| *other != part)
    }
}

/// The group that is the answer, with the probability that one of its parts has failed; `None` if its parts can be told
/// apart, or if it is not certain that one of them has failed.
pub fn answer<'m>(belief: &Belief<'m, '_>, weights: &Weights) -> Option<(&'m Group, f64)> {
    let model = belief.model;
    let found_at = model.settings.found_at;
    let found: Vec<&LruId> = weights
        .failed(found_at)
        .into_iter()
        .map(|(part, _)| part)
        .collect();
    let likeliest = || weights.lrus.first().map(|part| &part.lru);
    let first = found.first().copied().or_else(likeliest)?;
    let of_all = model.groups.iter();
    let of_all =
        of_all.filter(|group| group.has(first) && found.iter().all(|part| group.has(part)));
    let with = of_all.map(|group| (group, weights.any_failed(&group.parts)));
    let (group, probability) = with.reduce(|best, next| match next.1 > best.1 {
        true => next,
        false => best,
    })?;
    let is_one = found.len() == 1 && tells_apart(belief, first, group);
    (probability >= found_at && !is_one).then_some((group, probability))
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
            counted += probability * belief.share_as_counted(hypothesis);
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
