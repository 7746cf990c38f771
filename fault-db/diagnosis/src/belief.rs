//! The posterior probability of each hypothesis, updated step by step with Bayes' rule.

use std::collections::BTreeMap;

use protocol::LruId;

use super::cell::StepOutcome;
use super::logarithms::{ln_sum, normalised};
use super::model::{FIRST_EFFECT, Hypothesis, Model, NO_FAULT, StepLikelihoods};
use super::observation::{Observation, ObservedStep};
use super::signs::SignsSeen;
use super::suspects::Suspicion;

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
    pub model: &'m Model<'d>,
    /// Logarithms of the likelihood of all steps, without their signs, under each effect.
    effects: Vec<f64>,
    /// Logarithms of the likelihood of all steps, without their signs, under a fault that acts more or less like each effect.
    like_effects: Vec<f64>,
    /// Logarithm of the likelihood of all steps on a healthy unit, with their signs.
    healthy: f64,
    signs: SignsSeen,
    /// The signal that deviated first, for each trace.
    residuals: Vec<String>,
    suspicion: Suspicion,
    /// Last outcome of each check that was made.
    shown: BTreeMap<usize, StepOutcome>,
    steps: Vec<WeighedStep>,
}

/// A step that the dictionary knows, with its likelihoods.
#[derive(Clone, Debug)]
pub(super) struct WeighedStep {
    /// Index of the step in the run, as given to [`Belief::see`].
    pub seen: usize,
    /// Index of its check in the dictionary.
    pub place: usize,
    /// Logarithms of the step's likelihood.
    pub ln: StepLikelihoods,
}

impl<'m, 'd> Belief<'m, 'd> {
    /// The prior, before any evidence.
    pub fn new(model: &'m Model<'d>) -> Self {
        Self {
            model,
            effects: vec![0.0; model.effects().len()],
            like_effects: vec![0.0; model.effects().len()],
            healthy: 0.0,
            signs: SignsSeen::default(),
            residuals: Vec::new(),
            suspicion: Suspicion::default(),
            shown: BTreeMap::new(),
            steps: Vec::new(),
        }
    }

    /// The posterior after all evidence.
    pub fn after(model: &'m Model<'d>, seen: &Observation) -> Self {
        let mut belief = Self::new(model);
        for (place, step) in seen.steps.iter().enumerate() {
            belief.see(place, step);
        }
        belief.signs.in_log.clone_from(&seen.signs);
        belief.residuals.clone_from(&seen.residuals);
        belief
    }

    /// Adds the step with this index; a step that the dictionary does not know changes nothing.
    pub fn see(&mut self, number: usize, step: &ObservedStep) {
        let Some(place) = self.model.dictionary.place(&step.check) else {
            return;
        };
        let outcome = StepOutcome::of(step);
        let mut ln = self.model.ln_likelihoods(place, step);
        if let Some(before) = self.shown.get(&place) {
            self.model.given_before(place, (before, step), &mut ln);
        }
        self.shown.insert(place, outcome);
        self.healthy += ln.healthy;
        for (sum, ln) in self.effects.iter_mut().zip(&ln.effects) {
            *sum += ln;
        }
        for (sum, ln) in self.like_effects.iter_mut().zip(&ln.like_effects) {
            *sum += ln;
        }
        self.signs.made.insert(place);
        self.suspicion.see(self.model.dictionary, place, step);
        self.signs.in_steps.extend(step.signs.iter().cloned());
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

    /// Last outcome of a check.
    pub(super) fn shown(&self, place: usize) -> Option<&StepOutcome> {
        self.shown.get(&place)
    }

    pub(super) fn signs(&self) -> &SignsSeen {
        &self.signs
    }

    /// Probabilities in the order of the model's hypotheses; their sum is 1.
    pub fn probabilities(&self) -> Vec<f64> {
        normalised(&self.ln())
    }

    /// Logarithms of the probabilities, not normalised.
    pub(super) fn ln(&self) -> Vec<f64> {
        let model = self.model;
        let suspicion = model.suspects.ln(&self.suspicion);
        let hypotheses = model.hypotheses.iter().enumerate();
        let of = hypotheses.map(|(i, hypothesis)| {
            let steps = match *hypothesis {
                Hypothesis::NoFault => self.healthy,
                Hypothesis::Mode { .. } => self.effects[i - FIRST_EFFECT],
                Hypothesis::Unseen { part } => {
                    ln_sum(self.like_effects(part)) + model.settings.suspect * suspicion[part]
                }
            };
            let residuals = match *hypothesis {
                Hypothesis::NoFault => model.residuals.ln_healthy(&self.residuals),
                Hypothesis::Mode { .. } => self.ln_residuals(&[i - FIRST_EFFECT]),
                Hypothesis::Unseen { part } => model.residuals.ln_unseen(part, &self.residuals),
            };
            model.ln_priors[i] + steps + residuals + self.signs.ln(model, *hypothesis)
        });
        of.collect()
    }

    /// The signal that deviated first, for each trace.
    pub(super) fn residuals(&self) -> &[String] {
        &self.residuals
    }

    /// Logarithm of the likelihood of the first deviations, where any of these effects may cause each.
    pub(super) fn ln_residuals(&self, effects: &[usize]) -> f64 {
        self.model.residuals.ln_under(effects, &self.residuals)
    }

    /// Logarithm of the likelihood of all steps, without their signs, under an effect.
    pub(super) fn ln_of_effect(&self, effect: usize) -> f64 {
        self.effects[effect]
    }

    /// Like `like_effects()`, with the steps so far weighed by `foresight`: a mode that was not seen yet is no twin of
    /// a known one, so likeness so far says less about checks to come.
    pub(super) fn vaguely_like_effects(&self, part: usize) -> Vec<f64> {
        let alike = self.model.resemblance(part).iter();
        let like = alike.zip(&self.like_effects);
        like.map(|(alike, ln)| alike + self.model.settings.foresight * ln)
            .collect()
    }

    /// Index of the effect of a hypothesis; of an unseen mode, the effect that it most likely acts like.
    pub(super) fn acts_like(&self, hypothesis: Hypothesis) -> Option<usize> {
        match hypothesis {
            Hypothesis::Mode { .. } => self.model.effect(hypothesis),
            Hypothesis::Unseen { part } => {
                let effects = self.like_effects(part).enumerate();
                effects
                    .max_by(|a, b| a.1.total_cmp(&b.1))
                    .map(|(effect, _)| effect)
            }
            Hypothesis::NoFault => None,
        }
    }

    /// Logarithms of the likelihood of all steps under an unseen mode of a part, by the effect that it acts like.
    pub(super) fn like_effects(&self, part: usize) -> impl Iterator<Item = f64> + Clone + '_ {
        let alike = self.model.resemblance(part).iter();
        alike.zip(&self.like_effects).map(|(alike, ln)| alike + ln)
    }

    /// What the evidence has settled; `None` while nothing is settled.
    pub fn answer(&self) -> Option<Settled<'d>> {
        let model = self.model;
        let probabilities = self.probabilities();
        if probabilities[NO_FAULT] >= model.settings.healthy_at {
            return Some(Settled::Healthy);
        }
        let mut parts = vec![0.0; model.parts().len()];
        for (hypothesis, probability) in model.hypotheses.iter().zip(&probabilities) {
            if let Some(part) = model.part(*hypothesis) {
                parts[part] += probability;
            }
        }
        let found = parts
            .iter()
            .position(|part| *part >= model.settings.found_at)?;
        Some(Settled::Part(model.parts()[found]))
    }
}
