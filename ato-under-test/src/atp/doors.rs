//! Doors: open while moving, departure inhibited while open, and enabling at the platform.

use protocol::config::DoorConfig;
use protocol::event::Event;
use protocol::message::{DoorSide, Outputs};
use protocol::{Duration, Instant, Speed};

use crate::kernel::EventLog;
use crate::timer::{Edge, OnDelay};

/// Time a train that has just stopped has until its place counts: alignment is known a scan after
/// standstill.
const SETTLES: Duration = Duration::from_ms(200);

/// What the door supervision looks at.
#[derive(Clone, Copy, Debug)]
pub struct DoorInputs {
    pub closed: bool,
    pub standstill: bool,
    pub aligned: bool,
    /// The train stands on the arrival station's loop with valid station data.
    pub at_platform: bool,
    pub side: DoorSide,
    pub speed: Speed,
}

#[derive(Clone, Debug, Default)]
pub struct Doors {
    open_moving: OnDelay,
    tripped: Edge,
    unaligned: OnDelay,
    refused: Edge,
    enable: Outputs,
}

impl Doors {
    /// One scan; true while a door is open on a moving train.
    pub fn step(
        &mut self,
        now: Instant,
        inputs: DoorInputs,
        config: &DoorConfig,
        log: &mut EventLog,
    ) -> bool {
        let moving = !inputs.standstill && inputs.speed > Speed::ZERO;
        let span = Duration::from_ms(u64::from(config.open_moving_ms));
        let open_moving = self.open_moving.update(now, moving && !inputs.closed, span);
        if self.tripped.rises(open_moving) {
            log.push(now, Event::DoorOpenMoving, i32::from(inputs.speed.to_cms()));
        }
        let stopped = inputs.standstill && inputs.at_platform;
        let refused = stopped && !inputs.aligned;
        let refused = self.unaligned.update(now, refused, SETTLES);
        if self.refused.rises(refused) {
            log.push(now, Event::DoorEnableRefused, 0);
        }
        self.enable = match inputs.side {
            _ if !(stopped && inputs.aligned) => Outputs::empty(),
            DoorSide::Left => Outputs::DOOR_ENABLE_LEFT,
            DoorSide::Right => Outputs::DOOR_ENABLE_RIGHT,
            DoorSide::Both => Outputs::DOOR_ENABLE_LEFT | Outputs::DOOR_ENABLE_RIGHT,
            DoorSide::None | DoorSide::Unknown(_) => Outputs::empty(),
        };
        open_moving
    }

    pub fn enable(&self) -> Outputs {
        self.enable
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Side given and what is enabled at the platform; a side that is not known enables none.
    #[test]
    fn the_side_that_is_given_is_enabled() {
        let both = Outputs::DOOR_ENABLE_LEFT | Outputs::DOOR_ENABLE_RIGHT;
        for (side, enabled) in [
            (DoorSide::None, Outputs::empty()),
            (DoorSide::Left, Outputs::DOOR_ENABLE_LEFT),
            (DoorSide::Right, Outputs::DOOR_ENABLE_RIGHT),
            (DoorSide::Both, both),
            (DoorSide::Unknown(4), Outputs::empty()),
            (DoorSide::Unknown(255), Outputs::empty()),
        ] {
            let inputs = DoorInputs {
                closed: true,
                standstill: true,
                aligned: true,
                at_platform: true,
                side,
                speed: Speed::ZERO,
            };
            let config = DoorConfig {
                aligned_m: 0.3,
                open_moving_ms: 100,
            };
            let (mut doors, mut log) = (Doors::default(), EventLog::default());
            doors.step(Instant::ZERO, inputs, &config, &mut log);
            assert_eq!(doors.enable(), enabled, "{side:?}");
        }
    }
}
