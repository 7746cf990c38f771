//! Record of automatic runs: what ATO measured and ordered in each cycle, in a bounded ring [S0 §2, §3.1].

use protocol::Instant;
use protocol::message::{AtoState, RunRow};

use super::Ring;

/// Rows kept, 4 min of driving; older ones fall off and their indices stay used.
pub const RUN_ROWS: usize = 4800;

#[derive(Debug, Default)]
pub struct RunRecord {
    pub rows: Ring<RunRow, RUN_ROWS>,
    run: u16,
    state: AtoState,
    markers: u8,
}

impl RunRecord {
    /// One cycle: what is recorded of it, with the marker detected last and how many there were so far. `running` while
    /// ATP has set Automatic Run. Rows that would only repeat that the train stands are left out.
    pub fn step(&mut self, now: Instant, running: bool, (cycle, markers): (RunRow, u8)) {
        let before = core::mem::replace(&mut self.state, cycle.ato_state);
        let passed = markers != core::mem::replace(&mut self.markers, markers);
        if cycle.ato_state == AtoState::Start && before != AtoState::Start {
            self.run = self.run.wrapping_add(1);
        }
        if !running || self.run == 0 {
            return;
        }
        let row = RunRow {
            index: self.rows.next_index(),
            run: self.run,
            at_ms: now.stamp_ms(),
            position_cm: cycle.position_cm,
            speed_cms: cycle.speed_cms,
            target_cms: cycle.target_cms,
            effort: cycle.effort,
            marker: if passed { cycle.marker } else { 0 },
            ato_state: cycle.ato_state,
        };
        if self.rows.newest().is_some_and(|last| repeats(last, &row)) {
            return;
        }
        self.rows.push(row);
    }
}

/// Whether a row of a standing train repeats the last one but for its time.
fn repeats(last: &RunRow, row: &RunRow) -> bool {
    let same = RunRow {
        index: last.index,
        at_ms: last.at_ms,
        ..*row
    };
    row.speed_cms == 0 && same == *last
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cycle(speed_cms: u16, ato_state: AtoState) -> (RunRow, u8) {
        let row = RunRow {
            speed_cms,
            ato_state,
            ..RunRow::default()
        };
        (row, 0)
    }

    #[test]
    fn runs_are_numbered_and_old_rows_fall_off() {
        let mut record = RunRecord::default();
        record.step(Instant::ZERO, false, cycle(0, AtoState::Stop));
        assert!(record.rows.at_or_after(0).is_none(), "nothing but runs");
        for run in 1..=2 {
            record.step(Instant::ZERO, true, cycle(0, AtoState::Start));
            for _ in 0..RUN_ROWS - 1 {
                record.step(Instant::ZERO, true, cycle(500, AtoState::Run));
            }
            record.step(Instant::ZERO, false, cycle(0, AtoState::Stop));
            let rows = record.rows.next_index() - record.rows.oldest_index();
            assert_eq!(rows as usize, RUN_ROWS);
            assert_eq!(record.rows.at_or_after(0).map(|row| row.run), Some(run));
        }
        assert_eq!(record.rows.oldest_index() as usize, RUN_ROWS);
    }

    #[test]
    fn a_train_that_stands_fills_no_rows_and_a_marker_is_in_one() {
        let mut record = RunRecord::default();
        for _ in 0..100 {
            record.step(Instant::ZERO, true, cycle(0, AtoState::Start));
        }
        assert_eq!(record.rows.next_index(), 1);
        let mut moving = cycle(500, AtoState::Run);
        (moving.0.marker, moving.1) = (2, 1);
        record.step(Instant::ZERO, true, moving);
        record.step(Instant::ZERO, true, moving);
        let markers = [1, 2].map(|i| record.rows.at_or_after(i).map(|row| row.marker));
        assert_eq!(markers, [Some(2), Some(0)]);
    }
}
