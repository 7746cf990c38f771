//! Plausibility check of a controller's input: a value that no train can have brakes the train.

use protocol::config::AtoConfig;

use super::input::{ControllerInput, Demand};

/// Speed of sound, m/s: no train is faster, and no sum of such speeds leaves the range of numbers.
const FASTEST_MPS: f64 = 340.0;
/// A hundred times gravity: no wheel does that.
const HARDEST_MPS2: f64 = 1e3;
/// Masses a unit configuration may have, kg.
const MASSES_KG: core::ops::RangeInclusive<f64> = 1e3..=1e7;

/// Plausibility check, with full braking of the configured train as its answer to an implausible input.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlausibilityCheck {
    decel_mps2: f64,
    empty_kg: f64,
}

impl PlausibilityCheck {
    pub(super) fn new(config: &AtoConfig) -> Self {
        Self {
            decel_mps2: config.decel_kmh_per_s / 3.6,
            empty_kg: config.train.empty_kg + config.train.rotating_kg,
        }
    }

    /// The brake, if mass, a speed, an acceleration, the force granted or a distance of the input is no number or
    /// absurd. The caller's state is to stay as it was, so that one bad cycle leaves no trace.
    pub(super) fn brake(&self, input: &ControllerInput) -> Option<Demand> {
        let mass = MASSES_KG.contains(&input.mass_kg);
        let sound = mass
            && [input.cruise_mps, input.speed_mps]
                .iter()
                .all(|v| libm::fabs(*v) <= FASTEST_MPS)
            && [input.accel_mps2, input.granted_n / input.mass_kg]
                .iter()
                .all(|a| libm::fabs(*a) <= HARDEST_MPS2)
            && input
                .to_stop_m
                .iter()
                .chain(&input.markers_to_stop_m)
                .all(|m| m.is_finite());
        let mass_kg = if mass { input.mass_kg } else { self.empty_kg };
        (!sound).then_some(Demand {
            target_mps: 0.0,
            force_n: -self.decel_mps2 * mass_kg,
        })
    }
}
