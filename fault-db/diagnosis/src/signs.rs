//! The likelihood of the signs of a run: the faults that the unit logged or the bench found, each counted once, however
//! many steps it showed in.

use std::collections::{BTreeMap, BTreeSet};

use super::dictionary::Column;
use super::model::{Hypothesis, Model};
use super::observation::Sign;

/// Signs that are evidence.
#[derive(Clone, Debug, Default)]
pub struct SignsSeen {
    /// Signs that showed in steps.
    pub in_steps: BTreeSet<Sign>,
    /// Signs in the unit's own log.
    pub in_log: BTreeSet<Sign>,
    /// Checks that were made, by index.
    pub made: BTreeSet<usize>,
}

impl SignsSeen {
    /// All signs, each once.
    pub fn all(&self) -> impl Iterator<Item = &Sign> {
        self.in_steps.union(&self.in_log)
    }

    /// Logarithm of the signs' likelihood under a hypothesis. Under no fault, only the signs in the log and those that
    /// the tester measures: the likelihood of a step has the other signs already.
    pub fn ln(&self, model: &Model<'_>, hypothesis: Hypothesis) -> f64 {
        match hypothesis {
            Hypothesis::NoFault => {
                let (signs, log) = (&model.settings.signs, &model.settings.log);
                let measured = self.in_steps.iter().filter(|sign| sign.is_measured());
                measured.count() as f64 * signs.measured.ln()
                    + self.in_log.len() as f64 * log.stray.ln()
            }
            Hypothesis::Mode { .. } => self.ln_under(model, &[hypothesis]),
            Hypothesis::Unseen { .. } => {
                let named = model.lru(hypothesis);
                let settings = &model.settings.signs;
                let signs = self
                    .in_steps
                    .iter()
                    .chain(self.in_log.difference(&self.in_steps));
                let of_sign = |sign: &Sign| {
                    let chance = match (&sign.lru, named) {
                        (Some(lru), Some(part)) if lru == part => settings.of_part,
                        _ if sign.is_measured() => settings.measured,
                        _ => settings.of_other_part,
                    };
                    chance.ln()
                };
                signs.map(of_sign).sum()
            }
        }
    }

    /// Logarithm of the signs' likelihood under modes that act at once: each mode shows its signs as often as counted. A sign
    /// that did not show speaks against the modes if a check was made that should have shown it. A sign that is missing in the
    /// unit's log speaks less against them, as it is not known how the unit was used before.
    pub fn ln_under(&self, model: &Model<'_>, modes: &[Hypothesis]) -> f64 {
        let (settings, log) = (&model.settings.signs, &model.settings.log);
        // If several modes show a sign, it shows as often as under the mode that shows it most.
        let mut shown: BTreeMap<&Sign, &ShownSign<'_>> = BTreeMap::new();
        for of_mode in modes.iter().flat_map(|mode| model.signs(*mode)) {
            let most = shown.entry(of_mode.sign).or_insert(of_mode);
            if of_mode.share > most.share {
                *most = of_mode;
            }
        }
        let chance = |sign: &Sign, stray: f64| {
            let stray = match sign.is_measured() {
                true => settings.measured,
                false => stray,
            };
            let share = shown.get(sign).map_or(0.0, |shown| shown.share);
            (stray + (1.0 - stray) * share).min(1.0 - stray).ln()
        };
        let in_steps = self
            .in_steps
            .iter()
            .map(|sign| chance(sign, settings.stray));
        let in_log = self.in_log.difference(&self.in_steps);
        let in_log = in_log.map(|sign| chance(sign, log.stray));
        let silent = shown.values().map(|shown| {
            let weight = if self.in_steps.contains(shown.sign) || self.in_log.contains(shown.sign) {
                0.0
            } else if shown.places.iter().any(|place| self.made.contains(place)) {
                1.0
            } else if self.in_log.is_empty() {
                0.0
            } else {
                log.silence
            };
            weight * (1.0 - shown.share * (1.0 - settings.silent)).ln()
        });
        in_steps.chain(in_log).chain(silent).sum()
    }
}

/// A sign of a mode at one level.
#[derive(Clone, Debug)]
pub struct ShownSign<'a> {
    pub sign: &'a Sign,
    /// Share of the mode's runs in which the sign showed.
    pub share: f64,
    /// Checks in which the sign showed, by index.
    places: BTreeSet<usize>,
}

/// The signs of a mode at one level.
pub fn shown_signs(column: &Column) -> Vec<ShownSign<'_>> {
    let mut places: BTreeMap<&Sign, BTreeSet<usize>> = BTreeMap::new();
    for (place, cell) in &column.cells {
        let shown = cell.signatures.iter().filter(|(_, count)| *count > 0);
        for sign in shown.flat_map(|(shown, _)| &shown.signs) {
            places.entry(sign).or_default().insert(*place);
        }
    }
    let shown = column.signs.iter().map(|(sign, count)| ShownSign {
        sign,
        share: f64::from(*count) / f64::from(column.runs.max(1)),
        places: places.get(sign).cloned().unwrap_or_default(),
    });
    shown.collect()
}
