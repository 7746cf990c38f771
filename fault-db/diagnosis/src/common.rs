//! One cause at the places of several parts: a supply, a ground, a link or an air pipe that they share.
//!
//! Each part that it reaches acts as under a fault of its own, more or less. So the cause explains a run where two or more
//! of these parts together do, and where one part alone does not. Which parts it reaches this time is not known: all that
//! the run speaks for are weighed, each of which a failed check or a sign names.

use std::collections::{BTreeMap, BTreeSet};

use protocol::LruId;
use serde::Serialize;

use super::belief::{Belief, ln_sum};
use super::conclusion::Sentence;
use super::observation::Observation;
use super::pairs::Steps;
use super::reasons::{Reason, reasons};
use super::signs::ln_of_any;
use super::verdict::Candidate;
use super::weights::name;

/// Effects that explain a run best, each of which is combined with all others.
const MOST_EXPLAINING: usize = 12;
/// Combinations that are widened by one more part at a time, and the number of parts at most.
const MOST_WIDENED: usize = 6;
const MOST_PARTS: usize = 4;

/// What several parts share.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Shared {
    /// Part to replace where it has failed.
    pub part: LruId,
    /// Parts that it reaches.
    pub reaches: Vec<LruId>,
    /// What to measure, and where.
    pub measure: Sentence,
}

/// A cause that several parts share, as far as a run speaks for it.
#[derive(Clone, Debug)]
pub struct CommonCause<'m> {
    /// What they share.
    pub shared: &'m Shared,
    /// The parts that it most likely reaches, in order.
    pub parts: Vec<LruId>,
    /// Their effects.
    pub effects: Vec<usize>,
    /// Logarithm of its probability, not normalised; then the probability.
    pub probability: f64,
}

impl CommonCause<'_> {
    /// As a fault of the part to replace, with what speaks for each effect.
    pub fn candidate(&self, belief: &Belief<'_, '_>, seen: &Observation) -> Candidate {
        let model = belief.model;
        let effects = self.effects.iter().map(|effect| model.effects()[*effect]);
        let like: Vec<String> = effects
            .clone()
            .map(|effect| name(belief, effect).0)
            .collect();
        let (mut for_it, mut against) = (Vec::new(), Vec::new());
        for why in effects.map(|effect| reasons(belief, effect, seen)) {
            for_it.extend(why.for_it);
            against.extend(why.against);
        }
        // What one effect does not explain, another does.
        for reasons in [&mut for_it, &mut against] {
            let mut seen = BTreeSet::new();
            reasons.retain(|reason: &Reason| seen.insert(reason.said.clone()));
        }
        against.retain(|reason| {
            for_it
                .iter()
                .all(|for_it: &Reason| for_it.said != reason.said)
        });
        Candidate {
            lru: self.shared.part.clone(),
            fault: format!("{}.common", self.shared.part),
            text: format!(
                "one cause at several parts, which acts like {}",
                like.join(" and ")
            ),
            probability: self.probability,
            for_it,
            against,
        }
    }
}

/// A combination of effects of different parts, and the logarithm of its likelihood with its share among all.
#[derive(Clone, Debug)]
struct Combination {
    effects: Vec<usize>,
    ln: f64,
}

/// The causes that parts share, each with the logarithm of its probability, not normalised.
pub fn common_causes<'m>(
    belief: &Belief<'m, '_>,
    steps: &Steps<'_>,
    explaining: &[usize],
) -> Vec<CommonCause<'m>> {
    let model = belief.model;
    let all = &model.relations.shared;
    let share =
        (1.0 - model.settings.no_fault) * model.settings.common_cause / all.len().max(1) as f64;
    let causes = all.iter().filter_map(|shared| {
        let combinations = combinations(belief, steps, explaining, shared);
        let ln = ln_sum(combinations.iter().map(|combination| combination.ln));
        let best = combinations.iter().max_by(|a, b| a.ln.total_cmp(&b.ln))?;
        let mut parts: Vec<LruId> = best
            .effects
            .iter()
            .filter_map(|effect| part_of(belief, *effect))
            .cloned()
            .collect();
        parts.sort();
        Some(CommonCause {
            shared,
            parts,
            effects: best.effects.clone(),
            probability: share.ln() + ln,
        })
    });
    causes.collect()
}

fn part_of<'m>(belief: &Belief<'m, '_>, effect: usize) -> Option<&'m LruId> {
    belief.model.lru(belief.model.effects()[effect])
}

fn combinations(
    belief: &Belief<'_, '_>,
    steps: &Steps<'_>,
    explaining: &[usize],
    shared: &Shared,
) -> Vec<Combination> {
    let model = belief.model;
    // A part that nothing names would explain whatever is left.
    let is_reached = |effect: &usize| {
        let part = part_of(belief, *effect);
        part.is_some_and(|part| shared.reaches.contains(part) && belief.is_named(part))
    };
    let reached: Vec<usize> = explaining.iter().copied().filter(is_reached).collect();
    // Any part that it reaches is as likely, and any effect of the part.
    let ln_share = |effect: usize| {
        let part = model.part(model.effects()[effect]);
        let effects = part.map_or(1, |part| model.effects_of(part).len());
        -(shared.reaches.len() as f64).ln() - (effects as f64).ln()
    };
    let parts: BTreeSet<usize> = reached
        .iter()
        .filter_map(|effect| model.part(model.effects()[*effect]))
        .collect();
    let chances: BTreeMap<usize, Vec<f64>> = parts
        .into_iter()
        .map(|part| (part, belief.signs().chances(model, part)))
        .collect();
    let apart = |effects: &[usize], next: usize| {
        effects
            .iter()
            .all(|effect| part_of(belief, *effect) != part_of(belief, next))
    };
    let combination = |effects: Vec<usize>| {
        let shares: f64 = effects.iter().map(|effect| ln_share(*effect)).sum();
        // They may be taken in any order.
        let orders: f64 = (1..=effects.len()).map(|n| (n as f64).ln()).sum();
        let parts = effects
            .iter()
            .filter_map(|effect| model.part(model.effects()[*effect]));
        let parts: Vec<usize> = parts.collect();
        let chances: Vec<&[f64]> = parts.iter().map(|part| &*chances[part]).collect();
        let suspicion = belief.ln_suspicion(&parts);
        let signs = ln_of_any(&chances);
        Combination {
            ln: shares + orders + steps.ln_of_all(&effects) + signs + suspicion,
            effects,
        }
    };
    let mut all = Vec::new();
    for (i, first) in reached.iter().enumerate().take(MOST_EXPLAINING) {
        let second = reached[i + 1..]
            .iter()
            .filter(|second| apart(&[*first], **second));
        all.extend(second.map(|second| combination(vec![*first, *second])));
    }
    let mut widest = all.clone();
    for _ in 2..MOST_PARTS {
        widest.sort_by(|a, b| b.ln.total_cmp(&a.ln));
        widest.truncate(MOST_WIDENED);
        let mut wider: BTreeMap<Vec<usize>, Combination> = BTreeMap::new();
        for narrow in &widest {
            for next in reached.iter().filter(|next| apart(&narrow.effects, **next)) {
                let mut effects = narrow.effects.clone();
                effects.push(*next);
                effects.sort_unstable();
                wider
                    .entry(effects.clone())
                    .or_insert_with(|| combination(effects));
            }
        }
        widest = wider.into_values().collect();
        all.extend(widest.iter().cloned());
    }
    all
}
