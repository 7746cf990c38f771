//! Station stop of S0: from PSM2 to PSM4 by eq. (2), from there by eq. (3).
//!
//! Two things differ from the printed text. t_a of eq. (2) is not set by hand but follows from the distance
//! between the markers and the speed at the beginning, so that 1.5 m/s is reached where PSM4 lies: the mean
//! of W is 0.55, so t_a = distance / (0.55·v_end + 0.45·v_begin), 18.04 s for the printed 105 m, 11.1 and 1.5 m/s.
//! Eq. (3), v = 1.5 − 0.33·t, stops in 3.409 m, 9.1 cm short of the 3.5 m; here the rate is the one that
//! stops at the stop point, taken again each cycle from speed and distance left, so that a train that is not where
//! the curve has it still arrives; and it is built up at a jerk that brakes can follow, half of it before
//! PSM4.

use super::Setpoint;

/// Braking by eq. (2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkerApproach {
    from_mps: f64,
    to_mps: f64,
    seconds: f64,
    distance_m: f64,
    elapsed_s: f64,
}

impl MarkerApproach {
    /// From one speed to another over a distance.
    pub fn new(from_mps: f64, to_mps: f64, distance_m: f64) -> Self {
        Self {
            from_mps,
            to_mps,
            seconds: distance_m / (0.55 * to_mps + 0.45 * from_mps),
            distance_m,
            elapsed_s: 0.0,
        }
    }

    /// Greatest speed from which the approach asks for no more than `most_mps2`; its greatest rate is
    /// 1.6·(v − v_end)/t_a.
    pub fn fastest_mps(to_mps: f64, distance_m: f64, most_mps2: f64) -> f64 {
        // 1.6·(v − e)·(0.55·e + 0.45·v) = a·distance, solved for v.
        let (square, linear) = (0.45, (0.55 - 0.45) * to_mps);
        let rest = 0.55 * to_mps * to_mps + most_mps2.max(0.0) * distance_m.max(0.0) / 1.6;
        let root = libm::sqrt(linear * linear + 4.0 * square * rest);
        ((root - linear) / (2.0 * square)).max(to_mps)
    }

    /// Moves on by `dt_s`; gives the target and the distance it has left, m.
    pub fn step(&mut self, dt_s: f64) -> (Setpoint, f64) {
        self.elapsed_s += dt_s;
        let x = (self.elapsed_s / self.seconds).min(1.0);
        let (w, slope, area) = share(x);
        let change = self.to_mps - self.from_mps;
        let after_s = (self.elapsed_s - self.seconds).max(0.0);
        let run_m = self.seconds * (self.from_mps * x + change * area) + after_s * self.to_mps;
        let reference = Setpoint {
            speed_mps: self.from_mps + change * w,
            accel_mps2: change * slope / self.seconds,
        };
        (reference, self.distance_m - run_m)
    }
}

/// W of eq. (2), dW/dx and the integral of W from 0, at x = t/t_a in 0..=1. (In the scanned text of S0 the first branch
/// squares the wrong difference and the second ends in −1/5; only the branches here are continuous.)
fn share(x: f64) -> (f64, f64, f64) {
    if x < 0.25 {
        (16.0 / 5.0 * x * x, 32.0 / 5.0 * x, 16.0 / 15.0 * x * x * x)
    } else if x < 0.5 {
        let y = x - 0.25;
        (
            8.0 / 5.0 * y + 0.2,
            8.0 / 5.0,
            1.0 / 60.0 + 0.2 * y + 0.8 * y * y,
        )
    } else {
        let rest = 1.0 - x;
        (
            1.0 - 8.0 / 5.0 * rest * rest,
            16.0 / 5.0 * rest,
            0.55 - rest + 8.0 / 15.0 * rest * rest * rest,
        )
    }
}

/// From PSM4 to the stop point by eq. (3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FinalStop {
    setpoint: Setpoint,
    rates: FinalStopLimits,
}

/// Distance to the stop point within which the rate stays as it is, or is `rest_mps2` if that is more, m:
/// v²/(2·distance) means nothing at distance 0.
const HOLD_M: f64 = 0.1;

/// Bounds of the last metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FinalStopLimits {
    /// Jerk at which the rate changes, m/s³.
    pub jerk_mps3: f64,
    /// Rate that is never asked to be exceeded, m/s².
    pub most_mps2: f64,
    /// Rate at which the last of the speed is taken away at least, m/s².
    pub rest_mps2: f64,
}

impl FinalStop {
    pub fn new(from: Setpoint, rates: FinalStopLimits) -> Self {
        Self {
            setpoint: from,
            rates,
        }
    }

    /// Distance before PSM4 at which to begin, m, so that the rate is half built up at PSM4, which lies `from_m`
    /// before the stop point.
    pub fn begins_before_m(speed_mps: f64, from_m: f64, jerk_mps3: f64) -> f64 {
        let rate = speed_mps * speed_mps / (2.0 * from_m);
        speed_mps * rate / jerk_mps3 / 2.0
    }

    /// Moves on by `dt_s` with `to_stop_m` left.
    pub fn step(&mut self, dt_s: f64, to_stop_m: f64) -> Setpoint {
        let speed = self.setpoint.speed_mps;
        let wanted = if to_stop_m > HOLD_M {
            -(speed * speed / (2.0 * to_stop_m)).min(self.rates.most_mps2)
        } else {
            self.setpoint.accel_mps2.min(-self.rates.rest_mps2)
        };
        let step = self.rates.jerk_mps3 * dt_s;
        let change = (wanted - self.setpoint.accel_mps2).clamp(-step, step);
        self.setpoint.accel_mps2 += change;
        self.setpoint.speed_mps = (speed + self.setpoint.accel_mps2 * dt_s).max(0.0);
        self.setpoint
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// S0's own numbers: 11.1 → 1.5 m/s in 105 m takes 18.04 s, peak deceleration 3.07 km/h/s, and distance is
    /// the integral of speed.
    #[test]
    fn the_printed_approach_reaches_psm4_at_its_speed() {
        let mut approach = MarkerApproach::new(11.1, 1.5, 105.0);
        assert!((approach.seconds - 18.04).abs() < 0.01);
        let dt = 0.001;
        let (mut distance, mut peak, mut last) = (105.0, 0.0f64, 11.1);
        for _ in 0..18_041 {
            let (reference, left) = approach.step(dt);
            distance -= (reference.speed_mps + last) / 2.0 * dt;
            last = reference.speed_mps;
            peak = peak.max(-reference.accel_mps2 * 3.6);
            assert!((left - distance).abs() < 1e-3);
        }
        assert!(
            (last - 1.5).abs() < 1e-3 && distance.abs() < 0.01,
            "{last} {distance}"
        );
        assert!((peak - 3.07).abs() < 0.01, "{peak}");
    }

    /// S0's own: 11.1 m/s over 105 m asks for 3.07 km/h/s; with less brake the speed must be lower.
    #[test]
    fn a_weaker_brake_allows_a_lower_speed() {
        let printed = MarkerApproach::fastest_mps(1.5, 105.0, 3.066 / 3.6);
        assert!((printed - 11.1).abs() < 0.02, "{printed}");
        let downhill = MarkerApproach::fastest_mps(1.5, 105.0, 0.57);
        let mut approach = MarkerApproach::new(downhill, 1.5, 105.0);
        let rates = (0..4000).map(|_| -approach.step(0.01).0.accel_mps2);
        let peak = rates.fold(0.0, f64::max);
        assert!((peak - 0.57).abs() < 0.005, "{peak}");
    }

    /// A train that follows the setpoint from where the final stop begins: it stops at the stop point, at the rate of
    /// eq. (3) made exact, 1.5²/(2·3.5) = 0.321 m/s², also when its distance is corrected by 10 cm after a second.
    #[test]
    fn the_last_metres_end_at_the_stop_point() {
        for correction in [0.0, -0.1, 0.1] {
            let begins = 3.5 + FinalStop::begins_before_m(1.5, 3.5, 0.8);
            let from = Setpoint {
                speed_mps: 1.5,
                accel_mps2: 0.0,
            };
            let rates = FinalStopLimits {
                jerk_mps3: 0.8,
                most_mps2: 3.5 / 3.6,
                rest_mps2: 0.25,
            };
            let mut last = FinalStop::new(from, rates);
            let (mut distance, mut peak) = (begins, 0.0f64);
            for cycle in 0..400 {
                let before = from.speed_mps.min(last.setpoint.speed_mps);
                let setpoint = last.step(0.05, distance);
                distance -= (before + setpoint.speed_mps) / 2.0 * 0.05;
                peak = peak.max(-setpoint.accel_mps2);
                if cycle == 20 {
                    distance += correction;
                }
            }
            assert!(distance.abs() < 0.01, "{correction}: {distance}");
            assert!((peak - 0.3214).abs() < 0.03, "{correction}: {peak}");
        }
    }
}
