//! Likelihoods of a check that was made before in the same unit: a repeated outcome is no new evidence, a changed one
//! is.

use super::{Model, StepLikelihoods, mixed};
use crate::cell::StepOutcome;
use crate::observation::ObservedStep;

impl Model<'_> {
    /// Changes the likelihoods `ln` of a check that was made before in the same unit. A lasting fault repeats its
    /// outcome for certain, and so does a check on which an effect does not act; another outcome is nearly impossible
    /// there. An intermittent fault repeats it with the probability of the result. Values weighed before are no
    /// evidence.
    pub fn given_before(
        &self,
        place: usize,
        (before, step): (&StepOutcome, &ObservedStep),
        ln: &mut StepLikelihoods,
    ) {
        let settings = self.settings;
        let anything = settings.likelihood.of(step.result);
        let same = *before == StepOutcome::of(step);
        let changed = before.result != step.result;
        let weighed = |likelihood: f64, otherwise| {
            settings.weight_of_step * mixed(likelihood, anything, otherwise).ln()
        };
        if same {
            ln.healthy = 0.0;
        }
        for (effect, hypothesis) in self.effects().iter().enumerate() {
            let acts = !self.is_like_healthy(*hypothesis, place);
            let expected = self.expected(*hypothesis, place);
            if acts && self.is_intermittent(*hypothesis) {
                if same {
                    let again = expected.result(step.result);
                    ln.like_effects[effect] = weighed(again, settings.otherwise_unseen);
                    ln.effects[effect] = ln.like_effects[effect];
                }
            } else if same || changed {
                let lasting = match (same, acts) {
                    (true, _) => 0.0,
                    (false, true) => weighed(expected.counted(step.result), settings.otherwise),
                    (false, false) => weighed(0.0, settings.otherwise),
                };
                ln.like_effects[effect] = lasting;
                if same || acts {
                    ln.effects[effect] = lasting;
                }
            }
        }
    }
}
