//! Collects rows and the logs of unit and TCMS during a run.

use protocol::{CYCLE, Instant, SCAN};

use super::{Landmark, Row, landmarks};
use crate::procedure::UnitEvent;
use crate::recorder;
use crate::rig::{Rig, TrueMotion};

/// Rows of a usual run: room for as many is reserved, so that rows need not be moved as the run grows.
const USUAL_ROWS: usize = 2_500;

#[derive(Debug, Default)]
pub(super) struct Recording {
    /// Time from which rows are kept; `None` = no row is kept yet.
    pub began: Option<Instant>,
    pub rows: Vec<Row>,
    /// Work of traction in the present cycle, J.
    work_j: f64,
    /// Entries of both logs and when they were read.
    log: Vec<(Instant, UnitEvent)>,
}

impl Recording {
    /// Records one scan. Rows have bench time, until the end of the run makes it time since the train began to move.
    pub fn scan(&mut self, now: Instant, truth: &TrueMotion, rig: &mut Rig) {
        let read = rig.take_events().into_iter();
        self.log.extend(read.map(|event| (now, event)));
        self.work_j += truth.tractive_power_w.max(0.0) * SCAN.as_secs();
        if !now.as_us().is_multiple_of(CYCLE.as_us()) {
            return;
        }
        let power_w = std::mem::take(&mut self.work_j) / CYCLE.as_secs();
        if self.began.is_none() {
            return;
        }
        if self.rows.capacity() == 0 {
            self.rows.reserve(USUAL_ROWS);
        }
        self.rows.push(Row {
            signals: recorder::Row {
                at: now,
                sample: rig.sample().clone(),
            },
            t_s: now.as_secs(),
            x_m: truth.position_m,
            speed_kmh: truth.speed_mps * 3.6,
            power_w,
            sliding: truth.sliding,
        });
    }

    /// Entries that unit and TCMS logged, at their own times since `zero_s`, when the train began to move.
    pub fn logged(&self, zero_s: f64) -> Vec<Landmark> {
        landmarks::of_log(&self.log, zero_s, &self.rows)
    }
}
