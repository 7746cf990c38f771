//! Door drives that follow the unit's contacts: a side opens by its order in series with its enable, and closes by
//! the order to close; without an order the doors stay where they are.

use protocol::SCAN;
use protocol::message::Outputs;

use crate::stimulus::DoorState;
use crate::train::DoorData;

/// Opening at which an obstacle stops a door, share of the full opening.
const OBSTACLE: f64 = 0.2;
/// Opening within which a door counts as closed and is not yet locked, share of the full opening.
const LOCKING: f64 = 0.05;
/// Contacts that enable doors and order them to open, left and right.
const SIDES: [Outputs; 2] = [
    Outputs::DOOR_ENABLE_LEFT.union(Outputs::OPEN_LEFT),
    Outputs::DOOR_ENABLE_RIGHT.union(Outputs::OPEN_RIGHT),
];

/// The doors of both sides.
#[derive(Clone, Debug, Default)]
pub struct DoorGear {
    follows: bool,
    sides: [Drive; 2],
}

/// The doors of one side, which move together.
#[derive(Clone, Copy, Debug, Default)]
struct Drive {
    /// Share of the opening: 0 closed, 1 open.
    open: f64,
    /// Number of closings that an obstacle still stops.
    obstacles: u8,
    blocked: bool,
}

impl DoorGear {
    /// Lets the doors follow the unit from where they are, or leaves them to be set by hand.
    pub fn follow(&mut self, on: bool, doors: [DoorState; 2]) {
        self.follows = on;
        for (drive, state) in self.sides.iter_mut().zip(doors) {
            drive.open = f64::from(state == DoorState::Open);
        }
    }

    /// Number of closings of a side that an obstacle stops.
    pub fn obstruct(&mut self, left: bool, times: u8) {
        self.sides[usize::from(!left)].obstacles = times;
    }

    /// One scan with the unit's contacts, while it is heard.
    pub fn step(&mut self, contacts: Option<Outputs>, data: &DoorData, doors: &mut [DoorState; 2]) {
        let Some(contacts) = contacts.filter(|_| self.follows) else {
            return;
        };
        let closes = contacts.contains(Outputs::CLOSE_DOORS);
        for ((drive, state), opening) in self.sides.iter_mut().zip(doors).zip(SIDES) {
            *state = drive.step(contacts.contains(opening), closes, data);
        }
    }
}

impl Drive {
    fn step(&mut self, opens: bool, closes: bool, data: &DoorData) -> DoorState {
        if opens {
            // The obstacle is taken out while the doors open again.
            self.obstacles -= u8::from(self.blocked);
            self.blocked = false;
            self.open = (self.open + SCAN.as_secs() / data.opening_s).min(1.0);
        } else if closes {
            let stops_at = match self.obstacles {
                0 => 0.0,
                _ => OBSTACLE.min(self.open),
            };
            self.open = (self.open - SCAN.as_secs() / data.closing_s).max(stops_at);
            self.blocked = self.open > 0.0 && self.open <= stops_at;
        }
        match self.open {
            0.0 => DoorState::Locked,
            open if open < LOCKING => DoorState::Unlocked,
            _ => DoorState::Open,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEFT: Outputs = SIDES[0];

    struct Doors {
        gear: DoorGear,
        states: [DoorState; 2],
    }

    impl Doors {
        fn new() -> Self {
            let states = [DoorState::Locked; 2];
            let mut gear = DoorGear::default();
            gear.follow(true, states);
            Self { gear, states }
        }

        /// The states after so many seconds of these contacts.
        fn after(&mut self, contacts: Outputs, seconds: f64) -> [DoorState; 2] {
            for _ in 0..(seconds / SCAN.as_secs()).round() as u32 {
                let data = DoorData::default();
                self.gear.step(Some(contacts), &data, &mut self.states);
            }
            self.states
        }
    }

    #[test]
    fn a_side_opens_by_order_and_enable_and_closes_in_its_time() {
        use DoorState::{Locked, Open, Unlocked};
        let mut doors = Doors::new();
        for contacts in [
            Outputs::OPEN_LEFT,
            Outputs::DOOR_ENABLE_LEFT,
            Outputs::DOOR_ENABLE_LEFT | Outputs::OPEN_RIGHT,
        ] {
            assert_eq!(doors.after(contacts, 5.0), [Locked; 2], "{contacts:?}");
        }
        assert_eq!(doors.after(LEFT, 0.2), [Open, Locked]);
        assert_eq!(doors.after(LEFT, 2.3), [Open, Locked]);
        assert_eq!(doors.after(Outputs::empty(), 60.0), [Open, Locked]);
        assert_eq!(doors.after(Outputs::CLOSE_DOORS, 2.8), [Open, Locked]);
        assert_eq!(doors.after(Outputs::CLOSE_DOORS, 0.1), [Unlocked, Locked]);
        assert_eq!(doors.after(Outputs::CLOSE_DOORS, 0.11), [Locked; 2]);
    }

    #[test]
    fn an_obstacle_stops_as_many_closings_as_it_is_there_for() {
        use DoorState::{Locked, Open};
        let mut doors = Doors::new();
        doors.gear.obstruct(true, 2);
        doors.after(LEFT, 2.5);
        for _ in 0..2 {
            assert_eq!(doors.after(Outputs::CLOSE_DOORS, 60.0), [Open, Locked]);
            doors.after(LEFT, 1.0);
        }
        assert_eq!(doors.after(Outputs::CLOSE_DOORS, 3.0), [Locked; 2]);
    }

    #[test]
    fn doors_left_to_hands_stay_as_they_are() {
        let mut doors = Doors::new();
        doors.gear.follow(false, doors.states);
        assert_eq!(doors.after(LEFT, 5.0), [DoorState::Locked; 2]);
    }
}
