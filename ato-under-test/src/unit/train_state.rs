//! `TrainState` for a subscribed tester: with each `Status`, and at once in the scan of a change, so that
//! the frame's stamp dates the change.

use protocol::message::TrainState;

/// Scans in which no second frame is sent for changes, so that the bytes of the line suffice.
const SPACING: u8 = 3;

/// The values of a state that a frame dates to its scan, and the number of frames received through TWC.
type Dated = (TrainState, u16);

/// The values of a state that a frame dates to its scan; all others are left out.
fn dated(state: &TrainState) -> TrainState {
    TrainState {
        outputs: state.outputs,
        asked: state.asked,
        lines: state.lines,
        mode: state.mode,
        asked_mode: state.asked_mode,
        eb_cause: state.eb_cause,
        fsb_cause: state.fsb_cause,
        code_index: state.code_index,
        limit_cms: state.limit_cms,
        marker_count: state.marker_count,
        twc_answers: state.twc_answers,
        test_answers: state.test_answers,
        ..TrainState::default()
    }
}

/// When `TrainState` is due.
#[derive(Debug, Default)]
pub struct StateReport {
    /// `None` without a subscribed tester.
    last: Option<Dated>,
    /// Scans since the first change that no frame has shown yet.
    unsent: Option<u8>,
    /// Scans until a frame may be sent for a change again.
    wait: u8,
}

impl StateReport {
    /// One scan with a subscribed tester, and the state at its end with the number of frames received through TWC;
    /// `changes`: the tester wants changes at once. Returns, if a frame is due, the age in scans of what it shows.
    pub fn step(
        &mut self,
        (state, twc_received): (&TrainState, u16),
        changes: bool,
        cycle: bool,
    ) -> Option<u8> {
        let state = (dated(state), twc_received);
        self.wait = self.wait.saturating_sub(1);
        self.unsent = self.unsent.map(|age| age.saturating_add(1));
        if self.last.replace(state).is_some_and(|last| last != state) {
            self.unsent = self.unsent.or(Some(0));
        }
        let at_once = changes && self.unsent.is_some() && self.wait == 0;
        if !cycle && !at_once {
            return None;
        }
        if !cycle {
            self.wait = SPACING;
        }
        Some(self.unsent.take().unwrap_or_default())
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use super::*;

    fn state(code_index: u8) -> TrainState {
        TrainState {
            code_index,
            ..TrainState::default()
        }
    }

    /// Codes scan by scan from the first of a cycle, and the age reported in each scan.
    fn told(codes: &[u8], changes: bool) -> Vec<Option<u8>> {
        let mut report = StateReport::default();
        let scans = codes.iter().enumerate();
        scans
            .map(|(i, &code)| report.step((&state(code), 0), changes, i % 5 == 0))
            .collect()
    }

    #[test]
    fn a_change_is_told_in_its_scan() {
        let expected = [Some(0), None, Some(0), None, None, Some(0)];
        assert_eq!(told(&[0, 0, 1, 1, 1, 1], true), expected);
    }

    #[test]
    fn a_second_change_within_30_ms_waits_and_says_how_long() {
        let expected = [Some(0), Some(0), None, None, Some(2), Some(0)];
        assert_eq!(told(&[0, 1, 2, 3, 3, 3], true), expected);
    }

    #[test]
    fn without_changes_at_once_the_cycle_says_how_old_the_first_one_is() {
        let expected = [Some(0), None, None, None, None, Some(3)];
        assert_eq!(told(&[0, 0, 1, 2, 2, 2], false), expected);
    }

    #[test]
    fn what_changed_before_a_tester_subscribed_is_not_held() {
        let mut report = StateReport::default();
        assert_eq!(report.step((&state(1), 0), true, false), None);
        assert_eq!(report.step((&state(1), 0), true, true), Some(0));
    }
}
