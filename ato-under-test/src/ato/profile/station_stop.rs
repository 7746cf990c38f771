//! Station stop of S0: from PSM2 to PSM4 by eq. (2), from there by eq. (3).
//!
//! Two things differ from the printed text. t_a of eq. (2) is not set by hand but follows from the way
//! between the markers and the speed at the beginning, so that 1.5 m/s is reached where PSM4 lies: the mean
//! of W is 0.55, so t_a = way / (0.55·v_end + 0.45·v_begin), 18.04 s for the printed 105 m, 11.1 and 1.5 m/s.
//! Eq. (3), v = 1.5 − 0.33·t, stops in 3.409 m, 9.1 cm short of the 3.5 m; here the rate is the one that
//! stops at the stop point, and speed follows way instead of time, which is the same curve for a train
//! that follows it and corrects one that does not.

use super::Setpoint;

/// Braking by eq. (2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkerApproach {
    from_mps: f64,
    to_mps: f64,
    seconds: f64,
    way_m: f64,
    elapsed_s: f64,
}

impl MarkerApproach {
    /// From a speed to a speed in a way.
    pub fn new(from_mps: f64, to_mps: f64, way_m: f64) -> Self {
        Self {
            from_mps,
            to_mps,
            seconds: way_m / (0.55 * to_mps + 0.45 * from_mps),
            way_m,
            elapsed_s: 0.0,
        }
    }

    /// Moves on by `dt_s`; gives the target and the way it has left, m.
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
        (reference, self.way_m - run_m)
    }
}

/// W of eq. (2), dW/dx and its integral from 0, at x = t/t_a in 0..=1. (The OCR's first branch squares the
/// wrong difference and the second ends in −1/5; only these are continuous.)
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

/// Eq. (3) by way: the speed with `to_stop_m` left, when `from_mps` was had with `from_m` left.
pub fn last_metres(to_stop_m: f64, from_mps: f64, from_m: f64) -> Setpoint {
    let rate = from_mps * from_mps / (2.0 * from_m);
    Setpoint {
        speed_mps: libm::sqrt(2.0 * rate * to_stop_m.max(0.0)),
        accel_mps2: -rate,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// S0's own numbers: 11.1 → 1.5 m/s in 105 m takes 18.04 s, peak deceleration 3.07 km/h/s, and way is
    /// the integral of speed.
    #[test]
    fn the_printed_approach_reaches_psm4_at_its_speed() {
        let mut approach = MarkerApproach::new(11.1, 1.5, 105.0);
        assert!((approach.seconds - 18.04).abs() < 0.01);
        let dt = 0.001;
        let (mut way, mut peak, mut last) = (105.0, 0.0f64, 11.1);
        for _ in 0..18_041 {
            let (reference, left) = approach.step(dt);
            way -= (reference.speed_mps + last) / 2.0 * dt;
            last = reference.speed_mps;
            peak = peak.max(-reference.accel_mps2 * 3.6);
            assert!((left - way).abs() < 1e-3);
        }
        assert!(
            (last - 1.5).abs() < 1e-3 && way.abs() < 0.01,
            "{last} {way}"
        );
        assert!((peak - 3.07).abs() < 0.01, "{peak}");
    }

    #[test]
    fn the_last_metres_end_at_the_stop_point() {
        let first = last_metres(3.5, 1.5, 3.5);
        assert!((first.speed_mps - 1.5).abs() < 1e-12);
        assert!((first.accel_mps2 + 0.3214).abs() < 1e-4);
        assert_eq!(last_metres(0.0, 1.5, 3.5).speed_mps, 0.0);
        assert_eq!(last_metres(-1.0, 1.5, 3.5).speed_mps, 0.0);
    }
}
