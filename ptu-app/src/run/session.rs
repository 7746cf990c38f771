//! Runs one procedure on one bench, scan by scan, and says what happens as a stream.

use std::cell::Cell;
use std::sync::Arc;

use btu_rig::procedure::runner::SAFE_WITHIN;
use btu_rig::procedure::{
    EventSource, Poll, Procedure, RunEvent, RunOptions, Runner, StepResult, UnitEvent, Verdict,
};
use btu_rig::recorded::{RecordingDriver, StimulusPlayer, StimulusRecord};
use btu_rig::rig::{Bench, UnitLink};
use fault_db::TraceData;
use protocol::signal::Sample;
use protocol::{CYCLE, Duration, Instant, SCAN};

use super::RunControl;
use super::fault_watch::{self, FaultSeen};
use super::recorder::{Cut, Recorder};
use super::rounds::Rounds;
use super::settle::between_procedures;
use crate::link::Pace;
use crate::stop::Stop;

/// A bench less behind than this is in time.
const IN_TIME: Duration = Duration::from_us(2 * SCAN.as_us());

/// What happens while a procedure runs on a bench. Times are bench times.
#[derive(Clone, Debug)]
pub enum SessionEvent {
    /// From the runner.
    Run(RunEvent),
    /// A fault was found; its number counts from 0 in this procedure.
    Fault(FaultSeen),
    /// The window around faults is complete.
    Trace(Box<Cut>),
    /// What was done to the bench in a procedure whose traces came before.
    Recording(Box<RecordedStimuli>),
    /// Nothing can be judged any more: the unit cannot be reached, another one answers, or its log cannot
    /// be read.
    LinkLost(String),
    /// Nothing more comes.
    Ended {
        /// Bench time this procedure took, bring-up included.
        bench_time: Duration,
    },
}

/// What was done to the bench in one procedure, on the bench's clock.
#[derive(Clone, Debug)]
pub struct RecordedStimuli {
    /// When the procedure began.
    pub began: Instant,
    /// What was done.
    pub record: StimulusRecord,
}

/// A bench, its recorder and its pace.
pub struct Session<L: UnitLink> {
    bench: Bench<L>,
    pace: Pace,
    stop: Stop,
    recorder: Recorder,
    sample: Sample,
    link_error: Option<String>,
    /// How far the bench may lag behind the wall clock; `None` for a unit in virtual time.
    max_lag: Option<Duration>,
    /// Largest lag beyond `max_lag` since it was last taken.
    stalled: Option<Duration>,
    fresh_unit: bool,
    run_control: Option<Arc<dyn RunControl>>,
    /// Virtual time goes at the clock's pace, because a person is waited for.
    with_person: bool,
}

/// A window of time on a bench.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    /// First row.
    pub from: Instant,
    /// Row that is the trigger.
    pub trigger: Instant,
    /// Last row.
    pub until: Instant,
}

/// What one procedure has come to so far.
struct Progress<'a> {
    procedure: &'a Procedure,
    step: Option<usize>,
    turn: usize,
    step_began: Instant,
    explained: bool,
    faults: usize,
}

impl<L: UnitLink> Session<L> {
    /// A session on `bench`; `fresh_unit` = it is powered up within the session, so that all it
    /// logs belongs to it.
    pub fn new(bench: Bench<L>, pace: Pace, stop: Stop, fresh_unit: bool) -> Self {
        Self {
            bench,
            pace,
            stop,
            recorder: Recorder::default(),
            sample: Sample::default(),
            link_error: None,
            max_lag: None,
            stalled: None,
            fresh_unit,
            run_control: None,
            with_person: false,
        }
    }

    /// From now on somebody looks on.
    pub fn controlled_by(mut self, run_control: Option<Arc<dyn RunControl>>) -> Self {
        self.run_control = run_control;
        self
    }

    /// Sets the lag beyond which a unit in real time misses its inputs and brakes, so that nothing it does then
    /// is judged.
    pub fn with_max_lag(mut self, max_lag: Duration) -> Self {
        self.max_lag = Some(max_lag);
        self
    }

    /// Replaces the stop that ends runs on this session.
    pub fn set_stop(&mut self, stop: &Stop) {
        self.stop = stop.clone();
    }

    /// From now on scans are paced like this.
    pub fn set_pace(&mut self, pace: Pace) {
        self.pace = pace;
    }

    /// The bench.
    pub fn bench(&mut self) -> &mut Bench<L> {
        &mut self.bench
    }

    /// Time on the bench.
    pub fn now(&self) -> Instant {
        self.bench.now()
    }

    /// Scans until `done` or for `at_most`; events of the unit go to `seen`. False when time ran
    /// out, the link broke or stop was pressed.
    pub fn idle(
        &mut self,
        at_most: Duration,
        mut seen: impl FnMut(&UnitEvent, Instant, &Sample),
        mut done: impl FnMut(&Bench<L>) -> bool,
    ) -> bool {
        let until = self.bench.now() + at_most;
        while self.bench.now() < until && self.stop.presses() == 0 && self.link_error.is_none() {
            self.scan(&mut |_| {});
            for entry in self.take_events() {
                seen(&entry, self.bench.now(), &self.sample);
            }
            if done(&self.bench) {
                return true;
            }
        }
        false
    }

    /// Whether the bench lagged more than the maximum since the last call.
    pub fn was_stalled(&mut self) -> bool {
        self.stalled.take().is_some()
    }

    /// Makes up the scans that were missed; events go to `seen`.
    pub fn catch_up(&mut self, mut seen: impl FnMut(&UnitEvent, Instant, &Sample)) {
        self.make_up(&mut |_| {}, &mut seen);
    }

    fn make_up(
        &mut self,
        cut: &mut dyn FnMut(Cut),
        seen: &mut dyn FnMut(&UnitEvent, Instant, &Sample),
    ) {
        // A computer that is too slow for good never catches up.
        let at_most = 100 + 3 * self.behind().as_us() / SCAN.as_us();
        for _ in 0..at_most {
            if self.behind() < IN_TIME || self.stop.presses() > 0 || self.link_error.is_some() {
                break;
            }
            self.scan(cut);
            for entry in self.take_events() {
                seen(&entry, self.bench.now(), &self.sample);
            }
        }
    }

    /// How far the bench is behind a unit that goes on by itself.
    fn behind(&self) -> Duration {
        self.max_lag.map_or(Duration::ZERO, |_| self.pace.behind())
    }

    /// Why nothing can be sent or received any more, if so.
    pub fn link_failure(&self) -> Option<&str> {
        self.link_error.as_deref()
    }

    /// Why nothing can be judged, if so: the unit cannot be reached, another one answers, or its log cannot
    /// be read.
    pub fn link_error(&self) -> Option<String> {
        self.link_error
            .clone()
            .or_else(|| self.bench.rig().link_error())
    }

    /// New entries of the unit's log. What it logged before this bench was heard is history.
    fn take_events(&mut self) -> Vec<UnitEvent> {
        let rig = self.bench.rig_mut();
        let mut events = rig.take_events();
        if rig.unit_restarts() == 0
            && let Some(first) = rig.events_at_contact().filter(|_| !self.fresh_unit)
        {
            events.retain(|entry| entry.source != EventSource::Unit || entry.index >= first);
        }
        events
    }

    /// One scan of the bench, recorded; a completed window goes to `cut`.
    fn scan(&mut self, cut: &mut dyn FnMut(Cut)) {
        self.pace.wait();
        if let Err(failure) = self.bench.tick() {
            self.link_error.get_or_insert(failure.to_string());
        }
        let behind = self.behind();
        if self.max_lag.is_some_and(|max_lag| behind > max_lag) {
            self.stalled = self.stalled.max(Some(behind));
            let now = self.bench.now();
            self.bench.rig_mut().note_stalled(now);
        }
        self.sample.clone_from(self.bench.rig().sample());
        let now = self.bench.now();
        if !now.as_us().is_multiple_of(CYCLE.as_us()) {
            return;
        }
        if let Some(run_control) = &self.run_control {
            run_control.after_cycle(now, self.bench.rig());
        }
        if let Some(done) = self.recorder.record(now, &self.sample) {
            cut(done);
        }
    }

    /// Judges what the unit logged while it was brought up: nobody had provoked anything yet.
    pub fn judge_bring_up(
        &mut self,
        at_most: Duration,
        done: impl FnMut(&Bench<L>) -> bool,
    ) -> (bool, Vec<FaultSeen>) {
        let mut faults = Vec::new();
        let ready = self.idle(
            at_most,
            |entry, at, sample| {
                if fault_watch::is_fault(entry) {
                    faults.push(fault_watch::of_event(entry, at, sample));
                }
            },
            done,
        );
        (ready, faults)
    }

    /// Runs a procedure as often as it is to be repeated, each time with its set-up and clean-up, or as long as
    /// `go_on` says so after a step; `found` are faults of the bring-up.
    pub fn run(
        &mut self,
        procedure: &Arc<Procedure>,
        options: RunOptions,
        found: Vec<FaultSeen>,
        sink: &mut dyn FnMut(SessionEvent),
        go_on: &dyn Fn() -> bool,
    ) {
        let traced = Cell::new(false);
        let mut sink = |event: SessionEvent| {
            traced.set(traced.get() || matches!(event, SessionEvent::Trace(_)));
            sink(event);
        };
        let sink = &mut sink;
        let mut recorded = RecordedStimuli {
            began: self.bench.now(),
            record: StimulusRecord::default(),
        };
        let mut rounds = Rounds::new(options.repeat);
        let mut runner = Runner::new(procedure.clone(), options.clone(), rounds.over());
        let mut progress = Progress {
            procedure,
            step: None,
            turn: 0,
            step_began: self.bench.now(),
            explained: false,
            faults: 0,
        };
        for fault in found {
            runner.found_before(&fault.name);
            self.report(fault, &mut progress, sink);
        }
        let mut presses = 0;
        let mut link_lost = false;
        loop {
            let mut cut = |cut| sink(SessionEvent::Trace(Box::new(cut)));
            self.scan(&mut cut);
            if self.stalled.is_some() {
                // What the unit logs meanwhile is not its own doing.
                self.make_up(&mut cut, &mut |_, _, _| {});
            }
            let pressed = self.stop.presses();
            for press in presses..pressed {
                match self.stop.reason().filter(|_| press == 0) {
                    Some(reason) => runner.bench_stalled(reason.to_owned()),
                    None => runner.stop(),
                }
            }
            presses = pressed;
            if let Some(behind) = self.stalled.take() {
                runner.bench_stalled(stall_message(behind));
            }
            runner.behind(self.behind());
            let now = self.bench.now();
            let events = self.take_events();
            let link_error = self.link_error();
            if let Some(error) = link_error.as_ref().filter(|_| !link_lost) {
                link_lost = true;
                sink(SessionEvent::LinkLost(error.clone()));
            }
            if let Some(run_control) = &self.run_control {
                run_control.before_scan(&mut runner);
            }
            self.wait_with(runner.awaits_operator());
            let mut rig = RecordingDriver::new(self.bench.rig_mut(), &mut recorded.record);
            let poll = runner.advance(now, &self.sample, &events, link_error.as_deref(), &mut rig);
            for event in runner.take_events() {
                self.note(&event, &mut progress, sink);
                if let Some(event) = rounds.take(event) {
                    sink(SessionEvent::Run(event));
                }
            }
            if !go_on() {
                runner.leave();
            }
            if poll == Poll::Running {
                continue;
            }
            self.wait_with(false);
            self.finish_window(sink);
            let failed = |rounds: &Rounds, progress: &Progress<'_>| {
                options.stop_on_fail && (!rounds.passed() || progress.faults > 0)
            };
            if !rounds.left() || link_lost || !go_on() || failed(&rounds, &progress) {
                break;
            }
            let settled = self.settle_again(&mut rounds, &mut progress, sink);
            if !settled || failed(&rounds, &progress) {
                break;
            }
            runner = Runner::new(procedure.clone(), options.clone(), rounds.over());
        }
        sink(SessionEvent::Run(
            rounds.finished(link_lost, self.bench.now()),
        ));
        if traced.get() {
            sink(SessionEvent::Recording(Box::new(recorded)));
        }
    }

    /// Before the next repetition of a procedure the unit settles as between two procedures. False if stop was
    /// pressed: then it is not begun.
    fn settle_again(
        &mut self,
        rounds: &mut Rounds,
        progress: &mut Progress<'_>,
        sink: &mut dyn FnMut(SessionEvent),
    ) -> bool {
        progress.step = None;
        progress.step_began = self.bench.now();
        for fault in between_procedures(self) {
            let found = format!("found before the next repetition: {}", fault.name);
            rounds.note(Verdict::Failed, found);
            self.report(fault, progress, sink);
        }
        let stopped = self.stop.presses() > 0;
        if stopped {
            rounds.note(Verdict::Aborted, "stopped by the operator".into());
        }
        !stopped
    }

    /// Repeats recorded stimuli up to `until` and keeps every scan from `from` on as a trace.
    /// `None` when nothing could be recorded. What the bench refused goes to `refused`.
    pub fn play(
        &mut self,
        mut player: StimulusPlayer<'_>,
        window: Window,
        refused: &mut Vec<String>,
    ) -> Option<TraceData> {
        // A unit that falls silent is what some traces show: only a broken connection ends it early.
        while self.bench.now() < window.until
            && self.stop.presses() == 0
            && self.link_error.is_none()
        {
            self.scan(&mut |_| {});
            self.take_events();
            let now = self.bench.now();
            let refusals = player.play(now, self.bench.rig_mut());
            refused.extend(refusals.into_iter().map(|refusal| refusal.0));
        }
        let partial = self.bench.now() < window.until;
        self.recorder.trace(window.from, window.trigger, partial)
    }

    /// Brings the bench to the quiescent state, for as long as that may take.
    pub fn make_safe(&mut self) -> bool {
        let until = self.bench.now() + SAFE_WITHIN;
        while self.bench.now() < until && self.link_error().is_none() {
            let now = self.bench.now();
            self.bench.rig_mut().make_safe(now);
            if self.bench.rig().safe() {
                return true;
            }
            self.scan(&mut |_| {});
            self.take_events();
        }
        false
    }

    /// A person takes time by the clock: virtual time keeps to it while one is waited for.
    fn wait_with(&mut self, waits: bool) {
        match (waits, self.with_person, &self.pace) {
            (true, false, Pace::Virtual) => {
                self.with_person = true;
                self.pace = Pace::real();
            }
            (false, true, _) => {
                self.with_person = false;
                self.pace = Pace::Virtual;
            }
            _ => {}
        }
    }

    /// Lets an open window run out on a quiet bench. What is logged meanwhile waits for whoever idles next.
    fn finish_window(&mut self, sink: &mut dyn FnMut(SessionEvent)) {
        while self.recorder.is_open() && self.stop.presses() == 0 && self.link_error().is_none() {
            self.scan(&mut |cut| sink(SessionEvent::Trace(Box::new(cut))));
        }
        if let Some(cut) = self.recorder.close(true) {
            sink(SessionEvent::Trace(Box::new(cut)));
        }
    }

    fn note(
        &mut self,
        event: &RunEvent,
        progress: &mut Progress<'_>,
        sink: &mut dyn FnMut(SessionEvent),
    ) {
        let now = self.bench.now();
        let fault = match event {
            RunEvent::StepStarted { index, at, .. } => {
                progress.step = Some(*index);
                progress.step_began = *at;
                progress.explained = false;
                return;
            }
            RunEvent::UnsolicitedEvent(entry) => {
                Some(fault_watch::of_event(entry, now, &self.sample))
            }
            RunEvent::UnsolicitedBrake { at } => {
                (!progress.explained).then(|| fault_watch::of_brake(*at, &self.sample))
            }
            RunEvent::StepFinished(result) => {
                let fault = self.fault_of_step(result, progress);
                if let Some(fault) = fault {
                    self.report(fault, progress, sink);
                }
                progress.turn += 1;
                return;
            }
            _ => None,
        };
        if let Some(fault) = fault {
            progress.explained = true;
            self.report(fault, progress, sink);
        }
    }

    fn fault_of_step(&self, result: &StepResult, progress: &Progress<'_>) -> Option<FaultSeen> {
        fault_watch::of_step(progress.procedure, result, progress.explained, &self.sample)
    }

    fn report(
        &mut self,
        mut fault: FaultSeen,
        progress: &mut Progress<'_>,
        sink: &mut dyn FnMut(SessionEvent),
    ) {
        fault.step = progress.step.map(|_| progress.turn);
        let done = self
            .recorder
            .trigger(fault.at, progress.step_began, progress.faults);
        progress.faults += 1;
        sink(SessionEvent::Fault(fault));
        if let Some(cut) = done {
            sink(SessionEvent::Trace(Box::new(cut)));
        }
    }
}

fn stall_message(behind: Duration) -> String {
    format!(
        "the tester was held up for {:.2} s by its own computer, which says nothing about the unit; end other \
         programs and run this again",
        behind.as_secs()
    )
}
