//! Rollback: distance run against the reverser, or without a direction.

use protocol::Instant;
use protocol::event::Event;
use protocol::message::TrainLines;

use crate::kernel::{EventLog, hundredths};
use crate::timer::Edge;

/// Where the reverser lets the train go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Towards {
    Forward,
    Backward,
    /// The reverser is in neutral, or its contacts contradict each other or chatter: no direction
    /// is permitted.
    Nowhere,
    /// Nothing is supervised: test signals in neutral, as a train in a depot is left.
    Anywhere,
}

impl Towards {
    pub fn of(lines: TrainLines, chatters: bool, tested: [bool; 2], supervised: bool) -> Self {
        let forward = lines.contains(TrainLines::FORWARD);
        let backward = lines.contains(TrainLines::BACKWARD);
        match (forward, backward) {
            (true, false) if !chatters => Self::Forward,
            (false, true) if !chatters => Self::Backward,
            _ if !supervised || tested.contains(&true) => Self::Anywhere,
            _ => Self::Nowhere,
        }
    }

    /// Way that is not permitted, m; negative makes some of it good.
    fn wrong_m(self, moved_m: f64) -> f64 {
        match self {
            Self::Forward => -moved_m,
            Self::Backward => moved_m,
            Self::Nowhere => libm::fabs(moved_m),
            Self::Anywhere => 0.0,
        }
    }
}

/// Adds up the distance run against the reverser.
#[derive(Clone, Debug, Default)]
pub struct Rollback {
    /// Distance rolled back by each tachometer, m: a dead tachometer hides nothing.
    against_m: [f64; 2],
    /// `against_m` when the wheels stood last: a lone pulse since then is spurious.
    stood_m: [f64; 2],
    towards: Option<Towards>,
    tripped: Edge,
}

/// Way of a lone pulse, and no more, m.
const LONE_M: f64 = 0.04;

impl Rollback {
    /// One scan, with the way of each tachometer and whether the wheels stand still; true once the distance against the
    /// reverser exceeds `allowed_m`, until the way is counted from 0 again. Standing still does not reset it, so that many
    /// small rolls add up; nor does a reverser that is turned in motion.
    pub fn step(
        &mut self,
        now: Instant,
        (moved_m, still): ([f64; 2], bool),
        towards: Towards,
        from_zero: bool,
        allowed_m: f64,
        log: &mut EventLog,
    ) -> bool {
        let turned = self.towards.replace(towards) != Some(towards);
        let sums = self.against_m.iter_mut().zip(&mut self.stood_m);
        for ((against_m, stood_m), moved_m) in sums.zip(moved_m) {
            *against_m = match from_zero || turned && still {
                true => 0.0,
                false => (*against_m + towards.wrong_m(moved_m)).max(0.0),
            };
            if still {
                if libm::fabs(*against_m - *stood_m) < LONE_M {
                    *against_m = against_m.min(*stood_m);
                }
                *stood_m = *against_m;
            }
        }
        let farthest_m = self.against_m[0].max(self.against_m[1]);
        let trips = farthest_m > allowed_m;
        if self.tripped.rises(trips) {
            log.push(now, Event::Rollback, hundredths(farthest_m));
        }
        trips
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: a reverser whose contact flickers lets no train roll. Method: 2 km/h backward, the reverser at forward and at
    /// neutral by turns of 100 ms.
    #[test]
    fn a_reverser_that_flickers_in_motion_does_not_reset_the_sum() {
        let (mut rollback, mut log) = (Rollback::default(), EventLog::default());
        let back_m = [-2.0 / 3.6 * 0.01; 2];
        let trips = |scan: u64| {
            let towards = match scan / 10 % 2 {
                0 => Towards::Forward,
                _ => Towards::Nowhere,
            };
            let now = Instant::from_ms(10 * scan);
            rollback.step(now, (back_m, false), towards, false, 0.5, &mut log)
        };
        assert_eq!((0..200).map(trips).position(|trips| trips), Some(90));
    }
}
