//! A dictionary prepared for diagnosis: hypotheses with priors, and the scale of each measurement.
//!
//! An effect is what a fault does to the checks: the counts of one level of a fault mode. A mode of the dictionary has
//! its own effects; a mode that nobody has seen yet acts more or less like an effect of its part, or of a part whose
//! modes act on the same checks.

mod again;

use std::collections::BTreeMap;

use protocol::{LruId, Verdict};

use super::cell::{Cell, StepOutcome};
use super::dictionary::{Column, Dictionary};
use super::groups::{NO_RELATIONS, Relations};
use super::likelihood::{
    Expected, Scale, likelihood_of_anything, likelihood_of_values, likelihood_without_signs,
};
use super::observation::{ObservedStep, Sign};
use super::outlook::{Outlook, outlooks};
use super::residuals::Residuals;
use super::settings::Settings;
use super::signs::{ShownSign, shown_signs};
use super::suspects::Suspects;
use super::unseen::resemblance;

/// Index of [`Hypothesis::NoFault`] in every model.
pub const NO_FAULT: usize = 0;
/// Index of the first mode in every model.
pub const FIRST_EFFECT: usize = 1;

/// A hypothesis. Modes and levels are given by index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Hypothesis {
    NoFault,
    /// One level of a fault mode.
    Mode {
        mode: usize,
        column: usize,
    },
    /// A fault of a part, given by its index in the model, in a way that is not in the dictionary.
    Unseen {
        part: usize,
    },
}

/// Logarithms of a step's likelihood.
#[derive(Clone, Debug)]
pub struct StepLikelihoods {
    /// On a healthy unit, including the likelihood of the step's signs.
    pub healthy: f64,
    /// Under each effect, without the step's signs, as a sign counts once in a run.
    pub effects: Vec<f64>,
    /// Under a fault that acts more or less like each effect: one that is not in the dictionary, or comes and goes.
    pub like_effects: Vec<f64>,
}

/// A dictionary prepared for diagnosis.
#[derive(Debug)]
pub struct Model<'a> {
    pub dictionary: &'a Dictionary,
    /// Priors and thresholds.
    pub settings: &'a Settings,
    /// All single hypotheses: no fault, the modes, and an unseen mode of each part.
    pub hypotheses: Vec<Hypothesis>,
    /// Logarithms of the hypotheses' priors, in the same order.
    pub ln_priors: Vec<f64>,
    /// Groups of parts, what several parts share, and the signals that each part makes.
    pub relations: &'a Relations,
    parts: Vec<&'a LruId>,
    effects_of_parts: Vec<Vec<usize>>,
    /// Logarithms of the probability that an unseen mode of a part acts like each effect, by part and effect.
    resemblance: Vec<Vec<f64>>,
    /// Possible outcomes of each check, with their probabilities.
    pub outlooks: Vec<Outlook>,
    /// Signs of each effect.
    signs: Vec<Vec<ShownSign<'a>>>,
    /// The parts that failed checks suspect, under an unseen mode of each part.
    pub suspects: Suspects,
    /// The signals at which traces deviate first, under each fault.
    pub residuals: Residuals,
    scales: BTreeMap<usize, BTreeMap<String, Scale>>,
    /// Share of checks that a healthy unit does not pass.
    false_alarms: f64,
    empty: Cell,
}

impl<'a> Model<'a> {
    /// `lru_factor` weights a part's prior by the unit's history; 1 is neutral.
    pub fn new(
        dictionary: &'a Dictionary,
        settings: &'a Settings,
        lru_factor: &BTreeMap<LruId, f64>,
    ) -> Self {
        let parts = dictionary.lrus();
        let weight = |mode: usize| {
            let name = &dictionary.modes[mode].name;
            name.weight * lru_factor.get(&name.lru).copied().unwrap_or(1.0)
        };
        let all: f64 = (0..dictionary.modes.len()).map(weight).sum();
        let faulty = 1.0 - settings.no_fault;
        let seen = faulty * (1.0 - settings.unseen_mode);
        let mut hypotheses = vec![Hypothesis::NoFault];
        let mut priors = vec![settings.no_fault];
        for (mode, entry) in dictionary.modes.iter().enumerate() {
            for column in 0..entry.columns.len() {
                hypotheses.push(Hypothesis::Mode { mode, column });
                priors.push(seen * weight(mode) / all / entry.columns.len() as f64);
            }
        }
        // An unseen mode is equally likely in all parts, but for the unit's history: known modes do not tell how
        // likely.
        let factors = parts
            .iter()
            .map(|lru| lru_factor.get(*lru).copied().unwrap_or(1.0));
        let of_all: f64 = factors.clone().sum();
        for (part, factor) in factors.enumerate() {
            hypotheses.push(Hypothesis::Unseen { part });
            priors.push(faulty * settings.unseen_mode * factor / of_all);
        }
        let effects = &hypotheses[FIRST_EFFECT..hypotheses.len() - parts.len()];
        let lru = |effect: &Hypothesis| match effect {
            Hypothesis::Mode { mode, .. } => Some(&dictionary.modes[*mode].name.lru),
            _ => None,
        };
        let of_part = |part: &&LruId| -> Vec<usize> {
            let effects = effects.iter().enumerate();
            let own = effects.filter(|(_, effect)| lru(effect) == Some(part));
            own.map(|(effect, _)| effect).collect()
        };
        let columns = dictionary.modes.iter().flat_map(|mode| &mode.columns);
        Self {
            dictionary,
            settings,
            effects_of_parts: parts.iter().map(of_part).collect(),
            outlooks: outlooks(dictionary, columns.clone()),
            signs: columns.map(shown_signs).collect(),
            suspects: Suspects::new(dictionary, &parts),
            residuals: Residuals::default(),
            resemblance: resemblance(dictionary, &parts, settings.other_part),
            hypotheses,
            relations: &NO_RELATIONS,
            parts,
            false_alarms: false_alarms(dictionary),
            ln_priors: priors.into_iter().map(f64::ln).collect(),
            scales: scales(dictionary),
            empty: Cell::default(),
        }
    }

    /// Adds how parts depend on each other; without relations, traces are no evidence.
    pub fn with_relations(self, relations: &'a Relations) -> Self {
        let residuals = Residuals::new(self.dictionary, &self.parts, relations, self.settings);
        Self {
            relations,
            residuals,
            ..self
        }
    }

    /// Part that has failed under a hypothesis; `None` if the unit is healthy.
    pub fn lru(&self, hypothesis: Hypothesis) -> Option<&'a LruId> {
        match hypothesis {
            Hypothesis::Mode { mode, .. } => Some(&self.dictionary.modes[mode].name.lru),
            Hypothesis::Unseen { part } => Some(self.parts[part]),
            Hypothesis::NoFault => None,
        }
    }

    /// Index of the part that has failed under a hypothesis; `None` if the unit is healthy.
    pub fn part(&self, hypothesis: Hypothesis) -> Option<usize> {
        let lru = self.lru(hypothesis)?;
        self.parts.binary_search(&lru).ok()
    }

    /// The parts, in order.
    pub fn parts(&self) -> &[&'a LruId] {
        &self.parts
    }

    /// The effects, in order: the hypotheses that are modes.
    pub fn effects(&self) -> &[Hypothesis] {
        &self.hypotheses[FIRST_EFFECT..self.hypotheses.len() - self.parts.len()]
    }

    /// Logarithms of the probability that an unseen mode of a part acts like each effect.
    pub fn resemblance(&self, part: usize) -> &[f64] {
        &self.resemblance[part]
    }

    /// Place of a mode's level among the effects.
    pub fn effect(&self, hypothesis: Hypothesis) -> Option<usize> {
        self.effects().binary_search(&hypothesis).ok()
    }

    /// Signs of a mode at one level; none under the other hypotheses.
    pub fn signs(&self, hypothesis: Hypothesis) -> &[ShownSign<'a>] {
        let effect = self.effect(hypothesis);
        effect.map_or(&[], |effect| &self.signs[effect])
    }

    /// Share of the runs with an effect in which a sign showed.
    pub fn share_of_sign(&self, effect: usize, sign: &Sign) -> f64 {
        let shown = self.signs[effect].iter().find(|shown| shown.sign == sign);
        shown.map_or(0.0, |shown| shown.share)
    }

    /// Shares of the traces in which a signal is the first to deviate: under this hypothesis, and under any fault.
    pub fn share_of_residual(&self, hypothesis: Hypothesis, signal: &str) -> Option<[f64; 2]> {
        let table = &self.residuals;
        let place = table.place(signal)?;
        let own = match hypothesis {
            Hypothesis::NoFault => return None,
            Hypothesis::Mode { .. } => table.of_effect(self.effect(hypothesis)?, place),
            Hypothesis::Unseen { part } => table.of_part(part, place),
        };
        Some([own, table.of_any(place)])
    }

    /// Counts of a mode's level; a healthy unit's under the other hypotheses.
    fn column(&self, hypothesis: Hypothesis) -> &'a Column {
        match hypothesis {
            Hypothesis::Mode { mode, column } => &self.dictionary.modes[mode].columns[column],
            _ => &self.dictionary.healthy,
        }
    }

    /// Whether the check behaves as on a healthy unit under this hypothesis.
    pub fn is_like_healthy(&self, hypothesis: Hypothesis, place: usize) -> bool {
        match hypothesis {
            Hypothesis::Mode { .. } => !self.column(hypothesis).cells.contains_key(&place),
            // No check was counted under the other hypotheses.
            _ => true,
        }
    }

    /// The counts expected of a check under a hypothesis; those of a healthy unit where the hypothesis has none.
    pub fn expected(&self, hypothesis: Hypothesis, place: usize) -> Expected<'_> {
        let column = self.column(hypothesis);
        let own = column.cells.get(&place);
        let cell = own.or_else(|| self.dictionary.healthy.cells.get(&place));
        Expected {
            cell: cell.unwrap_or(&self.empty),
            runs: column.runs,
            doubt: match hypothesis {
                Hypothesis::NoFault => f64::from(column.runs) * self.false_alarms,
                _ => self.settings.doubt_runs,
            },
            settings: &self.settings.likelihood,
        }
    }

    /// Logarithms of a step's likelihood; `place` is the check's index.
    ///
    /// A mode was run few times, and an intermittent one affects another check each time. So, besides what was
    /// counted, now and then a check behaves as under another mode of the same part, or shows anything.
    pub fn ln_likelihoods(&self, place: usize, step: &ObservedStep) -> StepLikelihoods {
        let settings = self.settings;
        let scale = |name: &str| self.scales.get(&place)?.get(name);
        let of = |expected| likelihood_without_signs(expected, step, scale);
        let healthy = self.expected(Hypothesis::NoFault, place);
        let like_healthy = of(healthy);
        let anything = likelihood_of_anything(&settings.likelihood, step, scale);
        let counted =
            self.effects()
                .iter()
                .map(|effect| match self.is_like_healthy(*effect, place) {
                    true => like_healthy,
                    false => of(self.expected(*effect, place)),
                });
        let counted: Vec<f64> = counted.collect();
        let weight = settings.weight_of_step;
        let mut effects = counted.clone();
        let mut like_effects = counted.clone();
        for part in &self.effects_of_parts {
            let of_part: f64 = part.iter().map(|effect| counted[*effect]).sum();
            let same_part = of_part / part.len().max(1) as f64;
            let otherwise = mixed(same_part, anything, settings.anything);
            for effect in part.iter().copied() {
                let ln = |counted, share: f64| weight * mixed(counted, otherwise, share).ln();
                like_effects[effect] = ln(counted[effect], settings.otherwise_unseen);
                effects[effect] = match self.is_intermittent(self.effects()[effect]) {
                    true => like_effects[effect],
                    false => ln(counted[effect], settings.otherwise),
                };
            }
        }
        StepLikelihoods {
            // No `otherwise` here: healthy units were counted in enough runs to know how rarely they fail a check.
            healthy: healthy.signature(&StepOutcome::of(step)).ln()
                + weight * likelihood_of_values(healthy, step, scale).ln(),
            effects,
            like_effects,
        }
    }

    /// Likelihood of a step's measured values under an effect.
    pub fn likelihood_of_values(&self, effect: usize, place: usize, step: &ObservedStep) -> f64 {
        let expected = self.expected(self.effects()[effect], place);
        likelihood_of_values(expected, step, |name| self.scales.get(&place)?.get(name))
    }

    /// Number of a step's values that are far from those counted under an effect, or missing though none was missing
    /// there.
    pub fn far_values(&self, effect: Hypothesis, place: usize, step: &ObservedStep) -> usize {
        let expected = self.expected(effect, place);
        let far = self.settings.counted.far;
        let is_far = |(name, value): &&(String, Option<f64>)| {
            let scale = self.scales.get(&place).and_then(|scales| scales.get(name));
            scale.is_some_and(|scale| expected.is_far(name, *value, scale, far))
        };
        step.values.iter().filter(is_far).count()
    }

    /// Time that a check takes on a healthy unit, s.
    pub fn healthy_time_s(&self, place: usize) -> f64 {
        let cell = self.dictionary.healthy.cells.get(&place);
        cell.map_or(0.0, |cell| cell.time_s)
    }

    /// Whether the hypothesis is an intermittent mode.
    pub fn is_intermittent(&self, hypothesis: Hypothesis) -> bool {
        match hypothesis {
            Hypothesis::Mode { mode, .. } => {
                self.dictionary.modes[mode].name.kind == "intermittent"
            }
            _ => false,
        }
    }
}

/// Mixture of two probabilities; `share` is the weight of `other`.
fn mixed(one: f64, other: f64, share: f64) -> f64 {
    (1.0 - share) * one + share * other
}

/// Share of checks that a healthy unit does not pass. Half a check is added to either outcome (the estimate
/// with Jeffreys' prior), so that the share is neither 0 nor 1: the usual estimate from counts, not a
/// parameter of the bench.
fn false_alarms(dictionary: &Dictionary) -> f64 {
    let cells = dictionary.healthy.cells.values();
    let (wrong, all) = cells.fold((0, 0), |(wrong, all), cell| {
        let passed = cell.count(Verdict::Passed);
        (wrong + cell.runs() - passed, all + cell.runs())
    });
    (f64::from(wrong) + 0.5) / (f64::from(all) + 1.0)
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
