//! Probability that the fault of a run is one that the dictionary has counted: judged by how far results, values, first
//! deviations and signs are from the counts under the likeliest fault.
//!
//! The question is that of a posterior-predictive check (Rubin 1984); the weights are those of a logistic regression over
//! runs of modes that were counted and of modes that were left out.

use std::collections::BTreeMap;

use super::belief::Belief;
use super::model::FIRST_EFFECT;
use super::observation::Observation;
use super::settings::CountedSettings;

/// What in a run differs from the counts under the likeliest fault of the dictionary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misfit {
    /// Number of checks with a verdict that was seldom counted.
    results: usize,
    /// Number of values far from those counted, or missing though none was missing.
    values: usize,
    /// Share of the traces whose first deviation is at a signal that was seldom the first.
    first: f64,
    /// Number of signs that never showed in a counted run.
    signs: usize,
}

impl Misfit {
    /// How far a run is from the counts; `ln` are the logarithms of the hypotheses' probabilities. `None` if the
    /// dictionary has no faults.
    pub fn of(belief: &Belief<'_, '_>, seen: &Observation, ln: &[f64]) -> Option<Self> {
        let model = belief.model;
        let settings = &model.settings.counted;
        let effects = ln[FIRST_EFFECT..].iter().zip(model.effects()).enumerate();
        let likeliest = effects.max_by(|a, b| a.1.0.total_cmp(b.1.0));
        let (number, (_, likeliest)) = likeliest?;
        // A lasting difference counts once, however often its check was made.
        let mut checks: BTreeMap<usize, (bool, usize)> = BTreeMap::new();
        for weighed in belief.steps() {
            let step = &seen.steps[weighed.seen];
            let expected = model.expected(*likeliest, weighed.place);
            let seldom = expected.is_counted() && expected.result(step.result) < settings.seldom;
            let far = model.far_values(*likeliest, weighed.place, step);
            let (is_seldom, most_far) = checks.entry(weighed.place).or_default();
            *is_seldom |= seldom;
            *most_far = far.max(*most_far);
        }
        let signs = belief.signs().all();
        let never = signs.filter(|sign| model.share_of_sign(number, sign) == 0.0);
        Some(Self {
            results: checks.values().filter(|(seldom, _)| *seldom).count(),
            values: checks.values().map(|(_, far)| far).sum(),
            first: model
                .residuals
                .seldom_first(number, belief.residuals(), settings.seldom_first),
            signs: never.count(),
        })
    }

    /// Probability that the fault is one that the dictionary has counted.
    pub fn counted(&self, settings: &CountedSettings) -> f64 {
        let against = settings.results * (self.results as f64).ln_1p()
            + settings.values * (self.values as f64).ln_1p()
            + settings.first * self.first
            + settings.signs * (self.signs as f64).ln_1p();
        1.0 / (1.0 + (against - settings.as_counted).exp())
    }
}
