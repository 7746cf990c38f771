//! Sides of the train as the two contacts or lines that stand for them.

use protocol::message::{DoorSide, Outputs};

/// The side whose argument is true; `Both` or `None` where both or neither are.
pub const fn side_of(left: bool, right: bool) -> DoorSide {
    match (left, right) {
        (false, false) => DoorSide::None,
        (true, false) => DoorSide::Left,
        (false, true) => DoorSide::Right,
        (true, true) => DoorSide::Both,
    }
}

/// The contacts of a side, given that of the left and that of the right; none for a side that is not known.
pub fn contacts(side: DoorSide, [left, right]: [Outputs; 2]) -> Outputs {
    match side {
        DoorSide::Left => left,
        DoorSide::Right => right,
        DoorSide::Both => left | right,
        DoorSide::None | DoorSide::Unknown(_) => Outputs::empty(),
    }
}
