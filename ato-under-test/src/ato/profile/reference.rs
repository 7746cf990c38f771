//! Reference of the controllers that follow a profile over time: S1's jerk-limited ramps between
//! speeds, and the stop curve when that is lower.
//!
//! S1 has no station stop and a train that is never too heavy for its ramp. Added here: the stop by
//! S2's curve (see [`super::descent`]), and a bound on how far the ramp may run ahead of a train
//! that cannot follow it (full train, gradient, constant power). At that bound the ramp goes on from
//! the train's acceleration, so that it ends softly when the train gets there.

use protocol::CYCLE;
use protocol::config::AtoConfig;

use super::{Descent, JerkLimited, Setpoint};

/// Reference for the controller in one cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    pub setpoint: Setpoint,
    pub stopping: bool,
    /// Greatest acceleration that may be asked for, m/s².
    pub most_mps2: f64,
}

/// Generates the reference from cycle to cycle.
#[derive(Clone, Copy, Debug)]
pub struct ReferenceGenerator {
    ramp: JerkLimited,
    descent: Descent,
    lead_mps: f64,
    /// Command of the last cycle, m/s; `None` = not running.
    command_mps: Option<f64>,
}

impl ReferenceGenerator {
    pub fn new(config: &AtoConfig) -> Self {
        Self {
            ramp: JerkLimited::new(&config.profile),
            descent: Descent::new(&config.pss),
            lead_mps: config.profile.lead_kmh / 3.6,
            command_mps: None,
        }
    }

    /// One cycle. `train`: the train's own speed and acceleration; `to_stop_m`: `None` while it is not known.
    pub fn step(&mut self, cruise_mps: f64, train: Setpoint, to_stop_m: Option<f64>) -> Reference {
        let command_mps = cruise_mps.max(0.0);
        self.keep_to_the_train(command_mps, train);
        let from = self.ramp.setpoint();
        if self.ramp.step(command_mps, CYCLE.as_secs()).speed_mps < 0.0 {
            // The jerk limit would lead a train that brakes to its last moment backward.
            self.ramp.place(Setpoint::default());
        }
        let ramp = self.ramp.setpoint();
        let stop = to_stop_m.map(|distance| self.descent.follow(from, distance));
        let lower = stop
            .filter(|stop| stop.accel_mps2 < ramp.accel_mps2 || stop.speed_mps < ramp.speed_mps);
        if let Some(stop) = lower {
            self.ramp.place(stop);
        }
        Reference {
            setpoint: self.ramp.setpoint(),
            stopping: lower.is_some(),
            most_mps2: self.descent.most_mps2(to_stop_m),
        }
    }

    /// Way of the ramp from one speed to a lower one, m.
    pub fn slowing_m(&self, from_mps: f64, to_mps: f64) -> f64 {
        self.ramp.ramp_s(from_mps, to_mps) * 0.5 * (from_mps + to_mps)
    }

    /// Begins the ramp where the train is, and keeps the ramp from running away from the train.
    fn keep_to_the_train(&mut self, command_mps: f64, train: Setpoint) {
        let ramp = self.ramp.setpoint();
        let last_mps = self.command_mps.replace(command_mps);
        let lowered = last_mps.is_some_and(|last| command_mps < last);
        if last_mps.is_none() || lowered && train.speed_mps < ramp.speed_mps {
            // Else a train that never was as fast as its ramp would go on to the old command.
            self.ramp.place(train);
        } else if ramp.speed_mps > train.speed_mps + self.lead_mps {
            // Never more acceleration than its own, which ends at the command.
            self.ramp.place(Setpoint {
                speed_mps: train.speed_mps + self.lead_mps,
                accel_mps2: ramp.accel_mps2.min(train.accel_mps2),
            });
        }
    }

    /// Restarts from the train's speed.
    pub fn reset(&mut self) {
        self.command_mps = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::sg100;

    /// Speed to which a train at `speed_mps` that gains `accel_mps2` is led in a cycle, m/s.
    fn led_to(
        generator: &mut ReferenceGenerator,
        cruise_mps: f64,
        speed_mps: f64,
        accel_mps2: f64,
    ) -> f64 {
        let train = Setpoint {
            speed_mps,
            accel_mps2,
        };
        generator.step(cruise_mps, train, None).setpoint.speed_mps
    }

    /// A train with 0.2 m/s² that believes to have 0.8: the ramp stays within its lead, and ends at the
    /// command.
    #[test]
    fn the_ramp_waits_for_a_slow_train() {
        let mut generator = ReferenceGenerator::new(&sg100().ato);
        let mut speed = 0.0_f64;
        for _ in 0..2400 {
            let ramp = led_to(&mut generator, 15.0, speed, 0.8);
            assert!(ramp <= 15.0 + 1e-9, "{ramp} m/s");
            assert!(
                ramp <= speed + generator.lead_mps + 0.05,
                "{ramp} at {speed} m/s"
            );
            speed = (speed + 0.2 * CYCLE.as_secs()).min(ramp);
        }
        assert_eq!(generator.ramp.setpoint().speed_mps, 15.0);
    }

    /// A train at 0.01 m/s that brakes with 0.8 m/s²: without jerk above the limit it cannot end there.
    #[test]
    fn the_reference_is_never_below_standstill() {
        let mut generator = ReferenceGenerator::new(&sg100().ato);
        for _ in 0..40 {
            let ramp = led_to(&mut generator, 0.0, 0.01, -0.8);
            assert!(ramp >= 0.0, "{ramp} m/s");
        }
    }

    #[test]
    fn a_lower_command_begins_at_the_train() {
        let mut generator = ReferenceGenerator::new(&sg100().ato);
        for _ in 0..400 {
            led_to(&mut generator, 15.0, 9.0, 0.0);
        }
        let after = led_to(&mut generator, 10.0, 9.0, 0.0);
        assert!((9.0..9.1).contains(&after), "{after} m/s");
    }
}
