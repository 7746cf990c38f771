//! Mamdani fuzzy control of a jerk-limited profile [S1 §2.3.3].
//!
//! Terms: *error* `e` = profile less speed; *change* `Δe` = its rate.
//!
//! The rules are S1's (see [`inference`]); where the triangles stand is not printed and is configuration.
//! Added to the printed law, and why:
//! * the force scales with the load, as in [`super::Pi`];
//! * the profile's acceleration is asked for outright: a law without integral follows a ramp only with
//!   an error, here about half a metre per second. `profile.feed_forward = false` leaves it to
//!   the station stop and gives the printed law everywhere else. S1's finding that fuzzy is better than PI holds for
//!   the printed laws: with feed-forward both controllers have only the disturbance left to correct;
//! * the change is the difference of the profile's acceleration and the train's estimated one: the
//!   difference of two measured speeds 50 ms apart is mostly the tachometer's pulse;
//! * the station stop ([`super::super::profile`]).
//!
//! There is no integral part: what the track database does not tell stays as a small error (35 ‰ about
//! 0.2 m/s), and nothing can wind up.

mod inference;

use protocol::config::AtoConfig;

use super::{ControllerInput, Demand, ProfileFollower, SpeedController};

#[derive(Clone, Debug)]
pub struct Fuzzy {
    follower: ProfileFollower,
    big_error_mps: f64,
    change_mps2: f64,
    force_n: f64,
    mass_kg: f64,
}

impl Fuzzy {
    /// A controller with the configuration's sets.
    pub fn new(config: &AtoConfig) -> Self {
        let fuzzy = &config.fuzzy;
        Self {
            follower: ProfileFollower::new(config),
            big_error_mps: fuzzy.big_error_mps,
            change_mps2: fuzzy.change_mps2,
            force_n: fuzzy.force_n,
            mass_kg: fuzzy.mass_kg,
        }
    }
}

impl SpeedController for Fuzzy {
    fn step(&mut self, input: &ControllerInput) -> Demand {
        let reference = match self.follower.reference(input) {
            Ok(reference) => reference,
            Err(brake) => return brake,
        };
        let error = reference.setpoint.speed_mps - input.speed_mps;
        let change = reference.setpoint.accel_mps2 - input.accel_mps2;
        let share = inference::infer(error / self.big_error_mps, change / self.change_mps2);
        let law_n = share * self.force_n * input.mass_kg / self.mass_kg;
        self.follower.demand(&reference, input, law_n)
    }

    fn slowing_m(&self, from_mps: f64, to_mps: f64) -> f64 {
        self.follower.generator.slowing_m(from_mps, to_mps)
    }

    fn reset(&mut self) {
        self.follower.generator.reset();
    }
}
