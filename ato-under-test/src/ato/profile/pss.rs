//! Station stop by distance [S2 §3.2]: a square root with constant brake rate, then a line.
//!
//! Terms: *join* = where two parts of the curve meet.
//!
//! The two printed parts meet in value and slope: with `T_s = sqrt(2·B_r·(D − E_off))` and
//! `T_s = S_l·D + V_stop` that is at `D = E_off + B_r/(2·S_l²)`, and `V_stop = B_r/(2·S_l) − S_l·E_off`.
//! The line softens the brake as the train comes to its place: its deceleration is `S_l` times the speed.
//!
//! Added to the printed curve: the line passes the stop point with `V_stop` and comes to rest
//! `V_stop/S_l` beyond it, after endless time. So a train leaves the line `V_stop/S_l` before the
//! stop point, where its deceleration `2·S_l·V_stop` is just what halts it there, and keeps that one.
//! This last part meets the line in value and slope, too.

use protocol::config::PssConfig;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopCurve {
    rate_mps2: f64,
    offset_m: f64,
    slope_per_s: f64,
    /// Where square root and line meet, m before the stop point.
    join_m: f64,
    /// Speed of the line at the stop point, m/s.
    stop_mps: f64,
    /// Where the train leaves the line, m before the stop point.
    halt_m: f64,
    /// Deceleration from there, m/s².
    halt_mps2: f64,
}

impl StopCurve {
    pub fn new(config: &PssConfig) -> Self {
        let (rate, slope) = (config.brake_rate_mps2, config.slope_per_s);
        let stop_mps = config.stop_mps();
        Self {
            rate_mps2: rate,
            offset_m: config.offset_m,
            slope_per_s: slope,
            join_m: config.offset_m + rate / (2.0 * slope * slope),
            stop_mps,
            halt_m: stop_mps / slope,
            halt_mps2: 2.0 * slope * stop_mps,
        }
    }

    /// Deceleration that is kept in the last part, where a tachometer tells little of the speed;
    /// `None` before it.
    pub fn halt_mps2(&self, to_stop_m: f64) -> Option<f64> {
        (to_stop_m <= self.halt_m).then_some(self.halt_mps2)
    }

    /// Target speed, m/s, and its rate of change when followed, m/s². Beyond the stop point the speed is 0 and the
    /// brake as hard as on the way there, which holds any gradient a line has.
    pub fn at(&self, to_stop_m: f64) -> (f64, f64) {
        if to_stop_m > self.join_m {
            let speed = libm::sqrt(2.0 * self.rate_mps2 * (to_stop_m - self.offset_m));
            (speed, -self.rate_mps2)
        } else if to_stop_m > self.halt_m {
            let speed = self.slope_per_s * to_stop_m + self.stop_mps;
            (speed, -self.slope_per_s * speed)
        } else if to_stop_m > 0.0 {
            let speed = libm::sqrt(2.0 * self.halt_mps2 * to_stop_m);
            (speed, -self.halt_mps2)
        } else {
            (0.0, -self.rate_mps2)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::sg100;

    const KMH: f64 = 1.0 / 3.6;

    fn curve(rate: f64, offset: f64, slope: f64) -> StopCurve {
        StopCurve::new(&PssConfig {
            brake_rate_mps2: rate,
            offset_m: offset,
            slope_per_s: slope,
            ..sg100().ato.pss
        })
    }

    /// Brake rate, offset and slope; the parts meet where the module's head says.
    #[test]
    fn all_parts_meet_in_value_and_slope() {
        for (rate, offset, slope) in [(0.63, 0.1, 1.2), (0.63, 0.0, 2.0), (0.9, 0.05, 1.0)] {
            let curve = curve(rate, offset, slope);
            for at_m in [curve.join_m, curve.halt_m] {
                let (before, after) = (curve.at(at_m + 1e-7), curve.at(at_m - 1e-7));
                let what = (rate, offset, slope, at_m);
                assert!((before.0 - after.0).abs() < 1e-6, "{what:?} speed");
                assert!((before.1 - after.1).abs() < 1e-6, "{what:?} accel");
            }
        }
    }

    /// The acceleration is the one of a train that follows the speed: a = v·dv/dx.
    #[test]
    fn the_acceleration_belongs_to_the_speed() {
        let curve = curve(0.63, 0.1, 1.2);
        for distance_m in [200.0, 98.0, 10.0, 1.0, 0.3, 0.2, 0.1, 0.01] {
            let h = 1e-6;
            let slope = (curve.at(distance_m + h).0 - curve.at(distance_m - h).0) / (2.0 * h);
            let (speed, accel) = curve.at(distance_m);
            assert!(
                (accel + speed * slope).abs() < 1e-5,
                "{distance_m} m: {accel}"
            );
        }
    }

    /// 40 km/h is the target from 45 km/h of limit; the printed take-over is 98 m before the end of
    /// the 735 m [S2 §3.3].
    #[test]
    fn the_printed_curve_takes_over_at_637_m() {
        let curve = StopCurve::new(&sg100().ato.pss);
        let takes_over = (0..735)
            .map(f64::from)
            .find(|at_m| curve.at(735.0 - at_m).0 < 40.0 * KMH);
        assert!(
            takes_over.is_some_and(|at_m| (at_m - 637.0).abs() <= 3.0),
            "{takes_over:?}"
        );
    }

    #[test]
    fn at_and_past_the_stop_point_the_target_is_standstill_and_the_brake_stays() {
        let curve = StopCurve::new(&sg100().ato.pss);
        for distance_m in [0.0, -0.1, -50.0, f64::NEG_INFINITY] {
            let (speed, accel) = curve.at(distance_m);
            assert_eq!(speed, 0.0);
            assert_eq!(accel, -sg100().ato.pss.brake_rate_mps2);
        }
    }
}
