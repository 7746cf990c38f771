//! Plan of a run, and the streams of its events.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver};

use btu_rig::procedure::{Procedure, RunOptions};
use diagnosis::{Dictionary, Settings};
use protocol::LruId;

use super::event::SessionEvent;
use crate::words::Warning;

/// Events of one procedure that may wait for the collector.
const QUEUE: usize = 4096;

/// A procedure and what of it is to be run.
pub struct Task {
    pub procedure: Arc<Procedure>,
    /// Steps, repetitions, behaviour on failure.
    pub options: RunOptions,
}

/// Settings that stay the same for a whole run.
pub struct RunPlan {
    /// Procedures in order.
    pub tasks: Vec<Task>,
    /// Benches to run side by side; one on a port.
    pub jobs: usize,
    /// The run ends with the first procedure, in this order, that does not pass.
    pub stop_on_fail: bool,
    /// Name of the tester.
    pub operator: String,
    /// The train the unit is in, as the tester names it; empty if not given.
    pub train: String,
    /// Symptom that was reported with the unit: a name of `symptoms.toml`.
    pub symptom: Option<String>,
    /// SHA-256 over all scripts.
    pub scripts_sha256: String,
    /// What an adaptive run, which isolates a fault instead of running all tasks in order, decides by.
    pub adaptive: Option<Adaptive>,
    /// The earlier run that is continued: the tasks are the procedures it left open.
    pub continues: Option<fault_db::Id>,
    /// Use of the bench's instruments.
    pub measuring: MeasuringRules,
}

impl From<Arc<Procedure>> for Task {
    /// The whole procedure, once.
    fn from(procedure: Arc<Procedure>) -> Self {
        Self {
            procedure,
            options: RunOptions::default(),
        }
    }
}

impl RunPlan {
    /// A plan of these tasks in order on one bench, with defaults for everything else.
    pub fn of(tasks: impl IntoIterator<Item = impl Into<Task>>) -> Self {
        Self {
            tasks: tasks.into_iter().map(Into::into).collect(),
            jobs: 1,
            stop_on_fail: false,
            operator: String::new(),
            train: String::new(),
            symptom: None,
            scripts_sha256: String::new(),
            adaptive: None,
            continues: None,
            measuring: MeasuringRules::default(),
        }
    }
}

/// Use that a run makes of the instruments of its bench.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MeasuringRules {
    /// Instruments whose calibration is over do not hinder the run; the run says so.
    pub uncalibrated: bool,
    /// Limits are narrowed by the uncertainty of what is measured.
    pub guard_band: bool,
}

/// A procedure and the events of its run.
pub(super) type ProcedureStream = (Arc<Procedure>, Receiver<SessionEvent>);

/// Data by which an adaptive run decides.
pub struct Adaptive {
    /// Dictionary: effect of each fault on each check.
    pub dictionary: Dictionary,
    /// Priors and thresholds.
    pub settings: Settings,
    /// Weights of the parts by the unit's history.
    pub lru_factors: BTreeMap<LruId, f64>,
    /// Warnings for the reader of the result.
    pub warnings: Vec<Warning>,
}

/// A stream's two ends.
pub(super) fn stream() -> (mpsc::SyncSender<SessionEvent>, Receiver<SessionEvent>) {
    mpsc::sync_channel(QUEUE)
}

/// Different steps that a plan is to run.
pub fn different_steps(tasks: &[Task]) -> usize {
    let of = |task: &Task| {
        let all = task.procedure.steps.len();
        let chosen = task.options.chosen.as_ref();
        chosen.map_or(all, |chosen| chosen.iter().filter(|at| **at < all).count())
    };
    tasks.iter().map(of).sum()
}

/// Steps a plan will run, repetitions counted.
pub fn steps_of(tasks: &[Task]) -> usize {
    let steps = |task: &Task| {
        let all = &task.procedure.steps;
        let turns: u32 = match &task.options.chosen {
            Some(chosen) => chosen
                .iter()
                .filter_map(|i| all.get(*i))
                .map(|s| s.repeat)
                .sum(),
            None => all.iter().map(|step| step.repeat).sum(),
        };
        turns as usize * task.options.repeat as usize
    };
    tasks.iter().map(steps).sum()
}
