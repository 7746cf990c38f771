//! S-curve between two speeds by time [S0 eq. 1].

/// Shortest time over which an initial acceleration is carried over, s.
const CARRY_S: f64 = 1.0;
/// A target speed and how it changes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Setpoint {
    /// Speed, m/s.
    pub speed_mps: f64,
    /// Acceleration, m/s².
    pub accel_mps2: f64,
}

/// A change of speed. Eq. (1) begins and ends without acceleration; an acceleration that is there when a new target
/// arrives in the middle of a ramp fades away beside the curve, so that the target stays continuous in speed and
/// acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SCurve {
    from_mps: f64,
    to_mps: f64,
    seconds: f64,
    carried_mps2: f64,
    carried_s: f64,
    elapsed_s: f64,
}

impl SCurve {
    /// A curve from a reference to a speed in `seconds` [S0: t_a = 5/6·|Δv| + 11]; an acceleration that the reference
    /// has is taken away at about `jerk_mps3`.
    pub fn new(from: Setpoint, to_mps: f64, seconds: f64, jerk_mps3: f64) -> Self {
        let carried_s = (2.0 * libm::fabs(from.accel_mps2) / jerk_mps3).max(CARRY_S);
        Self {
            from_mps: from.speed_mps,
            to_mps,
            seconds,
            carried_mps2: from.accel_mps2,
            carried_s,
            elapsed_s: 0.0,
        }
    }

    pub fn hold(speed_mps: f64) -> Self {
        let from = Setpoint {
            speed_mps,
            accel_mps2: 0.0,
        };
        let mut curve = Self::new(from, speed_mps, 1.0, 1.0);
        curve.elapsed_s = f64::INFINITY;
        curve
    }

    pub fn target_mps(&self) -> f64 {
        self.to_mps
    }

    pub fn step(&mut self, dt_s: f64) -> Setpoint {
        self.elapsed_s += dt_s;
        self.at(self.elapsed_s)
    }

    fn at(&self, t_s: f64) -> Setpoint {
        let (share, slope) = share(t_s / self.seconds);
        let change = self.to_mps - self.from_mps;
        let mut reference = Setpoint {
            speed_mps: self.from_mps + change * share,
            accel_mps2: change * slope / self.seconds,
        };
        let rest = 1.0 - t_s / self.carried_s;
        if rest > 0.0 {
            // a₀·t·(1 − t/t_c)²: begins with slope a₀, ends flat, adds no speed.
            reference.speed_mps += self.carried_mps2 * t_s * rest * rest;
            reference.accel_mps2 += self.carried_mps2 * rest * (rest - 2.0 * t_s / self.carried_s);
        }
        reference
    }
}

/// W of eq. (1) and dW/dx at x = t/t_a.
fn share(x: f64) -> (f64, f64) {
    if x <= 0.0 {
        (0.0, 0.0)
    } else if x < 0.25 {
        (8.0 / 3.0 * x * x, 16.0 / 3.0 * x)
    } else if x < 0.75 {
        (4.0 / 3.0 * (x - 0.25) + 1.0 / 6.0, 4.0 / 3.0)
    } else if x < 1.0 {
        let rest = 1.0 - x;
        (1.0 - 8.0 / 3.0 * rest * rest, 16.0 / 3.0 * rest)
    } else {
        (1.0, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 0.05;

    fn run(curve: &mut SCurve, seconds: f64) -> alloc::vec::Vec<Setpoint> {
        let cycles = (seconds / DT) as usize;
        (0..cycles).map(|_| curve.step(DT)).collect()
    }

    /// 0 → 60 km/h: 24.9 s, half way at half time, peak 4/3·Δv/t_a = 3.2 km/h/s.
    #[test]
    fn it_is_the_printed_curve() {
        let top = 60.0 / 3.6;
        let seconds = 5.0 / 6.0 * top + 11.0;
        let mut curve = SCurve::new(Setpoint::default(), top, seconds, 0.8);
        let speeds = run(&mut curve, 30.0);
        let at = |s: f64| speeds[(s / DT) as usize - 1];
        assert!((at(seconds / 2.0).speed_mps - top / 2.0).abs() < 0.06);
        assert!((at(12.0).accel_mps2 * 3.6 - 3.21).abs() < 0.01);
        assert_eq!(at(25.5).speed_mps, top);
        assert_eq!(at(25.5).accel_mps2, 0.0);
    }

    /// A lower target arriving at the steepest place: speed and acceleration go on without a step,
    /// jerk stays bounded, and the new target is reached.
    #[test]
    fn a_new_target_in_the_middle_of_a_ramp_is_continuous() {
        let mut curve = SCurve::new(Setpoint::default(), 16.0, 24.0, 0.8);
        let mut last = *run(&mut curve, 10.0).last().unwrap();
        assert!(last.accel_mps2 > 0.85);
        let mut curve = SCurve::new(last, 11.1, 15.0, 0.8);
        for next in run(&mut curve, 20.0) {
            assert!((next.speed_mps - last.speed_mps).abs() < 1.0 * DT);
            assert!((next.accel_mps2 - last.accel_mps2).abs() < 1.9 * DT);
            last = next;
        }
        assert_eq!(last.speed_mps, 11.1);
    }
}
