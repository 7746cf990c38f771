//! PSS: run at the cruising target until the stop curve is lower, then follow that [S2 §3.2].
//!
//! The target is the printed one: the cruising speed (limit less 5 km/h) or the curve, whichever is
//! lower. How the train is brought there is not printed beyond "100 % powering, less as the target
//! nears". Here:
//! * the force is proportional to the speed error, full effort at `full_effort_error_kmh`, and eased so
//!   that it is gone at the jerk limit when the error is;
//! * in the stop, the curve's deceleration is asked for outright, along a reference that leaves the
//!   cruising speed early enough to meet the curve at the jerk limit ([`super::super::profile`]);
//! * a slow integral takes away what is left. It works only near the target, while effort is not
//!   clipped, and above the speed below which a tachometer says little, so that neither a heavy train
//!   nor the last metre winds it up.

use protocol::config::AtoConfig;

use super::integral::Integral;
use super::plausibility::PlausibilityCheck;
use super::{ControllerInput, Demand, SpeedController};
use crate::ato::profile::{Descent, Setpoint, correction_mps2};

#[derive(Clone, Debug)]
pub struct Pss {
    descent: Descent,
    plausibility: PlausibilityCheck,
    ahead_s: f64,
    gain_per_s: f64,
    jerk_mps3: f64,
    integral_per_s: f64,
    integral_above_mps: f64,
    near_mps: f64,
    /// Integral of the speed error, m/s².
    integral: Integral,
    /// The reference in the station stop.
    stop: Option<Setpoint>,
}

impl Pss {
    /// A controller with the configuration's curve and gains.
    pub fn new(config: &AtoConfig) -> Self {
        let pss = &config.pss;
        Self {
            descent: Descent::new(pss),
            plausibility: PlausibilityCheck::new(config),
            ahead_s: (config.train.dead_time_ms + config.train.lag_ms) / 1000.0,
            gain_per_s: config.decel_kmh_per_s / pss.full_effort_error_kmh,
            jerk_mps3: pss.jerk_mps3,
            integral_per_s: pss.integral_per_s,
            integral_above_mps: pss.integral_above_kmh / 3.6,
            near_mps: pss.full_effort_error_kmh / 3.6,
            integral: Integral::default(),
            stop: None,
        }
    }

    /// The printed target at the train's present place; the inputs are predicted `ahead_s` ahead.
    fn target_mps(&self, input: &ControllerInput) -> f64 {
        let ahead_m = input.speed_mps * self.ahead_s;
        input.to_stop_m.map_or(input.cruise_mps, |distance| {
            let curve_mps = self.descent.curve.at(distance + ahead_m).0;
            input.cruise_mps.min(curve_mps)
        })
    }

    /// The reference: the cruising speed, or a profile from there to the curve and along it.
    fn reference(&mut self, input: &ControllerInput) -> Setpoint {
        let cruise = Setpoint {
            speed_mps: input.cruise_mps.max(0.0),
            accel_mps2: 0.0,
        };
        let from = self.stop.unwrap_or(cruise);
        self.stop = input
            .to_stop_m
            .map(|distance| self.descent.follow(from, distance))
            .filter(|stop| stop.speed_mps < cruise.speed_mps);
        self.stop.unwrap_or(cruise)
    }
}

impl SpeedController for Pss {
    fn step(&mut self, input: &ControllerInput) -> Demand {
        if let Some(brake) = self.plausibility.brake(input) {
            return brake;
        }
        let reference = self.reference(input);
        let error = reference.speed_mps - input.speed_mps;
        let correction_mps2 = correction_mps2(error, self.gain_per_s, self.jerk_mps3);
        let near = libm::fabs(error) < self.near_mps;
        if near && input.speed_mps > self.integral_above_mps {
            let rate = self.gain_per_s * self.integral_per_s * error;
            self.integral.add(rate, input);
        }
        let asked_mps2 = reference.accel_mps2 + correction_mps2 + self.integral.value;
        let most_mps2 = self.descent.most_mps2(input.to_stop_m);
        let force_n = asked_mps2.min(most_mps2) * input.mass_kg;
        self.integral.asked(force_n);
        Demand {
            target_mps: self.target_mps(input),
            force_n,
        }
    }

    /// Distance in which the train slows, m: at the greatest brake, built up at the jerk limit, until the force
    /// goes down with the error. The last of the force is gone after two time constants.
    fn slowing_m(&self, from_mps: f64, to_mps: f64) -> f64 {
        let rate_mps2 = self.gain_per_s * self.near_mps;
        let seconds = (from_mps - to_mps).max(0.0) / rate_mps2
            + rate_mps2 / self.jerk_mps3
            + 2.0 / self.gain_per_s;
        seconds * 0.5 * (from_mps + to_mps)
    }

    fn reset(&mut self) {
        self.integral = Integral::default();
        self.stop = None;
    }
}
