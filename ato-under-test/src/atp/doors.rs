//! Doors: open while moving or without being enabled, lines that contradict each other, departure inhibited while
//! open, and enabling at the platform.

use protocol::config::DoorConfig;
use protocol::event::Event;
use protocol::message::{DoorSide, Outputs};
use protocol::{Duration, Instant, Speed};

use super::DoorLines;
use super::sides::contacts;
use crate::kernel::EventLog;
use crate::timer::{Burst, Edge, OnDelay, ms};

/// Time for which a train must stand at a platform and not be aligned before `DoorEnableRefused` is logged: alignment
/// is known a scan after standstill.
const SETTLES: Duration = Duration::from_ms(200);

/// Doors that seem to open so often in this time are not opened by a person: a contact chatters.
const CHATTER_OPENINGS: u32 = 4;
const CHATTER_SPAN: Duration = Duration::from_ms(1_000);

/// Inputs of the door supervision.
#[derive(Clone, Copy, Debug)]
pub struct DoorInputs {
    /// The train lines, while they are alive.
    pub lines: Option<DoorLines>,
    /// Doors that open without being enabled are supervised: a cab is active, and nothing is wrong with the function.
    pub supervised: bool,
    /// Enables last until the doors are proved closed: nothing is wrong with this function.
    pub latched: bool,
    pub standstill: bool,
    pub aligned: bool,
    /// The train stands on the arrival station's loop with valid station data.
    pub at_platform: bool,
    pub side: DoorSide,
    pub speed: Speed,
    /// Way in this scan, m.
    pub way_m: f64,
}

#[derive(Clone, Debug, Default)]
pub struct Doors {
    open_moving: OnDelay,
    /// Way with a door open, m, at any speed.
    open_m: f64,
    tripped: Edge,
    unaligned: OnDelay,
    refused: Edge,
    enable: Outputs,
    not_enabled: OnDelay,
    /// Sides open in the last scan; unknown before the first.
    open: Option<u8>,
    /// Sides that opened without being enabled and are open still.
    opened: u8,
    not_asked: Edge,
    contradict: OnDelay,
    contradiction: Edge,
    holds: bool,
    unproved: Edge,
    openings: Burst,
}

impl Doors {
    pub fn enable(&self) -> Outputs {
        self.enable
    }

    /// One scan; true while a door is open on a moving train.
    pub fn step(
        &mut self,
        now: Instant,
        inputs: DoorInputs,
        config: &DoorConfig,
        log: &mut EventLog,
    ) -> bool {
        let moving = !inputs.standstill && inputs.speed > Speed::ZERO;
        let span = ms(config.open_moving_ms);
        let closed = inputs.lines.is_none_or(DoorLines::closed);
        let opens = self.unproved.rises(!closed);
        if (self.openings).tells_many(now, opens, CHATTER_OPENINGS, CHATTER_SPAN) {
            log.push(now, Event::DoorChatters, CHATTER_OPENINGS as i32);
        }
        self.open_m = if closed {
            0.0
        } else {
            self.open_m + inputs.way_m
        };
        // A train that leaves its place with a door open moves, however slowly.
        let creeps = self.open_m > config.aligned_m;
        let open_moving = self.open_moving.update(now, moving && !closed, span) || creeps;
        if self.tripped.rises(open_moving) {
            log.push(now, Event::DoorOpenMoving, i32::from(inputs.speed.to_cms()));
        }
        let stopped = inputs.standstill && inputs.at_platform;
        let refused = stopped && !inputs.aligned;
        let refused = self.unaligned.update(now, refused, SETTLES);
        if self.refused.rises(refused) {
            log.push(now, Event::DoorEnableRefused, 0);
        }
        let enables = [Outputs::DOOR_ENABLE_LEFT, Outputs::DOOR_ENABLE_RIGHT];
        // What was enabled lasts until the doors are proved closed: data of the next section, which come while doors
        // close, must not keep an obstacle from opening them again.
        let kept = match inputs.latched && inputs.standstill && !closed {
            true => self.enable,
            false => Outputs::empty(),
        };
        let given = match stopped && inputs.aligned {
            true => contacts(inputs.side, enables),
            false => Outputs::empty(),
        };
        self.enable = given | kept;
        self.supervise(now, inputs, config, log);
        open_moving
    }

    /// Holds the train while doors are open without being enabled. Logs doors that opened without being enabled, but
    /// not doors that were enabled when they opened and are no longer. Logs lines that contradict each other.
    fn supervise(
        &mut self,
        now: Instant,
        inputs: DoorInputs,
        config: &DoorConfig,
        log: &mut EventLog,
    ) {
        let lines = inputs.lines.filter(|_| inputs.supervised);
        let open = lines.map_or(DoorSide::None, |lines| lines.open_without(self.enable));
        let is_open = open != DoorSide::None;
        self.holds = (self.not_enabled).update(now, is_open, ms(config.open_moving_ms));
        // Codes of sides are sets of bits.
        let all_open = inputs.lines.map_or(0, |lines| lines.open().code());
        let opening = all_open & !self.open.replace(all_open).unwrap_or(u8::MAX);
        self.opened = (self.opened | opening) & open.code();
        if self.not_asked.rises(self.holds && self.opened != 0) {
            log.push(now, Event::DoorNotEnabled, i32::from(self.opened));
        }
        let contradiction = inputs.lines.and_then(DoorLines::contradiction);
        let contradicts = contradiction.is_some();
        let lasts = (self.contradict).update(now, contradicts, ms(config.lines_ms));
        if self.contradiction.rises(lasts) {
            let sides = contradiction.unwrap_or_default();
            log.push(now, Event::DoorLinesContradict, i32::from(sides.code()));
        }
    }

    /// Doors are open on a side that is not enabled: the train is held.
    pub fn hold(&self) -> bool {
        self.holds
    }
}

#[cfg(test)]
mod tests {
    use protocol::message::TrainLines;

    use super::*;
    use crate::for_tests::logged;

    const PROVED: TrainLines = TrainLines::DOORS_CLOSED
        .union(TrainLines::DOORS_BY_SIDE)
        .union(TrainLines::LEFT_CLOSED)
        .union(TrainLines::LEFT_LOCKED)
        .union(TrainLines::RIGHT_CLOSED)
        .union(TrainLines::RIGHT_LOCKED);
    const RIGHT_OPEN: TrainLines = PROVED.difference(
        TrainLines::DOORS_CLOSED
            .union(TrainLines::RIGHT_CLOSED)
            .union(TrainLines::RIGHT_LOCKED),
    );
    const LEFT_OPEN: TrainLines = PROVED.difference(
        TrainLines::DOORS_CLOSED
            .union(TrainLines::LEFT_CLOSED)
            .union(TrainLines::LEFT_LOCKED),
    );

    const CONFIG: DoorConfig = DoorConfig {
        aligned_m: 0.3,
        open_moving_ms: 100,
        lines_ms: 500,
    };

    /// A train that stands at a platform on this side.
    fn at_platform(lines: TrainLines, side: DoorSide) -> DoorInputs {
        DoorInputs {
            lines: Some(DoorLines::new(lines, false)),
            supervised: true,
            latched: true,
            standstill: true,
            aligned: true,
            at_platform: true,
            side,
            speed: Speed::ZERO,
            way_m: 0.0,
        }
    }

    /// Doors of a train that stands at a platform, with their log and clock.
    struct Train {
        doors: Doors,
        log: EventLog,
        now: Instant,
    }

    impl Train {
        fn new() -> Self {
            let mut train = Self {
                doors: Doors::default(),
                log: EventLog::default(),
                now: Instant::ZERO,
            };
            train.has(PROVED, DoorSide::None);
            train
        }

        /// Feeds these lines for 600 ms, with doors enabled on a side; whether the train is held.
        fn has(&mut self, lines: TrainLines, side: DoorSide) -> bool {
            let inputs = at_platform(lines, side);
            for _ in 0..60 {
                self.doors.step(self.now, inputs, &CONFIG, &mut self.log);
                self.now += protocol::SCAN;
            }
            self.doors.hold()
        }
    }

    #[test]
    fn doors_that_open_without_being_enabled_hold_the_train() {
        for (side, lines, sides) in [
            (DoorSide::None, LEFT_OPEN, Some(1)),
            (DoorSide::Right, LEFT_OPEN, Some(1)),
            (DoorSide::Left, RIGHT_OPEN, Some(2)),
            (DoorSide::None, LEFT_OPEN.intersection(RIGHT_OPEN), Some(3)),
            (DoorSide::Right, RIGHT_OPEN, None),
            (DoorSide::Both, LEFT_OPEN.intersection(RIGHT_OPEN), None),
        ] {
            let mut train = Train::new();
            train.has(PROVED, side);
            assert_eq!(train.has(lines, side), sides.is_some(), "{side:?}");
            let events: alloc::vec::Vec<_> = sides.map(|sides| (242, sides)).into_iter().collect();
            assert_eq!(logged(&train.log), events, "{side:?}");
            assert!(!train.has(PROVED, side), "closed again");
        }
    }

    #[test]
    fn an_enable_lasts_until_the_doors_are_proved_closed() {
        let mut train = Train::new();
        assert!(!train.has(PROVED, DoorSide::Right));
        assert!(!train.has(RIGHT_OPEN, DoorSide::Right));
        assert!(
            !train.has(RIGHT_OPEN, DoorSide::None),
            "data of the next section"
        );
        assert_eq!(train.doors.enable, Outputs::DOOR_ENABLE_RIGHT);
        assert_eq!(logged(&train.log), []);
        assert!(train.has(RIGHT_OPEN.intersection(LEFT_OPEN), DoorSide::None));
        assert_eq!(logged(&train.log), [(242, 1)], "the other side");
        assert!(!train.has(PROVED, DoorSide::None));
        assert_eq!(train.doors.enable, Outputs::empty());
        assert!(train.has(RIGHT_OPEN, DoorSide::None), "opened again");
    }

    #[test]
    fn lines_that_contradict_each_other_for_long_enough_are_told_once() {
        let mut train = Train::new();
        train.has(PROVED.difference(TrainLines::DOORS_CLOSED), DoorSide::None);
        train.has(PROVED.difference(TrainLines::DOORS_CLOSED), DoorSide::None);
        assert_eq!(logged(&train.log), [(243, 0)]);
    }

    #[test]
    fn a_contact_that_chatters_is_told_once_and_doors_that_open_twice_are_none() {
        let mut train = Train::new();
        for (openings, events) in [(2, 0), (10, 1)] {
            for scan in 0..20 * openings {
                let lines = if scan % 20 < 9 { RIGHT_OPEN } else { PROVED };
                let inputs = DoorInputs {
                    standstill: false,
                    aligned: false,
                    at_platform: false,
                    ..at_platform(lines, DoorSide::None)
                };
                train.doors.step(train.now, inputs, &CONFIG, &mut train.log);
                train.now += protocol::SCAN;
            }
            train.now += Duration::from_ms(2_000);
            let told = logged(&train.log);
            let told = told.iter().filter(|event| event.0 == 247).count();
            assert!((events..=2 * events).contains(&told), "{openings}: {told}");
        }
    }

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
            let (mut doors, mut log) = (Doors::default(), EventLog::default());
            let inputs = at_platform(PROVED, side);
            doors.step(Instant::ZERO, inputs, &CONFIG, &mut log);
            assert_eq!(doors.enable, enabled, "{side:?}");
        }
    }
}
