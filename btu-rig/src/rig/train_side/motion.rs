//! Motion of a wheel in one scan, exact enough to time each pulse within it.
//!
//! Distance: rolled whatever the direction, never falling. Position: forward counts up,
//! backward down.

use crate::train::Piece;

/// Pieces one scan can need: three segments of a travel and the rest after it.
const MAX_PIECES: usize = 4;

#[derive(Clone, Copy, Debug, Default)]
pub struct Motion {
    pieces: [Piece; MAX_PIECES],
    len: usize,
    seconds: f64,
    /// Distance at the scan's start, m.
    pub distance_before_m: f64,
    /// Distance at its end, m.
    pub distance_m: f64,
    /// Position at the scan's start, m.
    pub position_before_m: f64,
    /// Position at its end, m.
    pub position_m: f64,
}

impl Motion {
    /// Begins the next scan where this one ended.
    pub fn begin_scan(&mut self) {
        self.len = 0;
        self.seconds = 0.0;
        self.distance_before_m = self.distance_m;
        self.position_before_m = self.position_m;
    }

    /// Adds a piece to the scan.
    pub fn roll(&mut self, piece: Piece) {
        let distance = piece.distance_m();
        self.distance_m += distance.abs();
        self.position_m += distance;
        self.seconds += piece.seconds;
        assert!(
            self.len < MAX_PIECES,
            "a scan of more than {MAX_PIECES} pieces"
        );
        self.pieces[self.len] = piece;
        self.len += 1;
    }

    /// Moves the end of the scan by what rounding has added up, so that a whole travel is exact.
    pub fn correct(&mut self, distance_m: f64, position_m: f64) {
        self.distance_m = distance_m.max(self.distance_before_m);
        self.position_m = position_m;
    }

    /// The motion of something that moves with this one but for a constant difference in distance.
    pub fn shifted(&self, distance_m: f64) -> Self {
        Self {
            distance_before_m: self.distance_before_m + distance_m,
            distance_m: self.distance_m + distance_m,
            ..*self
        }
    }

    /// The last piece: what the wheel was doing when the scan ended.
    pub fn last(&self) -> Piece {
        let moving = self.pieces[..self.len].iter().rev();
        moving.copied().next().unwrap_or_default()
    }

    /// Time before the scan's end at which the wheel had rolled up to `distance_m`, s.
    pub fn age_of_distance_s(&self, distance_m: f64) -> f64 {
        let mut distance_left = distance_m - self.distance_before_m;
        let mut time_left = self.seconds;
        for piece in &self.pieces[..self.len] {
            let rolled = piece.distance_m().abs();
            // The last pieces may be a rest in which nothing is rolled.
            if distance_left <= rolled {
                return time_left - piece.time_of_distance(distance_left.max(0.0));
            }
            distance_left -= rolled;
            time_left -= piece.seconds;
        }
        0.0
    }

    /// Time before the scan's end at which the train was at `position_m`, s; `None` if it was not
    /// reached in this scan.
    pub fn age_of_position_s(&self, position_m: f64) -> Option<f64> {
        let (from, to) = (self.position_before_m, self.position_m);
        let reached =
            (from < position_m && position_m <= to) || (to <= position_m && position_m < from);
        reached.then(|| self.age_of_distance_s(self.distance_before_m + (position_m - from).abs()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From 1 m/s at 2 m/s² for 5 ms, then a rest: 0.003 m is reached after t with
    /// 1·t + 1·t² = 0.003, t = (−1 + √1.012)/2 = 2.991054 ms, so 7.008946 ms before the end.
    #[test]
    fn time_within_a_scan_is_exact() {
        let mut motion = Motion::default();
        motion.begin_scan();
        motion.roll(Piece {
            seconds: 0.005,
            speed_mps: 1.0,
            accel_mps2: 2.0,
        });
        motion.roll(Piece {
            seconds: 0.005,
            speed_mps: 0.0,
            accel_mps2: 0.0,
        });
        let age = motion.age_of_distance_s(0.003);
        assert!((age - 7.008_946e-3).abs() < 1e-9, "{age}");
        assert_eq!(motion.age_of_position_s(0.003), Some(age));
        assert_eq!(motion.age_of_position_s(0.2), None);
    }

    #[test]
    fn backward_rolls_the_same_distance_and_falls_in_position() {
        let mut motion = Motion::default();
        motion.begin_scan();
        motion.roll(Piece {
            seconds: 0.01,
            speed_mps: -2.0,
            accel_mps2: 0.0,
        });
        assert!(
            (motion.distance_m - 0.02).abs() < 1e-15 && (motion.position_m + 0.02).abs() < 1e-15
        );
        let age = motion.age_of_position_s(-0.005);
        assert!((age.unwrap_or_default() - 0.0075).abs() < 1e-12);
    }
}
