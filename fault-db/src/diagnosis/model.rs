//! A dictionary made ready for reading: hypotheses with priors, and the scale of every measurement.

use std::collections::BTreeMap;

use super::cell::Cell;
use super::dictionary::{Column, Dictionary};
use super::likelihood::{Expected, Scale, ln_step, ln_step_unknown};
use super::observation::StepSeen;
use super::settings::Settings;

/// What may be the case. Modes and their varieties are named by their places.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Hypothesis {
    /// Nothing is wrong.
    NoFault,
    /// Something that stands in no dictionary.
    Unknown,
    /// One variety of a fault mode.
    Mode {
        /// The mode.
        mode: usize,
        /// Its variety.
        column: usize,
    },
}

/// A dictionary made ready.
#[derive(Debug)]
pub struct Model<'a> {
    /// The dictionary.
    pub dictionary: &'a Dictionary,
    /// Priors and thresholds.
    pub settings: &'a Settings,
    /// All hypotheses but pairs.
    pub hypotheses: Vec<Hypothesis>,
    /// Logarithms of their priors.
    pub ln_priors: Vec<f64>,
    scales: BTreeMap<usize, BTreeMap<String, Scale>>,
    empty: Cell,
}

impl<'a> Model<'a> {
    /// With `lru_factor`, what a unit's history says of a part: 1 = nothing.
    pub fn new(
        dictionary: &'a Dictionary,
        settings: &'a Settings,
        lru_factor: &BTreeMap<String, f64>,
    ) -> Self {
        let mut hypotheses = vec![Hypothesis::NoFault, Hypothesis::Unknown];
        let weight = |mode: usize| {
            let name = &dictionary.modes[mode].name;
            name.weight * lru_factor.get(&name.lru).copied().unwrap_or(1.0)
        };
        let all: f64 = (0..dictionary.modes.len()).map(weight).sum();
        let known = 1.0 - settings.no_fault - settings.unknown_fault;
        let mut priors = vec![settings.no_fault, settings.unknown_fault];
        for (mode, entry) in dictionary.modes.iter().enumerate() {
            for column in 0..entry.columns.len() {
                hypotheses.push(Hypothesis::Mode { mode, column });
                priors.push(known * weight(mode) / all / entry.columns.len() as f64);
            }
        }
        Self {
            dictionary,
            settings,
            hypotheses,
            ln_priors: priors.into_iter().map(f64::ln).collect(),
            scales: scales(dictionary),
            empty: Cell::default(),
        }
    }

    /// Part a hypothesis puts the blame on.
    pub fn lru(&self, hypothesis: Hypothesis) -> Option<&'a str> {
        match hypothesis {
            Hypothesis::Mode { mode, .. } => Some(&self.dictionary.modes[mode].name.lru),
            _ => None,
        }
    }

    fn column(&self, hypothesis: Hypothesis) -> &'a Column {
        match hypothesis {
            Hypothesis::Mode { mode, column } => &self.dictionary.modes[mode].columns[column],
            _ => &self.dictionary.healthy,
        }
    }

    /// The hypothesis does at this check what a healthy unit does.
    pub fn is_like_healthy(&self, hypothesis: Hypothesis, place: usize) -> bool {
        match hypothesis {
            Hypothesis::Mode { .. } => !self.column(hypothesis).cells.contains_key(&place),
            Hypothesis::NoFault => true,
            Hypothesis::Unknown => false,
        }
    }

    /// What a hypothesis expects of a check.
    pub fn expected(&self, hypothesis: Hypothesis, place: usize) -> Expected<'_> {
        let column = self.column(hypothesis);
        let own = column.cells.get(&place);
        let cell = own.or_else(|| self.dictionary.healthy.cells.get(&place));
        Expected {
            cell: cell.unwrap_or(&self.empty),
            runs: column.runs,
            doubt: self.settings.doubt_runs,
        }
    }

    /// Logarithm of how likely a step at `place` is under a hypothesis.
    pub fn ln_likelihood(&self, hypothesis: Hypothesis, place: usize, step: &StepSeen) -> f64 {
        let expected = self.expected(hypothesis, place);
        let scale = |name: &str| self.scales.get(&place)?.get(name);
        match hypothesis {
            Hypothesis::Unknown => ln_step_unknown(expected, step, scale),
            _ => ln_step(expected, step, scale),
        }
    }

    /// Logarithm of how likely it is that signs showed, and others did not, in a unit's own log: what
    /// it has been through nobody knows, so that what did not show says little.
    pub fn ln_log(
        &self,
        hypothesis: Hypothesis,
        signs: &std::collections::BTreeSet<super::Sign>,
    ) -> f64 {
        /// Weight of a sign that did not show.
        const SILENCE: f64 = 0.2;
        /// Chance of a sign of which nothing is known.
        const STRAY: f64 = 0.02;
        let column = self.column(hypothesis);
        let runs = f64::from(column.runs.min(50));
        let doubt = self.settings.doubt_runs;
        let chance = |count: u32| {
            let share = f64::from(count) / f64::from(column.runs.max(1));
            (runs * share + doubt * STRAY) / (runs + doubt)
        };
        if hypothesis == Hypothesis::Unknown {
            return signs.len() as f64 * (5.0 * STRAY).ln();
        }
        let known = |sign| column.signs.iter().find(|(s, _)| s == sign);
        let showing = signs
            .iter()
            .map(|sign| chance(known(sign).map_or(0, |(_, count)| *count)).ln());
        let silent = column
            .signs
            .iter()
            .filter(|(sign, _)| !signs.contains(sign))
            .map(|(_, count)| SILENCE * (1.0 - chance(*count)).ln());
        showing.chain(silent).sum()
    }
}

fn scales(dictionary: &Dictionary) -> BTreeMap<usize, BTreeMap<String, Scale>> {
    let mut scales: BTreeMap<usize, BTreeMap<String, Scale>> = BTreeMap::new();
    for (place, cell) in &dictionary.healthy.cells {
        let measured = cell.values.iter().filter(|(_, values)| values.n > 0);
        let of_cell = measured.map(|(name, values)| (name.clone(), Scale::of_healthy(values)));
        scales.insert(*place, of_cell.collect());
    }
    for column in dictionary.modes.iter().flat_map(|mode| &mode.columns) {
        for (place, cell) in &column.cells {
            let Some(of_check) = scales.get_mut(place) else {
                continue;
            };
            for (name, values) in &cell.values {
                if let Some(scale) = of_check.get_mut(name) {
                    scale.widen(values);
                }
            }
        }
    }
    scales
}
