//! Coming down to the stop curve without breaking the jerk limit, and staying on it.
//!
//! Terms: *gap* = speed of the stop curve less the reference's own.
//!
//! The curve of [S2 §3.2] asks for its whole deceleration in the instant it becomes the target,
//! which no brake gives: the train would be over the curve by `B_r²/2J`, 0.25 m/s, before its brake
//! has built up. Added here: the reference begins to slow down so much earlier that at the jerk limit
//! it meets the curve with the curve's deceleration. That is the square root law `a = B_c + sqrt(2·J·gap)`
//! with `B_c` the deceleration of the curve, made linear near the curve where the root is too steep.

use protocol::CYCLE;
use protocol::config::PssConfig;

use super::{Setpoint, StopCurve};

/// The descent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Descent {
    curve: StopCurve,
    jerk_mps3: f64,
    gain_per_s: f64,
}

impl Descent {
    /// The descent to a configuration's curve.
    pub fn new(config: &PssConfig) -> Self {
        Self {
            curve: StopCurve::new(config),
            jerk_mps3: config.jerk_mps3,
            gain_per_s: config.join_per_s,
        }
    }

    /// The curve itself.
    pub fn curve(&self) -> &StopCurve {
        &self.curve
    }

    /// A cycle after `from`, as fast as the curve allows `to_stop_m` before the stop point.
    pub fn follow(&self, from: Setpoint, to_stop_m: f64) -> Setpoint {
        let dt = CYCLE.as_secs();
        let (curve_mps, curve_mps2) = self.curve.at(to_stop_m);
        // The cycle ends where the curve is read, so the gap is that of its end.
        let gap = curve_mps - (from.speed_mps + curve_mps2 * dt).max(0.0);
        if gap < -self.jerk_mps3 / (self.gain_per_s * self.gain_per_s) {
            // The way has become known or shorter too late to be smooth.
            return Setpoint {
                speed_mps: curve_mps,
                accel_mps2: curve_mps2,
            };
        }
        let wanted = curve_mps2 + correction_mps2(gap, self.gain_per_s, self.jerk_mps3);
        let step = self.jerk_mps3 * dt;
        let accel_mps2 = wanted.clamp(from.accel_mps2 - step, from.accel_mps2 + step);
        let change = 0.5 * (from.accel_mps2 + accel_mps2) * dt;
        Setpoint {
            speed_mps: (from.speed_mps + change).max(0.0),
            accel_mps2,
        }
    }
}

/// Acceleration that takes a speed gap away, m/s²: `gain_per_s` times a small one; a greater one at the
/// jerk limit, so that the acceleration is gone when the gap is.
pub fn correction_mps2(gap_mps: f64, gain_per_s: f64, jerk_mps3: f64) -> f64 {
    let linear_mps = jerk_mps3 / (gain_per_s * gain_per_s);
    let size = libm::fabs(gap_mps);
    if size <= linear_mps {
        gain_per_s * gap_mps
    } else {
        let root = libm::sqrt(2.0 * jerk_mps3 * (size - 0.5 * linear_mps));
        libm::copysign(root, gap_mps)
    }
}
