//! Orders of ATO to open doors that ATP lets through: its contact for a side lies in series with the enable of
//! that side, so that no order opens a door where none may be open.

use protocol::event::Event;
use protocol::message::{DoorSide, Outputs};
use protocol::{Duration, Instant};

use super::sides::{contacts, side_of};
use crate::kernel::EventLog;
use crate::timer::{Edge, OnDelay};

/// Time that ATO has to take an order back when the enable goes: it acts once a cycle.
const FOLLOWS: Duration = Duration::from_ms(200);

#[derive(Clone, Debug, Default)]
pub struct DoorOrders {
    /// The contacts that order doors to open.
    pub passed: Outputs,
    beyond: OnDelay,
    reported: Edge,
}

impl DoorOrders {
    /// One scan, with the sides ordered to open and the enables of this scan.
    pub fn step(&mut self, now: Instant, ordered: DoorSide, enable: Outputs, log: &mut EventLog) {
        let enabled = enabled_sides(enable).code();
        // Codes of sides are sets of bits.
        let refused = ordered.code() & !enabled;
        let passed = DoorSide::from_code(ordered.code() & enabled);
        self.passed = contacts(passed, [Outputs::OPEN_LEFT, Outputs::OPEN_RIGHT]);
        let lasts = self.beyond.update(now, refused != 0, FOLLOWS);
        if self.reported.rises(lasts) {
            log.push(now, Event::DoorOrderRefused, i32::from(refused));
        }
    }
}

pub fn enabled_sides(enable: Outputs) -> DoorSide {
    side_of(
        enable.contains(Outputs::DOOR_ENABLE_LEFT),
        enable.contains(Outputs::DOOR_ENABLE_RIGHT),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::logged;

    const SIDES: [DoorSide; 4] = [
        DoorSide::None,
        DoorSide::Left,
        DoorSide::Right,
        DoorSide::Both,
    ];

    fn enables(side: DoorSide) -> Outputs {
        let mut enable = Outputs::empty();
        enable.set(Outputs::DOOR_ENABLE_LEFT, side.code() & 1 != 0);
        enable.set(Outputs::DOOR_ENABLE_RIGHT, side.code() & 2 != 0);
        enable
    }

    /// Every order against every enable: what passes, and what is logged after the time to follow.
    #[test]
    fn an_order_passes_on_enabled_sides_alone() {
        for ordered in SIDES {
            for enabled in SIDES {
                let (mut orders, mut log) = (DoorOrders::default(), EventLog::default());
                for ms in (0..=200).step_by(10) {
                    let now = Instant::from_ms(ms);
                    orders.step(now, ordered, enables(enabled), &mut log);
                    let passed = orders.passed;
                    let both = ordered.code() & enabled.code();
                    assert_eq!(passed.contains(Outputs::OPEN_LEFT), both & 1 != 0);
                    assert_eq!(passed.contains(Outputs::OPEN_RIGHT), both & 2 != 0);
                }
                let beyond = ordered.code() & !enabled.code();
                let expected = (beyond != 0).then_some((245, i32::from(beyond)));
                let told = logged(&log);
                assert_eq!(told.first().copied(), expected, "{ordered:?} {enabled:?}");
            }
        }
    }

    #[test]
    fn an_order_that_is_taken_back_in_time_is_no_event() {
        let (mut orders, mut log) = (DoorOrders::default(), EventLog::default());
        for ms in (0..200).step_by(10) {
            let now = Instant::from_ms(ms);
            orders.step(now, DoorSide::Left, Outputs::empty(), &mut log);
        }
        let now = Instant::from_ms(200);
        orders.step(now, DoorSide::None, Outputs::empty(), &mut log);
        assert_eq!(log.next_index(), 0);
    }
}
