//! Progress of a run, computed from its events.

use std::sync::Arc;
use std::time;

use btu_rig::procedure::plan::{Action, Step};
use btu_rig::procedure::{
    Findings, Measurement, Outside, OutsideStep, Procedure, ResultKind, RunEvent, StepResult,
    Verdict,
};
use fault_db::{StepCounter, StepCounts};
use protocol::Duration;

use crate::clock::now_us;
use crate::coverage::Coverage;
use crate::run::{FaultSeen, Outcome, RunPlan, SessionEvent, different_steps, steps_of};
use crate::stored::{WHOLE_RUN, stored, whole_run};

/// Most results, and most faults, kept to be looked at: of a longer run only results that did not pass are added. The
/// database has all.
const KEPT: usize = 5_000;

/// A run's procedures, steps, measurements and faults so far.
#[derive(Debug)]
pub struct Progress {
    pub unit: String,
    /// SHA-256 over the scripts of the run.
    pub scripts_sha256: String,
    /// Procedures in order, and last what was said of the run as a whole.
    pub procedures: Vec<ProcedureProgress>,
    /// Steps in all, repetitions counted: the length of the run.
    steps: usize,
    /// Steps that are over, repetitions counted.
    done: usize,
    /// Results, and entries outside steps, that neither passed nor were skipped.
    pub not_passed: usize,
    /// Different steps that are due.
    planned: usize,
    /// Steps by procedure and place in it.
    counter: StepCounter<(usize, usize)>,
    pub present: Option<RunPosition>,
    /// Faults found, in order.
    pub faults: Vec<FaultSeen>,
    /// The outcome once the run has ended; the inner `None` = it could not be started or recorded.
    pub ended: Option<Option<Outcome>>,
    /// When it ended, µs since 1970.
    pub ended_us: i64,
    began: time::Instant,
    /// Worst-case time of the steps that are still to come.
    worst_left: Duration,
}

#[derive(Debug)]
pub struct ProcedureProgress {
    pub procedure: Arc<Procedure>,
    /// Places of its steps that are to run.
    pub chosen: Vec<usize>,
    /// Results of its steps, in the order in which they ran, and what failed outside them: [`outside_place`].
    pub results: Vec<StepResult>,
    /// Verdict of the procedure once it has ended.
    pub verdict: Option<Verdict>,
    /// Findings outside the procedure's steps.
    pub findings: Findings,
}

/// The procedure and step that a run has reached.
#[derive(Clone, Debug, Default)]
pub struct RunPosition {
    /// Place of the procedure in the run.
    pub procedure: usize,
    /// Place of the step in its procedure, once one has begun.
    pub step: Option<usize>,
    /// The step's name.
    pub name: String,
    /// Number of the repetition of the step, from 1, and number of repetitions.
    pub turn: [u32; 2],
    /// Condition that is waited for, and until when.
    pub waiting: Option<Waiting<Action>>,
    /// Question to the operator, and until when.
    pub prompt: Option<Waiting<String>>,
    /// Name of the step before which the run is paused.
    pub paused: Option<String>,
    /// Measurements of the step so far.
    pub measured: Vec<Measurement>,
}

/// Something that may take until a moment on the wall clock.
#[derive(Clone, Debug)]
pub struct Waiting<T> {
    pub what: T,
    /// Longest time that it could still take at `said`.
    pub left: Duration,
    /// When it was reported.
    pub said: time::Instant,
}

impl<T> Waiting<T> {
    fn new(what: T, left: Duration) -> Self {
        Self {
            what,
            left,
            said: time::Instant::now(),
        }
    }

    /// Seconds still left now.
    pub fn left_s(&self) -> f64 {
        (self.left.as_secs() - self.said.elapsed().as_secs_f64()).max(0.0)
    }
}

impl Progress {
    /// Counts of the steps so far, of all that are due.
    pub fn counts(&self) -> StepCounts {
        self.counter.counts(self.planned)
    }

    /// Coverage: the share of due steps that were run.
    pub fn coverage(&self) -> Coverage {
        let on_bench = self.procedures.iter().flat_map(|progress| {
            let results = progress.results.iter();
            let skipped = results.filter(|step| step.verdict == Verdict::Skipped);
            let on_bench = skipped.filter(|step| step.findings.need_harness());
            on_bench.map(|step| (&*progress.procedure.id, Some(step.index as u32)))
        });
        Coverage::of(self.counts(), on_bench)
    }

    /// Progress of a plan that has not begun, on this unit.
    pub fn new(plan: &RunPlan, unit: String) -> Self {
        let procedure = |task: &crate::run::Task| {
            ProcedureProgress::of(task.procedure.clone(), task.options.chosen.clone())
        };
        let procedures: Vec<_> = plan.tasks.iter().map(procedure).collect();
        let worst_left = procedures
            .iter()
            .zip(&plan.tasks)
            .flat_map(|(progress, task)| {
                let repeat = u64::from(task.options.repeat);
                progress.chosen.iter().filter_map(move |place| {
                    let step = progress.procedure.steps.get(*place)?;
                    let turns = repeat * u64::from(step.repeat);
                    Some(Duration::from_us(step.worst_case.as_us() * turns))
                })
            })
            .fold(Duration::ZERO, |sum, step| sum + step);
        Self {
            unit,
            scripts_sha256: plan.scripts_sha256.clone(),
            steps: steps_of(&plan.tasks),
            procedures,
            done: 0,
            not_passed: 0,
            planned: different_steps(&plan.tasks),
            counter: StepCounter::default(),
            present: None,
            faults: Vec::new(),
            ended: None,
            ended_us: 0,
            began: time::Instant::now(),
            worst_left,
        }
    }

    /// Takes an event of the procedure called `id`.
    pub fn on_event(&mut self, id: &str, event: &SessionEvent) {
        if id == WHOLE_RUN && self.place(id).is_none() {
            self.procedures
                .push(ProcedureProgress::of(Arc::new(whole_run()), None));
        }
        let Some(place) = self.place(id) else { return };
        match event {
            SessionEvent::Run(event) => self.event(place, event),
            SessionEvent::Fault(fault) if self.faults.len() < KEPT => {
                self.faults.push(fault.clone())
            }
            SessionEvent::Ended { .. } => self.present = None,
            SessionEvent::Fault(_)
            | SessionEvent::LinkLost(_)
            | SessionEvent::Trace(_)
            | SessionEvent::Rows(_)
            | SessionEvent::Recording(_) => {}
        }
    }

    pub fn end(&mut self, outcome: Option<Outcome>) {
        self.present = None;
        self.ended = Some(outcome);
        self.ended_us = now_us();
    }

    pub fn is_running(&self) -> bool {
        self.ended.is_none()
    }

    /// The run's id once it is over and recorded.
    pub fn id(&self) -> Option<fault_db::Id> {
        self.ended.as_ref()?.as_ref().map(|outcome| outcome.id)
    }

    pub fn step(&self) -> Option<&Step> {
        let present = self.present.as_ref()?;
        let procedure = &self.procedures.get(present.procedure)?.procedure;
        procedure.steps.get(present.step?)
    }

    /// Share of the steps that are over, 0 to 1.
    pub fn share(&self) -> f32 {
        if self.steps == 0 {
            return 0.0;
        }
        (self.done as f32 / self.steps as f32).min(1.0)
    }

    /// Bench time still to come at most, s. An estimate by how long the steps before took would grow with each slow one.
    pub fn left_s(&self) -> f64 {
        self.worst_left.as_secs()
    }

    /// Time since it was begun, s.
    pub fn elapsed_s(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }

    /// The place of a procedure that is not over, as an adaptive run may do one twice; else of the first called `id`.
    fn place(&self, id: &str) -> Option<usize> {
        let named = |progress: &ProcedureProgress| progress.procedure.id == id;
        let open = |progress: &ProcedureProgress| named(progress) && progress.verdict.is_none();
        let places = self.procedures.iter();
        places
            .clone()
            .position(open)
            .or_else(|| self.procedures.iter().position(named))
    }

    fn event(&mut self, place: usize, event: &RunEvent) {
        match event {
            RunEvent::ProcedureStarted { .. } => self.present = Some(RunPosition::of(place)),
            RunEvent::StepStarted {
                index,
                name,
                turn,
                turns,
                ..
            } => {
                self.present = Some(RunPosition {
                    step: Some(*index),
                    name: name.clone(),
                    turn: [*turn, *turns],
                    ..RunPosition::of(place)
                });
            }
            RunEvent::Paused { next, .. } => {
                let present = self.present.get_or_insert_with(|| RunPosition::of(place));
                present.waiting = None;
                present.paused = Some(next.clone());
            }
            RunEvent::Waiting { action, left } => {
                if let Some(present) = &mut self.present {
                    present.waiting = Some(Waiting::new(action.clone(), *left));
                }
            }
            RunEvent::Prompt { text, left } => {
                if let Some(present) = &mut self.present {
                    present.prompt = Some(Waiting::new(text.clone(), *left));
                }
            }
            RunEvent::Measured { measurement, .. } => {
                if let Some(present) = &mut self.present {
                    present.measured.push(measurement.clone());
                }
            }
            RunEvent::StepFinished(result) => self.step_finished(place, result),
            RunEvent::OutsideStep(entry) => self.outside_step(place, entry),
            RunEvent::ProcedureFinished {
                verdict, findings, ..
            } => {
                let progress = &mut self.procedures[place];
                progress.verdict = Some(*verdict);
                progress.findings.clone_from(findings);
                self.present = None;
            }
            RunEvent::UnsolicitedEvent(_)
            | RunEvent::UnsolicitedBrake { .. }
            | RunEvent::UnitClockWrong { .. } => {}
        }
    }

    fn outside_step(&mut self, place: usize, entry: &OutsideStep) {
        self.counter.note_outside(stored(entry.verdict));
        self.not_passed += 1;
        if self.not_passed < KEPT {
            self.procedures[place].results.push(StepResult {
                index: OUTSIDE,
                name: entry.place.name().to_owned(),
                turn: 1,
                turns: 1,
                kind: ResultKind::Step,
                line: 0,
                verdict: entry.verdict,
                findings: entry.finding.clone().into(),
                suspect: None,
                started: entry.at,
                bench_time: Duration::ZERO,
                limit_source: None,
                measurements: Vec::new(),
            });
        }
    }

    fn step_finished(&mut self, place: usize, result: &StepResult) {
        self.done += usize::from(result.kind != ResultKind::Attempt);
        self.counter
            .note((place, result.index), stored(result.verdict));
        let passed = matches!(result.verdict, Verdict::Passed | Verdict::Skipped);
        self.not_passed += usize::from(!passed);
        let progress = &mut self.procedures[place];
        if let Some(step) = progress.procedure.steps.get(result.index) {
            self.worst_left = self.worst_left - step.worst_case;
        }
        if self.done < KEPT || (!passed && self.not_passed < KEPT) {
            progress.results.push(result.clone());
        }
        if let Some(present) = &mut self.present {
            present.waiting = None;
            present.prompt = None;
        }
    }
}

/// Where `result` failed, if it is not of a step of the procedure.
pub fn outside_place(result: &StepResult) -> Option<Outside> {
    Outside::from_name(&result.name).filter(|_| result.index == OUTSIDE)
}

/// Index of a result that is not of a step.
const OUTSIDE: usize = usize::MAX;

impl ProcedureProgress {
    /// Progress of a procedure that has not begun; `chosen` = places of its steps that run, none =
    /// all.
    fn of(procedure: Arc<Procedure>, chosen: Option<Vec<usize>>) -> Self {
        Self {
            chosen: chosen.unwrap_or_else(|| (0..procedure.steps.len()).collect()),
            procedure,
            results: Vec::new(),
            verdict: None,
            findings: Findings::default(),
        }
    }
}

impl RunPosition {
    fn of(procedure: usize) -> Self {
        Self {
            procedure,
            turn: [1, 1],
            ..Self::default()
        }
    }
}
