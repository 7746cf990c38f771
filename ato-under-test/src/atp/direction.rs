//! Rollback: distance run against the reverser.

use protocol::Instant;
use protocol::event::Event;
use protocol::message::TrainLines;

use crate::kernel::EventLog;
use crate::timer::Edge;

/// Adds up the distance run against the reverser.
#[derive(Clone, Debug, Default)]
pub struct Rollback {
    against_m: f64,
    tripped: Edge,
}

impl Rollback {
    /// One scan; true once the distance against the reverser exceeds `allowed_m`, until the wheels stand still.
    pub fn step(
        &mut self,
        now: Instant,
        moved_m: f64,
        lines: TrainLines,
        still: bool,
        allowed_m: f64,
        log: &mut EventLog,
    ) -> bool {
        let forward = lines.contains(TrainLines::FORWARD);
        let backward = lines.contains(TrainLines::BACKWARD);
        let against = match (forward, backward) {
            (true, false) => -moved_m,
            (false, true) => moved_m,
            _ => 0.0,
        };
        self.against_m = if still {
            0.0
        } else {
            (self.against_m + against).max(0.0)
        };
        let trips = self.against_m > allowed_m;
        if self.tripped.rises(trips) {
            log.push(
                now,
                Event::Rollback,
                libm::round(self.against_m * 100.0) as i32,
            );
        }
        trips
    }
}
