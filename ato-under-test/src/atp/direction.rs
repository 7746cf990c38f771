//! Rollback: distance run against the reverser.

use protocol::Instant;
use protocol::event::Event;
use protocol::message::TrainLines;

use crate::kernel::EventLog;
use crate::timer::Edge;

/// Adds up the distance run against the reverser.
#[derive(Clone, Debug, Default)]
pub struct Rollback {
    /// By each tachometer: one that is dead hides nothing.
    against_m: [f64; 2],
    tripped: Edge,
}

impl Rollback {
    /// One scan; true once the distance against the reverser exceeds `allowed_m`, until the way is
    /// counted anew: the wheels stand still.
    pub fn step(
        &mut self,
        now: Instant,
        moved_m: [f64; 2],
        lines: TrainLines,
        anew: bool,
        allowed_m: f64,
        log: &mut EventLog,
    ) -> bool {
        let forward = lines.contains(TrainLines::FORWARD);
        let backward = lines.contains(TrainLines::BACKWARD);
        let sign = match (forward, backward) {
            (true, false) => -1.0,
            (false, true) => 1.0,
            _ => 0.0,
        };
        for (against_m, moved_m) in self.against_m.iter_mut().zip(moved_m) {
            *against_m = match anew {
                true => 0.0,
                false => (*against_m + sign * moved_m).max(0.0),
            };
        }
        let farthest_m = self.against_m[0].max(self.against_m[1]);
        let trips = farthest_m > allowed_m;
        if self.tripped.rises(trips) {
            log.push(now, Event::Rollback, libm::round(farthest_m * 100.0) as i32);
        }
        trips
    }
}
