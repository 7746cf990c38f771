//! The generator's wheel: goes to a speed at an acceleration, or runs an exact distance and stops.

use protocol::{SCAN, Speed};

use crate::procedure::Refusal;

use crate::train::{Piece, TrainState};

use super::motion::Motion;

/// Slowing down when a step or a run ends: brisk, yet believable for a wheel [default].
const SAFE_DECEL_MPS2: f64 = 3.0;

/// Rest of a segment by rounding, s: its end belongs to the scan that reached it.
const RESIDUE_S: f64 = 1e-9;

/// A part of a plan at constant acceleration.
#[derive(Clone, Copy, Debug, Default)]
struct Segment {
    seconds: f64,
    accel_mps2: f64,
    end_speed_mps: f64,
}

/// Segments that the wheel still has to do; without one the wheel keeps its speed.
#[derive(Clone, Copy, Debug)]
struct Plan {
    segments: [Segment; 3],
    next: usize,
    /// Distance and position at which it ends, exactly.
    ends_at_m: Option<(f64, f64)>,
}

impl Default for Plan {
    fn default() -> Self {
        let segments = [Segment::default(); 3];
        Self {
            segments,
            next: segments.len(),
            ends_at_m: None,
        }
    }
}

/// The train's wheels: those that roll with it, and the axle that both tachometers sit on, which may
/// slip or slide while the train model drives.
#[derive(Debug, Default)]
pub struct Wheel {
    /// Size of the speed, m/s.
    speed_mps: f64,
    /// The wheel turns backward, or would if it turned.
    pub backward: bool,
    plan: Plan,
    /// The train's motion in the last scan.
    pub motion: Motion,
    /// Motion of the tachometers' axle in the last scan.
    pub axle: Motion,
    forward_at_rest: bool,
}

impl Wheel {
    pub fn go_to(&mut self, to: Speed, accel_mps2: f64) {
        self.forward_at_rest = false;
        let change = to.mps() - self.speed_mps;
        let mut plan = Plan::default();
        if change != 0.0 {
            plan.next = 2;
            plan.segments[2] = Segment {
                seconds: change.abs() / accel_mps2,
                accel_mps2: accel_mps2.copysign(change),
                end_speed_mps: to.mps(),
            };
        }
        self.plan = plan;
    }

    /// Runs `distance_m` from here and stands still again.
    ///
    /// # Errors
    /// When the wheel turns so fast that it cannot stop within the distance.
    pub fn travel(&mut self, distance_m: f64, speed: Speed, accel: f64) -> Result<(), Refusal> {
        let (from, cruise) = (self.speed_mps, speed.mps());
        let stopping_m = from * from / (2.0 * accel);
        if stopping_m > distance_m {
            return Err(Refusal(format!(
                "cannot stop within {distance_m} m from {}: that takes {stopping_m:.2} m at {accel} m/s²",
                Speed::from_mps(from)
            )));
        }
        // Highest speed from which the rest of the distance is just enough to stop.
        let top = cruise.min((accel * distance_m + from * from / 2.0).sqrt());
        let change_m = (top * top - from * from).abs() / (2.0 * accel);
        let cruise_m = (distance_m - change_m - top * top / (2.0 * accel)).max(0.0);
        let change_s = (top - from).abs() / accel;
        let segments = [
            Segment {
                seconds: change_s,
                accel_mps2: accel.copysign(top - from),
                end_speed_mps: top,
            },
            Segment {
                seconds: cruise_m / top,
                accel_mps2: 0.0,
                end_speed_mps: top,
            },
            Segment {
                seconds: top / accel,
                accel_mps2: -accel,
                end_speed_mps: 0.0,
            },
        ];
        let sign = if self.backward { -1.0 } else { 1.0 };
        let end_distance = self.motion.distance_m + distance_m;
        let end_position = self.motion.position_m + sign * distance_m;
        self.forward_at_rest = false;
        self.plan = Plan {
            segments,
            next: 0,
            ends_at_m: Some((end_distance, end_position)),
        };
        Ok(())
    }

    /// Sets the direction of rotation.
    ///
    /// # Errors
    /// While the wheel turns: no wheel changes direction without standing still.
    pub fn set_backward(&mut self, backward: bool) -> Result<(), Refusal> {
        if backward != self.backward && !self.standing() {
            return Err(Refusal(format!(
                "the wheels turn at {}: bring them to a standstill before changing direction",
                self.speed()
            )));
        }
        self.forward_at_rest = false;
        self.backward = backward;
        Ok(())
    }

    /// Slows down to a standstill and then faces forward.
    pub fn stop(&mut self) {
        self.go_to(Speed::ZERO, SAFE_DECEL_MPS2);
        self.forward_at_rest = true;
    }

    /// Follows its plan through one scan.
    pub fn step(&mut self) {
        self.motion.begin_scan();
        let sign = if self.backward { -1.0 } else { 1.0 };
        let mut left = SCAN.as_secs();
        while let Some(segment) = self.plan.segments.get_mut(self.plan.next) {
            let seconds = segment.seconds.min(left);
            if seconds > 0.0 {
                let speed_mps = sign * self.speed_mps;
                let accel_mps2 = sign * segment.accel_mps2;
                self.motion.roll(Piece {
                    seconds,
                    speed_mps,
                    accel_mps2,
                });
                self.speed_mps += segment.accel_mps2 * seconds;
                segment.seconds -= seconds;
                left -= seconds;
            }
            if segment.seconds > RESIDUE_S {
                break;
            }
            self.speed_mps = segment.end_speed_mps;
            self.plan.next += 1;
        }
        if self.settled()
            && let Some((distance, position)) = self.plan.ends_at_m.take()
        {
            self.motion.correct(distance, position);
        }
        if left > 0.0 {
            let speed_mps = sign * self.speed_mps;
            self.motion.roll(Piece {
                seconds: left,
                speed_mps,
                accel_mps2: 0.0,
            });
        }
        if self.forward_at_rest && self.standing() {
            self.backward = false;
        }
        self.roll_axle_along();
    }

    /// Follows the train model through one scan.
    pub fn follow(&mut self, states: &[TrainState]) {
        self.motion.begin_scan();
        for piece in states.iter().flat_map(|state| state.pieces) {
            if piece.seconds > 0.0 {
                self.motion.roll(piece);
                self.speed_mps = piece.end_speed_mps().abs();
            }
        }
        // A stop within a piece leaves rounding behind.
        if states.last().is_some_and(|s| s.pieces[1].seconds > 0.0) {
            self.speed_mps = 0.0;
        }
        if self.motion.position_m != self.motion.position_before_m {
            self.backward = self.motion.position_m < self.motion.position_before_m;
        }
        self.plan = Plan::default();
        if states.iter().all(|state| state.axle == state.pieces) {
            self.roll_axle_along();
            return;
        }
        self.axle.begin_scan();
        for piece in states.iter().flat_map(|state| state.axle) {
            if piece.seconds > 0.0 {
                self.axle.roll(piece);
            }
        }
    }

    /// The axle rolls as the train does; earlier slides stay as the difference of their distances.
    fn roll_axle_along(&mut self) {
        let slid_m = self.axle.distance_m - self.motion.distance_before_m;
        self.axle = self.motion.shifted(slid_m);
    }

    /// The plan is carried out.
    pub fn settled(&self) -> bool {
        self.plan.next >= self.plan.segments.len()
    }

    /// The wheel does not turn and is not about to.
    pub fn standing(&self) -> bool {
        self.speed_mps == 0.0 && self.settled()
    }

    /// Speed at the rim, whatever the direction.
    pub fn speed(&self) -> Speed {
        Speed::from_mps(self.speed_mps)
    }

    /// Speed at the rim, m/s, forward positive.
    pub fn velocity_mps(&self) -> f64 {
        if self.backward {
            -self.speed_mps
        } else {
            self.speed_mps
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run_until_settled(wheel: &mut Wheel) -> usize {
        (1..1_000_000)
            .find(|_| {
                wheel.step();
                wheel.settled()
            })
            .expect("the wheel settles")
    }

    /// 0 → 20 m/s at 0.8 m/s² takes 25 s and 250 m, also when 25 s is not a whole number of scans.
    #[test]
    fn a_ramp_takes_its_calculated_time_and_distance() {
        let mut wheel = Wheel::default();
        wheel.go_to(Speed::from_mps(20.0), 0.8);
        let scans = run_until_settled(&mut wheel);
        assert!((2500..=2501).contains(&scans), "{scans}");
        let late = scans as f64 * 0.01 - 25.0;
        assert!((wheel.motion.distance_m - (250.0 + late * 20.0)).abs() < 1e-6);
        assert_eq!(wheel.speed(), Speed::from_mps(20.0));
    }

    #[test]
    fn travel_ends_exactly_and_at_standstill() {
        for (distance, speed, accel) in [
            (100.0, 15.0, 1.0),
            (3.5, 15.0, 0.7),
            (0.001, 1.0, 3.0),
            (850.03, 16.67, 0.83),
        ] {
            let mut wheel = Wheel::default();
            wheel
                .travel(distance, Speed::from_mps(speed), accel)
                .unwrap();
            run_until_settled(&mut wheel);
            assert_eq!(wheel.motion.distance_m, distance);
            wheel.step();
            assert_eq!(wheel.motion.position_m, distance);
            assert!(wheel.standing());
        }
    }

    #[test]
    fn travel_from_speed_covers_the_distance_or_is_refused() {
        let mut wheel = Wheel::default();
        wheel.go_to(Speed::from_mps(10.0), 1.0);
        run_until_settled(&mut wheel);
        let from = wheel.motion.distance_m;
        assert!(wheel.travel(49.0, Speed::from_mps(5.0), 1.0).is_err());
        wheel.travel(60.0, Speed::from_mps(5.0), 1.0).unwrap();
        run_until_settled(&mut wheel);
        assert_eq!(wheel.motion.distance_m, from + 60.0);
        assert!(wheel.standing());
    }

    #[test]
    fn direction_changes_only_at_rest_and_stop_faces_forward() {
        let mut wheel = Wheel::default();
        wheel.set_backward(true).unwrap();
        wheel.go_to(Speed::from_mps(1.0), 1.0);
        run_until_settled(&mut wheel);
        assert!(wheel.set_backward(false).is_err());
        wheel.stop();
        run_until_settled(&mut wheel);
        assert!(!wheel.backward && wheel.standing());
        assert!(wheel.motion.position_m < 0.0);
    }
}
