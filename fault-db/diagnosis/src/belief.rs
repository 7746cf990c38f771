//! The posterior probability of each hypothesis, updated step by step with Bayes' rule.

use protocol::LruId;

use super::model::{Model, NO_FAULT};
use super::observation::{Observation, ObservedStep};

/// What the evidence has settled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Settled<'d> {
    /// Nothing is wrong with the unit.
    Healthy,
    /// This part has failed.
    Part(&'d LruId),
}

/// The probabilities of all hypotheses, and the evidence they rest on.
#[derive(Clone, Debug)]
pub struct Belief<'m, 'd> {
    /// What it is a belief in.
    pub model: &'m Model<'d>,
    ln: Vec<f64>,
    steps: Vec<WeighedStep>,
}

/// A step that the dictionary knows, with its likelihoods.
#[derive(Clone, Debug)]
pub(super) struct WeighedStep {
    /// Its index in the observation, or among the steps added.
    pub seen: usize,
    /// Index of its check in the dictionary.
    pub place: usize,
    /// Logarithm of its likelihood under each hypothesis.
    pub ln: Vec<f64>,
}

impl<'m, 'd> Belief<'m, 'd> {
    /// The prior, before any evidence.
    pub fn new(model: &'m Model<'d>) -> Self {
        Self {
            model,
            ln: model.ln_priors.clone(),
            steps: Vec::new(),
        }
    }

    /// The posterior after all evidence.
    pub fn after(model: &'m Model<'d>, seen: &Observation) -> Self {
        let mut belief = Self::new(model);
        for (place, step) in seen.steps.iter().enumerate() {
            belief.see(place, step);
        }
        if !seen.signs.is_empty() {
            for (ln, hypothesis) in belief.ln.iter_mut().zip(&model.hypotheses) {
                *ln += model.ln_log(*hypothesis, &seen.signs);
            }
        }
        belief
    }

    /// Adds the step with this index; a step that the dictionary does not know changes nothing.
    pub fn see(&mut self, number: usize, step: &ObservedStep) {
        let Some(place) = self.model.dictionary.place(&step.check) else {
            return;
        };
        let ln = self.model.ln_likelihoods(place, step);
        for (sum, ln) in self.ln.iter_mut().zip(&ln) {
            *sum += ln;
        }
        self.steps.push(WeighedStep {
            seen: number,
            place,
            ln,
        });
    }

    /// The steps added, each with its likelihoods.
    pub(super) fn steps(&self) -> &[WeighedStep] {
        &self.steps
    }

    /// Probabilities in the order of the model's hypotheses; their sum is 1.
    pub fn probabilities(&self) -> Vec<f64> {
        normalised(&self.ln)
    }

    /// Logarithms of the probabilities, not normalised.
    pub(super) fn ln(&self) -> &[f64] {
        &self.ln
    }

    /// What is settled; `None` while the question is open.
    pub fn answer(&self) -> Option<Settled<'d>> {
        let model = self.model;
        let probabilities = self.probabilities();
        if probabilities[NO_FAULT] >= model.settings.healthy_at {
            return Some(Settled::Healthy);
        }
        let probability = |part: &[usize]| part.iter().map(|i| probabilities[*i]).sum::<f64>();
        let mut parts = model.parts().iter();
        let found = parts.find(|part| probability(part) >= model.settings.found_at)?;
        model
            .lru(model.hypotheses[*found.first()?])
            .map(Settled::Part)
    }

    /// Whether one part is found, or the unit is healthy.
    pub fn is_settled(&self) -> bool {
        self.answer().is_some()
    }
}

/// Normalises weights given by their logarithms.
pub(super) fn normalised(ln: &[f64]) -> Vec<f64> {
    let greatest = ln.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<_> = ln.iter().map(|ln| (ln - greatest).exp()).collect();
    let sum: f64 = weights.iter().sum();
    weights.into_iter().map(|weight| weight / sum).collect()
}
