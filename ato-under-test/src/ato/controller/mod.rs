//! SPR: the speed controllers, all behind the trait [`SpeedController`] [S0 §3.1, S1, S2 §3.2].
//!
//! Each makes its own target speed from the cruising target and the distance to the stop point, and a
//! force that brings the train there. What gravity and resistance by the track database cost is
//! added outside (`feed_forward`); REG limits the sum and tells the controller what was
//! granted.

mod fuzzy;
mod input;
mod integral;
mod pi;
mod plausibility;
mod pole_placement;
mod pss;
mod servo;

use alloc::boxed::Box;
use core::fmt::Debug;

use protocol::config::{AtoConfig, ControllerKind};

use super::profile::{Reference, ReferenceGenerator, Setpoint};
use plausibility::PlausibilityCheck;

pub use fuzzy::Fuzzy;
pub use input::{ControllerInput, Demand};
pub use pi::Pi;
pub use pole_placement::{Gains, place};
pub use pss::Pss;
pub use servo::Servo;

/// Turns a situation into a demand.
pub trait SpeedController: Debug + Send + CloneBoxed {
    fn step(&mut self, input: &ControllerInput) -> Demand;
    /// Way in which the controller brings a train from one cruising speed to a lower one, m.
    fn slowing_m(&self, from_mps: f64, to_mps: f64) -> f64;
    /// Resets the controller's state; the train stands and is not driven.
    fn reset(&mut self);
}

/// Copies a controller with its state, whichever it is.
pub trait CloneBoxed {
    fn clone_boxed(&self) -> Box<dyn SpeedController>;
}

impl<T: SpeedController + Clone + 'static> CloneBoxed for T {
    fn clone_boxed(&self) -> Box<dyn SpeedController> {
        Box::new(self.clone())
    }
}

impl Clone for Box<dyn SpeedController> {
    fn clone(&self) -> Self {
        (**self).clone_boxed()
    }
}

/// What controllers that follow a jerk-limited profile share: the profile, the check of what is measured, and the way
/// from a law's force to a demand.
#[derive(Clone, Debug)]
struct ProfileFollower {
    generator: ReferenceGenerator,
    plausibility: PlausibilityCheck,
    feed_forward: bool,
}

impl ProfileFollower {
    fn new(config: &AtoConfig) -> Self {
        Self {
            generator: ReferenceGenerator::new(config),
            plausibility: PlausibilityCheck::new(config),
            feed_forward: config.profile.feed_forward,
        }
    }

    /// The reference of this cycle, or the brake where the train does not do as it should.
    fn reference(&mut self, input: &ControllerInput) -> Result<Reference, Demand> {
        match self.plausibility.brake(input) {
            Some(brake) => Err(brake),
            None => {
                let train = Setpoint {
                    speed_mps: input.speed_mps,
                    accel_mps2: input.accel_mps2,
                };
                Ok((self.generator).step(input.cruise_mps, train, input.to_stop_m))
            }
        }
    }

    fn demand(&self, reference: &Reference, input: &ControllerInput, law_n: f64) -> Demand {
        let mut force_n = law_n;
        if self.feed_forward || reference.stopping {
            force_n += input.mass_kg * reference.setpoint.accel_mps2;
        }
        Demand {
            target_mps: reference.setpoint.speed_mps,
            force_n: force_n.min(reference.most_mps2 * input.mass_kg),
        }
    }
}

/// The controller a configuration chooses.
pub fn controller(config: &AtoConfig) -> Box<dyn SpeedController> {
    match config.controller {
        ControllerKind::Servo => Box::new(Servo::new(config)),
        ControllerKind::Pi => Box::new(Pi::new(config)),
        ControllerKind::Fuzzy => Box::new(Fuzzy::new(config)),
        ControllerKind::Pss => Box::new(Pss::new(config)),
    }
}
