//! A dictionary prepared for diagnosis: hypotheses with priors, and the scale of each measurement.

use std::collections::BTreeMap;

use super::cell::Cell;
use super::dictionary::{Column, Dictionary};
use super::likelihood::{Expected, Scale, likelihood, likelihood_of_anything};
use super::observation::StepSeen;
use super::settings::Settings;

/// Place of [`Hypothesis::NoFault`] in every model.
pub const NO_FAULT: usize = 0;
/// Place of [`Hypothesis::Unknown`] in every model.
const UNKNOWN: usize = 1;

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
    /// Hypotheses of each part, by their places.
    parts: Vec<Vec<usize>>,
    scales: BTreeMap<usize, BTreeMap<String, Scale>>,
    /// Share of checks that a healthy unit does not pass.
    false_alarms: f64,
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
        let mut parts: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
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

    /// Place of a variety of a mode among the hypotheses.
    pub fn position(&self, mode: usize, column: usize) -> Option<usize> {
        let sought = Hypothesis::Mode { mode, column };
        self.hypotheses.binary_search(&sought).ok()
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

    /// Hypotheses of each part, by their places.
    pub(super) fn parts(&self) -> &[Vec<usize>] {
        &self.parts
    }

    /// The hypothesis does at this check what a healthy unit does.
    pub fn is_like_healthy(&self, hypothesis: Hypothesis, place: usize) -> bool {
        match hypothesis {
            Hypothesis::Mode { .. } => !self.column(hypothesis).cells.contains_key(&place),
            // What an unknown fault changes was never counted.
            Hypothesis::NoFault | Hypothesis::Unknown => true,
        }
    }

    /// What a hypothesis expects of a check, as far as it was counted.
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
        }
    }

    /// Logarithms of how likely a step at `place` is under each hypothesis.
    ///
    /// A mode's runs are few, and what comes and goes hits another check each time. So besides what was
    /// counted, a check that a mode changes may do what it does on a healthy unit, what another mode of
    /// the same part makes it do, or anything; and a check that it was never seen to change may all the
    /// same be hit now and then.
    pub fn ln_likelihoods(&self, place: usize, step: &StepSeen) -> Vec<f64> {
        let settings = self.settings;
        let scale = |name: &str| self.scales.get(&place)?.get(name);
        let counted = |hypothesis| likelihood(self.expected(hypothesis, place), step, scale);
        let anything = likelihood_of_anything(step, scale);
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

    /// The hypothesis is a mode that comes and goes.
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

    /// Logarithm of how likely it is that signs showed, and others did not, in a unit's own log: what
    /// it has been through nobody knows, so that what did not show says little.
    pub fn ln_log(
        &self,
        hypothesis: Hypothesis,
        signs: &std::collections::BTreeSet<super::Sign>,
    ) -> f64 {
        /// Weight of a sign that did not show.
        const SILENCE: f64 = 0.2;
        /// Chance of a sign that has nothing to do with the fault: a log holds what testers did, too. The
        /// same under every hypothesis, however many runs stand behind it.
        const STRAY: f64 = 0.02;
        /// Chance of each sign under a fault that stands in no dictionary.
        const OF_UNKNOWN: f64 = 0.1;
        if hypothesis == Hypothesis::Unknown {
            return signs.len() as f64 * OF_UNKNOWN.ln();
        }
        let column = self.column(hypothesis);
        let chance = |count: u32| {
            let share = f64::from(count) / f64::from(column.runs.max(1));
            (STRAY + (1.0 - STRAY) * share).min(1.0 - STRAY)
        };
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

/// How far a mode is to be trusted to do what it was counted to do.
struct Doubt {
    /// Share of runs in which a check that it changes does something else.
    otherwise: f64,
    /// Share of checks it was not seen to change that it hits all the same.
    new_hits: f64,
}

/// One or the other: the other with this share.
fn mixed(one: f64, other: f64, share: f64) -> f64 {
    (1.0 - share) * one + share * other
}

fn false_alarms(dictionary: &Dictionary) -> f64 {
    let cells = dictionary.healthy.cells.values();
    let (wrong, all) = cells.fold((0, 0), |(wrong, all), cell| {
        let passed = cell.count(super::Result::Passed);
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
