//! Proportional-integral control of a jerk-limited profile [S1 §2.3.2]: `T = (K_p + K_i/s)(v* − v)`.
//!
//! Added to the printed law, and why:
//! * the gains scale with the load: printed for 432 t, they would be too hard for an empty train;
//! * the integral rests while effort is clipped and the error asks for still more: a full train on a
//!   gradient, which runs behind its profile for long, would wind it up and then pass the target;
//! * the profile's acceleration is asked for outright (feed-forward): the law alone needs an error of
//!   `M·a/K_p`, 1.2 m/s with the printed gains in m/s, to follow a ramp, and a station stop is a ramp
//!   to its very end. `profile.feed_forward = false` keeps the feed-forward for the station stop,
//!   which S1 lacks, and gives the printed law elsewhere;
//! * the station stop ([`super::super::profile`]).

use protocol::config::{AtoConfig, GainUnit};

use super::integral::Integral;
use super::{ControllerInput, Demand, ProfileFollower, SpeedController};

#[derive(Clone, Debug)]
pub struct Pi {
    follower: ProfileFollower,
    /// Proportional gain, N per m/s at `mass_kg`.
    proportional: f64,
    /// Integral gain, N/s per m/s at `mass_kg`.
    integral_rate: f64,
    mass_kg: f64,
    /// Integral of the speed error, N at `mass_kg`.
    integral: Integral,
}

impl Pi {
    /// A controller with the configuration's gains.
    pub fn new(config: &AtoConfig) -> Self {
        let pi = &config.pi;
        let per_mps = match pi.speed_unit {
            GainUnit::Mps => 1.0,
            GainUnit::Kmh => 3.6,
        };
        Self {
            follower: ProfileFollower::new(config),
            proportional: pi.proportional_n * per_mps,
            integral_rate: pi.integral_n_per_s * per_mps,
            mass_kg: pi.mass_kg,
            integral: Integral::default(),
        }
    }
}

impl SpeedController for Pi {
    fn step(&mut self, input: &ControllerInput) -> Demand {
        let reference = match self.follower.reference(input) {
            Ok(reference) => reference,
            Err(brake) => return brake,
        };
        let error = reference.setpoint.speed_mps - input.speed_mps;
        self.integral.add(self.integral_rate * error, input);
        let law_n = self.proportional * error + self.integral.value;
        let law_n = law_n * input.mass_kg / self.mass_kg;
        let demand = self.follower.demand(&reference, input, law_n);
        self.integral.asked(demand.force_n);
        demand
    }

    fn slowing_m(&self, from_mps: f64, to_mps: f64) -> f64 {
        self.follower.generator.slowing_m(from_mps, to_mps)
    }

    fn reset(&mut self) {
        self.follower.generator.reset();
        self.integral = Integral::default();
    }
}
