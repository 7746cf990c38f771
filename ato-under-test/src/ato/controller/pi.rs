//! Proportional-integral control of a jerk-limited profile [S1 §2.3.2]: `T = (K_p + K_i/s)(v* − v)`.
//!
//! Added to the printed law, and why:
//! * the gains scale with the load: printed for 432 t, they would be too hard for an empty train;
//! * the integral rests while effort is clipped and the error asks for still more: a full train on a
//!   gradient, which runs behind its profile for long, would wind it up and then pass the target;
//! * the profile's acceleration is asked for outright (feed-forward): the law alone needs an error of
//!   `M·a/K_p`, 1.2 m/s with the printed gains in m/s, to follow a ramp, and a station stop is a
//!   ramp to its very end. `profile.feed_forward = false` leaves it to the station stop, which S1
//!   has not, and gives the printed law everywhere else;
//! * the station stop ([`super::super::profile`]).

use protocol::config::{AtoConfig, GainUnit};

use super::doubt::Doubt;
use super::integral::Integral;
use super::{Demand, Situation, SpeedController};
use crate::ato::profile::Guide;

/// The controller.
#[derive(Debug)]
pub struct Pi {
    guide: Guide,
    doubt: Doubt,
    feed_forward: bool,
    /// N per m/s at `mass_kg`.
    proportional: f64,
    /// N/s per m/s at `mass_kg`.
    integral_rate: f64,
    mass_kg: f64,
    /// N at `mass_kg`.
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
            guide: Guide::new(config),
            doubt: Doubt::new(config),
            feed_forward: config.profile.feed_forward,
            proportional: pi.proportional_n * per_mps,
            integral_rate: pi.integral_n_per_s * per_mps,
            mass_kg: pi.mass_kg,
            integral: Integral::default(),
        }
    }
}

impl SpeedController for Pi {
    fn step(&mut self, situation: &Situation) -> Demand {
        if let Some(brake) = self.doubt.brake(situation) {
            return brake;
        }
        let guidance = self.guide.step(situation.into());
        let error = guidance.setpoint.speed_mps - situation.speed_mps;
        self.integral.add(self.integral_rate * error, situation);
        let law_n = self.proportional * error + self.integral.value();
        let mut force_n = law_n * situation.mass_kg / self.mass_kg;
        if self.feed_forward || guidance.stopping {
            force_n += situation.mass_kg * guidance.setpoint.accel_mps2;
        }
        force_n = force_n.min(guidance.most_mps2 * situation.mass_kg);
        self.integral.asked(force_n);
        Demand {
            target_mps: guidance.setpoint.speed_mps,
            force_n,
        }
    }

    fn reset(&mut self) {
        self.guide.reset();
        self.integral = Integral::default();
    }
}
