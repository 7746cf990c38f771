//! First deviations of the traces of a run from those of a sound unit that was given the same stimuli.
//!
//! The parts that make a signal out of other signals (`structure.toml`) are one residual: if that signal is the first
//! to deviate, the signals it is made of did not deviate (de Kleer and Williams, 1987; Pulido and Alonso, 2004).
//! Campaigns count how often each signal is the first under each fault. A fault that is not in the dictionary shows at
//! the signals of its part, at those where known faults of the part show, or where any fault does.

use std::collections::BTreeMap;

use protocol::LruId;

use super::dictionary::{Column, Dictionary};
use super::groups::Relations;
use super::settings::Settings;

/// Assumed traces added to those counted of a level, distributed as for its part; and assumed modes added to those of a
/// part.
const ASSUMED: f64 = 1.0;

/// How likely each signal is to be the first to deviate.
#[derive(Clone, Debug, Default)]
pub struct Residuals {
    /// Place of each signal in the tables below.
    signals: BTreeMap<String, usize>,
    /// Probability of each signal, under each level of each mode, in order.
    of_effects: Vec<Vec<f64>>,
    /// For each level, whether traces were counted.
    counted: Vec<bool>,
    /// Probability of each signal, under a fault of each part that is not in the dictionary.
    of_parts: Vec<Vec<f64>>,
    /// Probability of each signal, whatever the fault.
    of_any: Vec<f64>,
    weight: f64,
}

impl Residuals {
    /// Computes the tables from a dictionary's counts; `parts` are those of the model, in order.
    pub fn new(
        dictionary: &Dictionary,
        parts: &[&LruId],
        relations: &Relations,
        settings: &Settings,
    ) -> Self {
        let columns = || dictionary.modes.iter().flat_map(|mode| &mode.columns);
        let counted = columns().flat_map(|column| column.residuals.keys());
        let all: std::collections::BTreeSet<_> = counted.chain(relations.makers.keys()).collect();
        let signals: BTreeMap<String, usize> = all.into_iter().cloned().zip(0..).collect();
        let shares = |column: &Column| -> Option<Vec<f64>> {
            let traces: u32 = column.residuals.values().sum();
            let share = |signal: &String| {
                let count = column.residuals.get(signal).copied().unwrap_or(0);
                f64::from(count) / f64::from(traces)
            };
            (traces > 0).then(|| signals.keys().map(share).collect())
        };
        let even = vec![1.0 / signals.len().max(1) as f64; signals.len()];
        let of_any = counted_beside(columns().filter_map(shares), &even);
        let of_part = |part: &&LruId| {
            let makes = |signal: &String| f64::from(relations.makes(part, signal));
            let made: Vec<f64> = signals.keys().map(makes).collect();
            let of_ways: f64 = made.iter().sum();
            let assumed = made.iter().zip(&of_any).map(|(made, any)| match of_ways {
                0.0 => *any,
                of_ways => (made / of_ways + any) / 2.0,
            });
            let modes = dictionary.modes.iter();
            let own = modes.filter(|mode| mode.name.lru == **part);
            let shares = own.filter_map(|mode| mean(mode.columns.iter().filter_map(shares)));
            counted_beside(shares, &assumed.collect::<Vec<_>>())
        };
        let of_parts: Vec<Vec<f64>> = parts.iter().map(of_part).collect();
        let of_effects = dictionary.modes.iter().flat_map(|mode| {
            let part = parts.iter().position(|part| **part == mode.name.lru);
            let beside = part.map_or(&of_any, |part| &of_parts[part]);
            let level = |column: &Column| {
                let traces: u32 = column.residuals.values().sum();
                let shares = shares(column).unwrap_or_else(|| beside.clone());
                let n = f64::from(traces);
                let both = shares.iter().zip(beside);
                both.map(|(share, beside)| (n * share + ASSUMED * beside) / (n + ASSUMED))
                    .collect()
            };
            mode.columns.iter().map(level).collect::<Vec<_>>()
        });
        Self {
            of_effects: of_effects.collect(),
            counted: columns()
                .map(|column| !column.residuals.is_empty())
                .collect(),
            of_parts,
            of_any,
            signals: signals.clone(),
            weight: settings.weight_of_residual,
        }
    }

    /// Place of a signal in the tables.
    pub fn place(&self, signal: &str) -> Option<usize> {
        self.signals.get(signal).copied()
    }

    /// Share of the traces `seen` whose first deviation is at a signal that was first in less than `seldom` of the
    /// traces under this effect; 0 if none of its traces were counted.
    pub fn seldom_first(&self, effect: usize, seen: &[String], seldom: f64) -> f64 {
        if !self.counted.get(effect).is_some_and(|counted| *counted) {
            return 0.0;
        }
        let known = seen.iter().filter_map(|signal| self.place(signal));
        let shares: Vec<f64> = known.map(|signal| self.of_effect(effect, signal)).collect();
        let below = shares.iter().filter(|share| **share < seldom).count();
        below as f64 / shares.len().max(1) as f64
    }

    /// Share of the traces under a level of a mode in which a signal is the first to deviate.
    pub fn of_effect(&self, effect: usize, signal: usize) -> f64 {
        self.of_effects[effect][signal]
    }

    /// Share of the traces in which a signal is the first to deviate under a fault of a part that is not in the dictionary.
    pub fn of_part(&self, part: usize, signal: usize) -> f64 {
        self.of_parts[part][signal]
    }

    /// Share of all traces in which a signal is the first to deviate, whatever the fault.
    pub fn of_any(&self, signal: usize) -> f64 {
        self.of_any[signal]
    }

    /// Logarithm of the likelihood of the first deviations `seen`, where any of these effects may cause each.
    pub fn ln_under(&self, effects: &[usize], seen: &[String]) -> f64 {
        self.ln(seen, |signal| {
            let of_each = effects
                .iter()
                .map(|effect| self.of_effects[*effect][signal]);
            of_each.sum::<f64>() / effects.len() as f64
        })
    }

    /// Logarithm of the likelihood of the first deviations `seen`, under a fault of a part that is not in the
    /// dictionary.
    pub fn ln_unseen(&self, part: usize, seen: &[String]) -> f64 {
        self.ln(seen, |signal| self.of_parts[part][signal])
    }

    /// Logarithm of the likelihood of the first deviations `seen` without a fault: a real, sound unit deviates from the
    /// simulated one like a unit with any fault.
    pub fn ln_healthy(&self, seen: &[String]) -> f64 {
        self.ln(seen, |signal| self.of_any[signal])
    }

    fn ln(&self, seen: &[String], chance: impl Fn(usize) -> f64) -> f64 {
        let known = seen.iter().filter_map(|signal| self.place(signal));
        self.weight * known.map(|signal| chance(signal).ln()).sum::<f64>()
    }
}

/// Mean of the counted distributions and an assumed one of weight [`ASSUMED`].
fn counted_beside(counted: impl Iterator<Item = Vec<f64>>, assumed: &[f64]) -> Vec<f64> {
    let mut sums: Vec<f64> = assumed.iter().map(|share| ASSUMED * share).collect();
    let mut all = ASSUMED;
    for shares in counted {
        all += 1.0;
        sums.iter_mut()
            .zip(shares)
            .for_each(|(sum, share)| *sum += share);
    }
    sums.iter_mut().for_each(|sum| *sum /= all);
    sums
}

fn mean(all: impl Iterator<Item = Vec<f64>>) -> Option<Vec<f64>> {
    let all: Vec<_> = all.collect();
    let first = all.first()?;
    let mean = |place: usize| all.iter().map(|one| one[place]).sum::<f64>() / all.len() as f64;
    Some((0..first.len()).map(mean).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Basis, ModeName, Observation};

    /// Goal: the probabilities of all signals add up to 1, whatever was counted, and a fault that nobody has seen shows
    /// at the signals of its own part rather than at another's.
    #[test]
    fn first_deviations_have_probabilities_and_point_at_the_part_that_makes_them() {
        let [relay, board] = ["relay", "board"].map(LruId::from_static);
        let mode = ModeName {
            id: "relay.dead".into(),
            lru: relay.clone(),
            text: "dead".into(),
            kind: "permanent".into(),
            unsafe_: false,
            weight: 1.0,
        };
        let run = Observation {
            residuals: vec!["eb".into(), "eb".into(), "speed".into()],
            ..Observation::default()
        };
        let mut dictionary = Dictionary::new(Basis::default(), vec![1], Vec::new());
        dictionary.add(&mode, "nominal".into(), &[run]);
        let makers = [("eb", &relay), ("doors", &board)];
        let makers = makers.map(|(signal, part)| (signal.to_owned(), [part.clone()].into()));
        let relations = Relations {
            makers: makers.into(),
            ..Relations::default()
        };
        let parts = [&board, &relay];
        let table = Residuals::new(&dictionary, &parts, &relations, &Settings::default());
        for chances in [
            &table.of_effects[0],
            &table.of_parts[0],
            &table.of_parts[1],
            &table.of_any,
        ] {
            assert!(
                (chances.iter().sum::<f64>() - 1.0).abs() < 1e-12,
                "{chances:?}"
            );
        }
        let ln = |part, signal: &str| table.ln_unseen(part, &[signal.to_owned()]);
        assert!(ln(1, "eb") > ln(0, "eb") && ln(0, "doors") > ln(1, "doors"));
        // An unknown signal is no evidence.
        assert_eq!(ln(0, "temperature"), 0.0);
    }
}
