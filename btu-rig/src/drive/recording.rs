//! Collects rows and the unit's log during an automatic run.

use protocol::signal::Signal;
use protocol::{CYCLE, Instant, SCAN};

use super::{DrivePlan, Ending, Landmark, Metrics, Outcome, Row, landmarks};
use crate::procedure::UnitEvent;
use crate::rig::{Rig, Truth};

/// Rows of a usual run, so that they need not move as they come.
const USUAL_ROWS: usize = 2_500;

/// Rows and log so far.
#[derive(Debug, Default)]
pub(super) struct Recording {
    /// Rows are kept.
    pub on: bool,
    /// When the train began to move.
    pub moves_since: Option<Instant>,
    /// Since when it stands after having moved.
    pub stands_since: Option<Instant>,
    rows: Vec<Row>,
    /// Work of traction in the present cycle, J.
    work_j: f64,
    to_stop_m: Option<f64>,
    /// Entries of the unit's log and when they were read.
    log: Vec<(Instant, UnitEvent)>,
}

impl Recording {
    /// One scan.
    pub fn scan(&mut self, now: Instant, truth: &Truth, rig: &mut Rig) {
        let read = rig.take_events().into_iter();
        self.log.extend(read.map(|event| (now, event)));
        self.to_stop_m = truth.to_stop_m;
        self.work_j += truth.tractive_power_w.max(0.0) * SCAN.as_secs();
        if !now.as_us().is_multiple_of(CYCLE.as_us()) {
            return;
        }
        let power_w = std::mem::take(&mut self.work_j) / CYCLE.as_secs();
        if !self.on {
            return;
        }
        if self.rows.capacity() == 0 {
            self.rows.reserve(USUAL_ROWS);
        }
        let sample = rig.sample();
        let get = |signal| sample.get(signal).unwrap_or(f64::NAN);
        self.rows.push(Row {
            t_s: now.as_secs(),
            x_m: truth.position_m,
            speed_kmh: truth.speed_mps * 3.6,
            measured_kmh: get(Signal::Speed),
            limit_kmh: get(Signal::Limit),
            target_kmh: get(Signal::Target),
            effort: get(Signal::Effort),
            accel_mps2: get(Signal::TrainAccel),
            jerk_mps3: get(Signal::TrainJerk),
            position_m: get(Signal::Position),
            traction_n: truth.traction_n,
            electric_brake_n: truth.electric_brake_n,
            air_brake_n: truth.air_brake_n,
            power_w,
            sliding: truth.sliding,
        });
    }

    /// What it all came to.
    pub fn outcome(mut self, ending: Ending, plan: &DrivePlan) -> Outcome {
        let Some(zero) = self.moves_since else {
            return Outcome {
                ending,
                rows: self.rows,
                landmarks: Vec::new(),
                stop_error_m: None,
                metrics: None,
            };
        };
        let zero_s = zero.as_secs();
        for row in &mut self.rows {
            row.t_s -= zero_s;
        }
        let stop = self
            .stands_since
            .zip(self.to_stop_m)
            .map(|(at, left_m)| Landmark {
                t_s: at.since(zero).as_secs(),
                x_m: plan.section.stop_m - left_m,
                what: "stop".into(),
            });
        let stop_error_m = stop.as_ref().map(|stop| stop.x_m - plan.section.stop_m);
        let run_time_s = stop.as_ref().map(|stop| stop.t_s);
        let metrics = Metrics::of(&self.rows, run_time_s);
        let mut found = landmarks::of_rows(&self.rows, plan);
        let places: Vec<_> = self.rows.iter().map(|row| (row.t_s, row.x_m)).collect();
        found.extend(landmarks::of_log(&self.log, zero_s, &places));
        found.extend(stop);
        found.sort_by(|a, b| a.t_s.total_cmp(&b.t_s));
        Outcome {
            ending,
            rows: self.rows,
            landmarks: found,
            stop_error_m,
            metrics,
        }
    }
}
