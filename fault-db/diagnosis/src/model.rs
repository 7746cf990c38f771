//! A dictionary prepared for diagnosis: hypotheses with priors, and the scale of each measurement.

use std::collections::BTreeMap;

use protocol::LruId;

use super::cell::Cell;
use super::dictionary::{Column, Dictionary};
use super::likelihood::{Expected, Scale, likelihood, likelihood_of_anything};
use super::observation::ObservedStep;
use super::settings::{LogSettings, Settings};

/// Index of [`Hypothesis::NoFault`] in every model.
pub const NO_FAULT: usize = 0;
/// Index of [`Hypothesis::Unknown`] in every model.
const UNKNOWN: usize = 1;

/// A hypothesis. Modes and levels are given by index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Hypothesis {
    /// Nothing is wrong.
    NoFault,
    /// A fault that is not in the dictionary.
    Unknown,
    /// One level of a fault mode.
    Mode {
        /// The mode.
        mode: usize,
        /// Its level.
        column: usize,
    },
}

/// A dictionary prepared for diagnosis.
#[derive(Debug)]
pub struct Model<'a> {
    /// The dictionary.
    pub dictionary: &'a Dictionary,
    /// Priors and thresholds.
    pub settings: &'a Settings,
    /// All single hypotheses.
    pub hypotheses: Vec<Hypothesis>,
    /// Logarithms of their priors.
    pub ln_priors: Vec<f64>,
    /// Hypotheses of each part, by index.
    parts: Vec<Vec<usize>>,
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
        let mut parts: BTreeMap<&LruId, Vec<usize>> = BTreeMap::new();
        for (i, hypothesis) in hypotheses.iter().enumerate() {
            if let Hypothesis::Mode { mode, .. } = hypothesis {
                let part = &dictionary.modes[*mode].name.lru;
                parts.entry(part).or_default().push(i);
            }
        }
        Self {
            dictionary,
            settings,
            hypotheses,
            parts: parts.into_values().collect(),
            false_alarms: false_alarms(dictionary),
            ln_priors: priors.into_iter().map(f64::ln).collect(),
            scales: scales(dictionary),
            empty: Cell::default(),
        }
    }

    /// Index of a level of a mode among the hypotheses.
    pub fn position(&self, mode: usize, column: usize) -> Option<usize> {
        let sought = Hypothesis::Mode { mode, column };
        self.hypotheses.binary_search(&sought).ok()
    }

    /// Part that has failed under a hypothesis; none of a healthy unit and of an unknown fault.
    pub fn lru(&self, hypothesis: Hypothesis) -> Option<&'a LruId> {
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

    /// Hypotheses of each part, by index.
    pub(super) fn parts(&self) -> &[Vec<usize>] {
        &self.parts
    }

    /// Whether the check behaves as on a healthy unit under this hypothesis.
    pub fn is_like_healthy(&self, hypothesis: Hypothesis, place: usize) -> bool {
        match hypothesis {
            Hypothesis::Mode { .. } => !self.column(hypothesis).cells.contains_key(&place),
            // Effects of an unknown fault were never counted.
            Hypothesis::NoFault | Hypothesis::Unknown => true,
        }
    }

    /// The counts expected of a check under a hypothesis, as far as there are any.
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

    /// Logarithms of a step's likelihood under each hypothesis; `place` is the check's index.
    ///
    /// A mode was run few times, and an intermittent one affects another check each time. So, besides what
    /// was counted, an affected check may behave as on a healthy unit, as under another mode of the same
    /// part, or at random; and an unaffected check may be affected now and then.
    pub fn ln_likelihoods(&self, place: usize, step: &ObservedStep) -> Vec<f64> {
        let settings = self.settings;
        let scale = |name: &str| self.scales.get(&place)?.get(name);
        let counted = |hypothesis| likelihood(self.expected(hypothesis, place), step, scale);
        let anything = likelihood_of_anything(&settings.likelihood, step, scale);
        let healthy = counted(Hypothesis::NoFault);
        let like_healthy = |i: usize| self.is_like_healthy(self.hypotheses[i], place);
        let mut likelihoods = vec![healthy; self.hypotheses.len()];
        likelihoods[UNKNOWN] = mixed(healthy, anything, settings.unknown_hits);
        for part in &self.parts {
            for i in part.iter().filter(|i| !like_healthy(**i)) {
                likelihoods[*i] = counted(self.hypotheses[*i]);
            }
            let same_part = part.iter().map(|i| likelihoods[*i]).sum::<f64>() / part.len() as f64;
            let (same, any) = (settings.doubt_same_part, settings.doubt_anything);
            let hit = (same * same_part + any * anything) / (same + any);
            let otherwise = mixed(healthy, hit, same + any);
            for i in part {
                let doubt = self.doubt(self.hypotheses[*i]);
                likelihoods[*i] = if like_healthy(*i) {
                    mixed(healthy, hit, doubt.new_hits)
                } else {
                    mixed(likelihoods[*i], otherwise, doubt.otherwise)
                };
            }
        }
        let weight = settings.weight_of_step;
        likelihoods.into_iter().map(|p| weight * p.ln()).collect()
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

    fn doubt(&self, hypothesis: Hypothesis) -> Doubt {
        let settings = self.settings;
        let (runs, new_hits) = if self.is_intermittent(hypothesis) {
            (
                settings.doubt_runs_intermittent,
                settings.new_hits_intermittent,
            )
        } else {
            (settings.doubt_runs, settings.new_hits)
        };
        Doubt {
            otherwise: runs / (f64::from(self.column(hypothesis).runs) + runs),
            new_hits,
        }
    }

    /// Logarithm of the likelihood of the signs in a unit's own log. The unit's operation before is unknown,
    /// so a sign that did not show is weak evidence.
    pub fn ln_log(
        &self,
        hypothesis: Hypothesis,
        signs: &std::collections::BTreeSet<super::Sign>,
    ) -> f64 {
        let LogSettings {
            silence,
            stray,
            of_unknown,
        } = self.settings.log;
        if hypothesis == Hypothesis::Unknown {
            return signs.len() as f64 * of_unknown.ln();
        }
        let column = self.column(hypothesis);
        let chance = |count: u32| {
            let share = f64::from(count) / f64::from(column.runs.max(1));
            (stray + (1.0 - stray) * share).min(1.0 - stray)
        };
        let known = |sign| column.signs.iter().find(|(s, _)| s == sign);
        let showing = signs
            .iter()
            .map(|sign| chance(known(sign).map_or(0, |(_, count)| *count)).ln());
        let silent = column
            .signs
            .iter()
            .filter(|(sign, _)| !signs.contains(sign))
            .map(|(_, count)| silence * (1.0 - chance(*count)).ln());
        showing.chain(silent).sum()
    }
}

/// How far a mode may behave otherwise than counted.
struct Doubt {
    /// Share of runs in which an affected check behaves otherwise.
    otherwise: f64,
    /// Share of unaffected checks that it affects nevertheless.
    new_hits: f64,
}

/// A mixture with this share of the second.
fn mixed(one: f64, other: f64, share: f64) -> f64 {
    (1.0 - share) * one + share * other
}

/// Share of checks that a healthy unit does not pass. Half a check is added to either outcome (the estimate
/// with Jeffreys' prior), so that the share is neither 0 nor 1: the usual estimate from counts, not a
/// parameter of the bench.
fn false_alarms(dictionary: &Dictionary) -> f64 {
    let cells = dictionary.healthy.cells.values();
    let (wrong, all) = cells.fold((0, 0), |(wrong, all), cell| {
        let passed = cell.count(protocol::Verdict::Passed);
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
