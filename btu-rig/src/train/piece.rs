//! A segment of motion at constant acceleration.

/// Constant acceleration for a part of a scan; the sign of speed never changes within it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Piece {
    /// Duration, s.
    pub seconds: f64,
    /// Speed at its start, m/s, forward positive.
    pub speed_mps: f64,
    /// Acceleration, m/s², forward positive.
    pub accel_mps2: f64,
}

impl Piece {
    /// Standing still for a while.
    pub(super) fn rest(seconds: f64) -> Self {
        Self {
            seconds,
            ..Self::default()
        }
    }

    /// The motion of one step from one speed to another: one piece, or, when it comes to a stand,
    /// the distance there and the rest.
    pub(super) fn between(from_mps: f64, to_mps: f64, dt_s: f64) -> [Self; 2] {
        let accel_mps2 = (to_mps - from_mps) / dt_s;
        let stops = from_mps != 0.0 && to_mps * from_mps <= 0.0;
        let seconds = if stops { -from_mps / accel_mps2 } else { dt_s };
        let moving = Self {
            seconds,
            speed_mps: from_mps,
            accel_mps2,
        };
        [moving, Self::rest(dt_s - seconds)]
    }

    /// Distance covered, m, forward positive.
    pub fn distance_m(&self) -> f64 {
        (self.speed_mps + 0.5 * self.accel_mps2 * self.seconds) * self.seconds
    }

    /// Speed at its end, m/s, forward positive.
    pub fn end_speed_mps(&self) -> f64 {
        self.speed_mps + self.accel_mps2 * self.seconds
    }

    /// Time from its start until `distance_m` has been rolled, s.
    pub(crate) fn time_of_distance(&self, distance_m: f64) -> f64 {
        let sign = if self.distance_m() < 0.0 { -1.0 } else { 1.0 };
        let (speed, accel) = (sign * self.speed_mps, sign * self.accel_mps2);
        // The stable form of the quadratic's root: no difference of near-equal numbers.
        let root = (speed * speed + 2.0 * accel * distance_m).max(0.0).sqrt();
        let seconds = 2.0 * distance_m / (speed + root);
        if seconds.is_finite() {
            seconds.clamp(0.0, self.seconds)
        } else {
            self.seconds
        }
    }
}
