//! Approach to the stop curve within the jerk limit, and following it.
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

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Descent {
    pub curve: StopCurve,
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

    /// Greatest acceleration that may be asked for, m/s²: in the last part of the curve the brake is
    /// never released by more than half, so that a train that comes in slow halts there instead of
    /// creeping on at a speed too low to be measured.
    pub fn most_mps2(&self, to_stop_m: Option<f64>) -> f64 {
        to_stop_m
            .and_then(|distance| self.curve.halt_mps2(distance))
            .map_or(f64::INFINITY, |halt| -0.5 * halt)
    }

    /// A cycle after `from`, as fast as the curve allows `to_stop_m` before the stop point.
    pub fn follow(&self, from: Setpoint, to_stop_m: f64) -> Setpoint {
        let dt = CYCLE.as_secs();
        let (speed_mps, accel_mps2) = self.curve.at(to_stop_m);
        let curve = Setpoint {
            speed_mps,
            accel_mps2,
        };
        // The curve is read at the end of the cycle, so the gap is that at the end, too.
        let gap = speed_mps - (from.speed_mps + accel_mps2 * dt).max(0.0);
        let correction_mps2 = correction_mps2(gap, self.gain_per_s, self.jerk_mps3);
        let step = self.jerk_mps3 * dt;
        let met = libm::fabs(correction_mps2) <= step
            && libm::fabs(from.accel_mps2 - accel_mps2) <= 2.0 * step;
        // Or the distance has become known, or shorter, too late to be smooth.
        let late = gap < -self.jerk_mps3 / (self.gain_per_s * self.gain_per_s);
        if met || late {
            return curve;
        }
        let wanted = accel_mps2 + correction_mps2;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::sg100;

    /// A train that follows exactly, from cruising or still accelerating: never over the curve by more
    /// than a cycle's worth, jerk within the limit, and at rest at the stop point.
    #[test]
    fn the_curve_is_met_within_the_jerk_limit() {
        let dt = CYCLE.as_secs();
        for (speed_mps, accel_mps2) in [(20.0, 0.0), (11.1, 0.0), (9.0, 0.6), (3.0, 0.0)] {
            let config = sg100().ato.pss;
            let descent = Descent::new(&config);
            let mut now = Setpoint {
                speed_mps,
                accel_mps2,
            };
            let mut distance_m = 400.0;
            let mut begun = false;
            while distance_m > 0.01 && now.speed_mps > 0.01 {
                let next = descent.follow(now, distance_m);
                begun |= next.accel_mps2 < now.accel_mps2;
                if begun {
                    let jerk = (next.accel_mps2 - now.accel_mps2) / dt;
                    // The curve's own jerk, rate times slope, where the line begins.
                    let most = config
                        .jerk_mps3
                        .max(config.brake_rate_mps2 * config.slope_per_s);
                    assert!(
                        jerk.abs() < 1.1 * most,
                        "{speed_mps}: {jerk} m/s³ at {distance_m} m"
                    );
                    now = next;
                } else {
                    now.speed_mps += now.accel_mps2 * dt;
                }
                let over = now.speed_mps - descent.curve.at(distance_m).0;
                assert!(
                    over < 0.05,
                    "{speed_mps}: over by {over} m/s at {distance_m} m"
                );
                distance_m -= now.speed_mps * dt;
            }
            assert!(
                distance_m.abs() < 0.02,
                "{speed_mps}: ends at {distance_m} m"
            );
        }
    }

    /// The stop point comes nearer by 30 m at 60 km/h: the curve itself, at once.
    #[test]
    fn a_distance_that_shrinks_too_fast_is_braked_for_at_once() {
        let descent = Descent::new(&sg100().ato.pss);
        let from = Setpoint {
            speed_mps: 16.0,
            accel_mps2: 0.0,
        };
        let (speed_mps, accel_mps2) = descent.curve.at(150.0);
        let next = descent.follow(from, 150.0);
        assert_eq!((next.speed_mps, next.accel_mps2), (speed_mps, accel_mps2));
    }

    #[test]
    fn the_correction_is_odd_and_without_a_step() {
        for gap in [0.0, 0.1, 0.1749, 0.1751, 1.0, 20.0] {
            let (up, down) = (
                correction_mps2(gap, 2.0, 0.7),
                correction_mps2(-gap, 2.0, 0.7),
            );
            assert_eq!(up, -down);
            let near = correction_mps2(gap + 1e-6, 2.0, 0.7);
            assert!((near - up).abs() <= 2.1e-6, "{gap}: {up} to {near}");
        }
    }
}
