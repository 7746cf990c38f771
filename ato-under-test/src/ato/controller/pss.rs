//! PSS: run at the cruising target until the stop curve is lower, then follow that [S2 §3.2].

use protocol::CYCLE;
use protocol::config::AtoConfig;

use super::{Demand, Situation, SpeedController};
use crate::ato::profile::StopCurve;

/// The controller.
#[derive(Debug)]
pub struct Pss {
    curve: StopCurve,
    gain_per_s: f64,
    integral_per_s: f64,
    integral_mps2: f64,
    asked_n: f64,
}

impl Pss {
    /// A controller with the configuration's curve and gains.
    pub fn new(config: &AtoConfig) -> Self {
        Self {
            curve: StopCurve::new(&config.pss),
            gain_per_s: config.decel_kmh_per_s / config.pss.full_effort_error_kmh,
            integral_per_s: config.pss.integral_per_s,
            integral_mps2: 0.0,
            asked_n: 0.0,
        }
    }
}

impl SpeedController for Pss {
    fn step(&mut self, situation: &Situation) -> Demand {
        let stop = situation.to_stop_m.map(|way| self.curve.at(way));
        let (target_mps, accel_mps2) = match stop {
            Some(stop) if stop.0 < situation.cruise_mps => stop,
            _ => (situation.cruise_mps, 0.0),
        };
        let error = target_mps - situation.speed_mps;
        let clipped = libm::fabs(situation.granted_n - self.asked_n) > 0.01 * situation.mass_kg;
        if !clipped {
            self.integral_mps2 += self.gain_per_s * self.integral_per_s * error * CYCLE.as_secs();
        }
        let asked_mps2 = accel_mps2 + self.gain_per_s * error + self.integral_mps2;
        self.asked_n = asked_mps2 * situation.mass_kg;
        Demand {
            target_mps,
            force_n: self.asked_n,
        }
    }

    fn reset(&mut self) {
        self.integral_mps2 = 0.0;
        self.asked_n = 0.0;
    }
}
