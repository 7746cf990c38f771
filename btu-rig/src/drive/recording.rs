//! Gathers the rows and the unit's log while a run goes on.

use protocol::signal::Signal;
use protocol::{CYCLE, Instant};

use super::{DrivePlan, Ending, Landmark, Metrics, Outcome, Row, landmarks};
use crate::procedure::UnitEvent;
use crate::rig::Rig;

/// Cycles over which jerk is the change of acceleration: 200 ms.
const JERK_CYCLES: usize = 4;

/// Rows and log so far.
#[derive(Debug, Default)]
pub(super) struct Recording {
    /// Rows are kept.
    pub on: bool,
    /// The rig's position when the section was laid, m.
    pub begins_at_m: f64,
    /// When the train began to move.
    pub moves_since: Option<Instant>,
    rows: Vec<Row>,
    /// Entries of the unit's log and when they were read.
    log: Vec<(Instant, UnitEvent)>,
}

impl Recording {
    /// Keeps new entries of the unit's log.
    pub fn hear_events(&mut self, now: Instant, events: Vec<UnitEvent>) {
        self.log
            .extend(events.into_iter().map(|event| (now, event)));
    }

    /// One cycle.
    pub fn record(&mut self, now: Instant, x_m: f64, rig: &Rig) {
        if !self.on {
            return;
        }
        let sample = rig.sample();
        let get = |signal| sample.get(signal).unwrap_or(f64::NAN);
        let speed_kmh = get(Signal::TrainSpeed);
        let before = self.rows.last().map_or(speed_kmh, |row| row.speed_kmh);
        let accel_mps2 = (speed_kmh - before) / 3.6 / CYCLE.as_secs();
        let earlier = self
            .rows
            .len()
            .checked_sub(JERK_CYCLES)
            .map(|i| self.rows[i].accel_mps2);
        let jerk_mps3 = earlier.map_or(0.0, |a| {
            (accel_mps2 - a) / (JERK_CYCLES as f64 * CYCLE.as_secs())
        });
        self.rows.push(Row {
            t_s: now.as_secs(),
            x_m,
            speed_kmh,
            measured_kmh: get(Signal::Speed),
            limit_kmh: get(Signal::Limit),
            target_kmh: get(Signal::Target),
            effort: get(Signal::Effort),
            accel_mps2,
            jerk_mps3,
            position_m: get(Signal::Position),
            power_w: 0.0,
            marker: get(Signal::MarkerCoil) as u8,
        });
    }

    /// What it all came to.
    pub fn outcome(mut self, ending: Ending, plan: &DrivePlan) -> Outcome {
        let zero = self.moves_since.map_or(f64::NAN, Instant::as_secs);
        for row in &mut self.rows {
            row.t_s -= zero;
        }
        let metrics = self
            .moves_since
            .and_then(|_| Metrics::of(&self.rows, plan.section.stop_m));
        let mut found: Vec<Landmark> = landmarks::of_rows(&self.rows, plan.below_limit_kmh);
        found.extend(landmarks::of_log(&self.log, zero, &self.rows));
        found.sort_by(|a, b| a.t_s.total_cmp(&b.t_s));
        Outcome {
            ending,
            landmarks: found,
            metrics,
            rows: self.rows,
        }
    }
}
