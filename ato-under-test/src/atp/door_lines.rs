//! Door train lines: what is proved of the doors of each side, and whether the lines fit together.

use protocol::message::{DoorSide, Outputs, TrainLines};

use super::sides::side_of;

/// Contacts that enable doors and lines that prove them, left and right.
const SIDES: [(Outputs, TrainLines, TrainLines); 2] = [
    (
        Outputs::DOOR_ENABLE_LEFT,
        TrainLines::LEFT_CLOSED,
        TrainLines::LEFT_LOCKED,
    ),
    (
        Outputs::DOOR_ENABLE_RIGHT,
        TrainLines::RIGHT_CLOSED,
        TrainLines::RIGHT_LOCKED,
    ),
];

/// The lines of one scan.
#[derive(Clone, Copy, Debug)]
pub struct DoorLines {
    lines: TrainLines,
    /// The train tells of doors by side, or has told of them before.
    pub by_side: bool,
}

impl DoorLines {
    /// Lines of a train; `told` = the train has told of doors by side before. The supervision of sides goes
    /// on when the train no longer tells.
    pub const fn new(lines: TrainLines, told: bool) -> Self {
        let by_side = told || lines.contains(TrainLines::DOORS_BY_SIDE);
        Self { lines, by_side }
    }

    /// All doors are proved closed, and by side closed and locked.
    pub fn closed(self) -> bool {
        self.lines.contains(TrainLines::DOORS_CLOSED) && self.open() == DoorSide::None
    }

    /// Sides on which doors are not proved closed and locked. One line for all doors tells of no side.
    pub fn open(self) -> DoorSide {
        self.sides(|_, closed, locked| !self.lines.contains(closed | locked))
    }

    /// Sides that are neither proved closed and locked nor enabled.
    pub fn open_without(self, enabled: Outputs) -> DoorSide {
        self.sides(|enable, closed, locked| {
            !enabled.contains(enable) && !self.lines.contains(closed | locked)
        })
    }

    /// Sides whose lines contradict each other: doors that are locked and not closed, or closed and open by the line
    /// of all doors; `DoorSide::None` where that line alone is wrong, or the train tells of sides no more. `None`
    /// while the lines agree.
    pub fn contradiction(self) -> Option<DoorSide> {
        if !self.by_side {
            return None;
        }
        let locked_open = self
            .sides(|_, closed, locked| self.lines.contains(locked) && !self.lines.contains(closed));
        let both = TrainLines::LEFT_CLOSED | TrainLines::RIGHT_CLOSED;
        let fits = self.lines.contains(both) == self.lines.contains(TrainLines::DOORS_CLOSED)
            && self.lines.contains(TrainLines::DOORS_BY_SIDE);
        (locked_open != DoorSide::None || !fits).then_some(locked_open)
    }

    fn sides(self, is: impl Fn(Outputs, TrainLines, TrainLines) -> bool) -> DoorSide {
        let [left, right] = SIDES.map(|(enable, closed, locked)| is(enable, closed, locked));
        side_of(self.by_side && left, self.by_side && right)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: TrainLines = TrainLines::from_bits_retain(0b11_1110_0000_0001);

    fn without(lines: TrainLines) -> DoorLines {
        DoorLines::new(ALL.difference(lines), true)
    }

    #[test]
    fn a_side_is_proved_by_both_of_its_lines() {
        assert!(without(TrainLines::empty()).closed());
        for (missing, open) in [
            (TrainLines::LEFT_CLOSED, DoorSide::Left),
            (TrainLines::LEFT_LOCKED, DoorSide::Left),
            (TrainLines::RIGHT_LOCKED, DoorSide::Right),
            (
                TrainLines::LEFT_CLOSED | TrainLines::RIGHT_CLOSED,
                DoorSide::Both,
            ),
        ] {
            assert_eq!(without(missing).open(), open);
            assert!(!without(missing).closed());
        }
        assert!(!without(TrainLines::DOORS_CLOSED).closed());
    }

    #[test]
    fn one_line_for_all_doors_tells_of_no_side() {
        let open = DoorLines::new(TrainLines::empty(), false);
        assert!(!open.closed());
        assert_eq!(open.open_without(Outputs::empty()), DoorSide::None);
        assert_eq!(open.contradiction(), None);
        assert!(DoorLines::new(TrainLines::DOORS_CLOSED, false).closed());
    }

    #[test]
    fn a_door_may_be_open_where_it_is_enabled() {
        let both = TrainLines::LEFT_CLOSED | TrainLines::RIGHT_CLOSED;
        let open = without(both);
        assert_eq!(
            open.open_without(Outputs::DOOR_ENABLE_LEFT),
            DoorSide::Right
        );
        assert_eq!(open.open_without(Outputs::empty()), DoorSide::Both);
    }

    #[test]
    fn lines_that_do_not_fit_contradict() {
        let all = TrainLines::DOORS_CLOSED;
        let left = TrainLines::LEFT_CLOSED | TrainLines::LEFT_LOCKED;
        for (missing, contradiction) in [
            (TrainLines::empty(), None),
            (TrainLines::LEFT_LOCKED, None),
            (left | all, None),
            (all, Some(DoorSide::None)),
            (left, Some(DoorSide::None)),
            (TrainLines::RIGHT_CLOSED | all, Some(DoorSide::Right)),
            (TrainLines::DOORS_BY_SIDE, Some(DoorSide::None)),
        ] {
            assert_eq!(without(missing).contradiction(), contradiction);
        }
    }
}
