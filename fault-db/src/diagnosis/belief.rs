//! What is believed after what was seen: a probability for every hypothesis, updated step by step.

use std::collections::BTreeMap;

use super::model::{Hypothesis, Model};
use super::observation::{Observation, StepSeen};

/// Probabilities of all hypotheses, and what they rest on.
#[derive(Clone, Debug)]
pub struct Belief<'m, 'd> {
    /// What it is a belief in.
    pub model: &'m Model<'d>,
    ln: Vec<f64>,
}

/// A part and its probability.
#[derive(Clone, Debug, PartialEq)]
pub struct Suspect<'d> {
    /// The part.
    pub lru: &'d str,
    /// Probability that it has failed.
    pub probability: f64,
}

impl<'m, 'd> Belief<'m, 'd> {
    /// Before anything was seen.
    pub fn new(model: &'m Model<'d>) -> Self {
        Self {
            model,
            ln: model.ln_priors.clone(),
        }
    }

    /// After everything that was seen.
    pub fn after(model: &'m Model<'d>, seen: &Observation) -> Self {
        let mut belief = Self::new(model);
        for step in &seen.steps {
            belief.see(step);
        }
        if !seen.signs.is_empty() {
            for (ln, hypothesis) in belief.ln.iter_mut().zip(&model.hypotheses) {
                *ln += model.ln_log(*hypothesis, &seen.signs);
            }
        }
        belief
    }

    /// Takes a step in; one that the dictionary does not know says nothing.
    pub fn see(&mut self, step: &StepSeen) {
        let Some(place) = self.model.dictionary.place(&step.check) else {
            return;
        };
        for (ln, hypothesis) in self.ln.iter_mut().zip(&self.model.hypotheses) {
            *ln += self.model.ln_likelihood(*hypothesis, place, step);
        }
    }

    /// Probabilities in the order of the model's hypotheses; their sum is 1.
    pub fn probabilities(&self) -> Vec<f64> {
        normalised(&self.ln)
    }

    /// Logarithms that the probabilities are made of.
    pub(super) fn ln(&self) -> &[f64] {
        &self.ln
    }

    /// Probability of one hypothesis that is no mode.
    pub fn probability(&self, of: Hypothesis) -> f64 {
        let all = self.probabilities();
        let hypotheses = self.model.hypotheses.iter();
        hypotheses
            .zip(all)
            .filter(|(h, _)| **h == of)
            .map(|(_, p)| p)
            .sum()
    }

    /// Parts, the likeliest first.
    pub fn suspects(&self) -> Vec<Suspect<'d>> {
        let mut parts: BTreeMap<&'d str, f64> = BTreeMap::new();
        for (hypothesis, p) in self.model.hypotheses.iter().zip(self.probabilities()) {
            if let Some(lru) = self.model.lru(*hypothesis) {
                *parts.entry(lru).or_default() += p;
            }
        }
        let suspects = parts.into_iter();
        let mut suspects: Vec<_> = suspects
            .map(|(lru, probability)| Suspect { lru, probability })
            .collect();
        suspects.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        suspects
    }

    /// Modes by their places, the likeliest first, varieties together.
    pub fn modes(&self) -> Vec<(usize, f64)> {
        let mut modes = vec![0.0; self.model.dictionary.modes.len()];
        for (hypothesis, p) in self.model.hypotheses.iter().zip(self.probabilities()) {
            if let Hypothesis::Mode { mode, .. } = hypothesis {
                modes[*mode] += p;
            }
        }
        let mut modes: Vec<_> = modes.into_iter().enumerate().collect();
        modes.sort_by(|a, b| b.1.total_cmp(&a.1));
        modes
    }

    /// Whether the question is settled: one part found, or the unit healthy.
    pub fn is_settled(&self) -> bool {
        let settings = self.model.settings;
        self.probability(Hypothesis::NoFault) >= settings.healthy_at
            || self
                .suspects()
                .first()
                .is_some_and(|first| first.probability >= settings.found_at)
    }
}

/// Weights given by their logarithms, so that their sum is 1.
pub(super) fn normalised(ln: &[f64]) -> Vec<f64> {
    let greatest = ln.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<_> = ln.iter().map(|ln| (ln - greatest).exp()).collect();
    let sum: f64 = weights.iter().sum();
    weights.into_iter().map(|weight| weight / sum).collect()
}
