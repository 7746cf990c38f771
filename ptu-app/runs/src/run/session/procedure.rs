//! Runs one procedure on a session's bench, with its repetitions, and emits what happens.

use std::cell::Cell;
use std::sync::Arc;

use btu_rig::procedure::finding::Before;
use btu_rig::procedure::{
    Finding, Outside, Poll, Procedure, RunEvent, RunOptions, Runner, Verdict,
};
use btu_rig::recorded::{RecordingDriver, StimulusRecord};
use btu_rig::rig::UnitLink;
use protocol::Instant;

use super::Session;
use crate::run::event::{RecordedStimuli, SessionEvent};
use crate::run::fault_watch::{self, FaultSeen};
use crate::run::repetitions::RepetitionTally;
use crate::run::settle::between_procedures;

/// Rows that are handed on together: five seconds of them.
const ROWS_AT_ONCE: usize = 100;

/// The state of one procedure's run.
struct Progress<'a> {
    procedure: &'a Procedure,
    step: Option<usize>,
    turn: usize,
    step_began: Instant,
    explained: bool,
    faults: usize,
    /// Steps of which a trace is kept though they pass.
    traced: &'a [usize],
}

impl<L: UnitLink> Session<L> {
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
        let mut rounds = RepetitionTally::new(options.repeat);
        let mut runner = Runner::new(procedure.clone(), options.clone(), rounds.over);
        if let Some(why) = self.bench.rig.cannot_run(procedure) {
            runner.pass_over_all(why);
        }
        let mut progress = Progress {
            procedure,
            step: None,
            turn: 0,
            step_began: self.bench.now(),
            explained: false,
            faults: 0,
            traced: &options.traced,
        };
        for fault in found {
            runner.found_before(&fault.name, fault.at);
            self.report(fault, &mut progress, sink);
        }
        let (mut presses, mut link_lost) = (0, false);
        loop {
            let mut cut = |cut| sink(SessionEvent::Trace(Box::new(cut)));
            self.scan(&mut cut);
            if self.stalled.is_some() {
                // What the unit logs meanwhile is not its own doing.
                self.make_up(&mut cut, &mut |_, _, _| {});
            }
            self.interrupt(&mut runner, &mut presses);
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
            let mut rig = RecordingDriver::new(&mut self.bench.rig, &mut recorded.record);
            let poll = runner.advance(now, &self.sample, &events, link_error.as_ref(), &mut rig);
            self.emit(&mut runner, &mut rounds, &mut progress, sink);
            self.hand_rows(ROWS_AT_ONCE, sink);
            if !go_on() {
                runner.leave();
            }
            if poll == Poll::Running {
                continue;
            }
            self.wait_with(false);
            self.finish_window(sink);
            if let Some(rest) = runner.to_be_resumed().cloned() {
                self.settle_again(Before::RepeatedStep, &mut rounds, &mut progress, sink);
                runner = Runner::resumed(procedure.clone(), options.clone(), rounds.over, rest);
                presses = 0;
                continue;
            }
            let failed = |rounds: &RepetitionTally, progress: &Progress<'_>| {
                options.stop_on_fail && (!rounds.passed() || progress.faults > 0)
            };
            if !rounds.left() || link_lost || !go_on() || failed(&rounds, &progress) {
                break;
            }
            self.settle_again(Before::Repetition, &mut rounds, &mut progress, sink);
            if let Some((verdict, why)) = self.stop.left_out() {
                let now = self.bench.now();
                let event = rounds.outside(Outside::Stop, verdict, why, now);
                sink(SessionEvent::Run(event));
                break;
            }
            if failed(&rounds, &progress) {
                break;
            }
            runner = Runner::new(procedure.clone(), options.clone(), rounds.over);
        }
        self.hand_rows(1, sink);
        sink(SessionEvent::Run(
            rounds.finished(link_lost, self.bench.now()),
        ));
        if traced.get() {
            sink(SessionEvent::Recording(Box::new(recorded)));
        }
    }

    /// Tells the runner of stop pressed since the last scan, and of a bench that was held up.
    fn interrupt(&mut self, runner: &mut Runner, presses: &mut u32) {
        let pressed = self.stop.presses();
        for press in *presses..pressed {
            match self.stop.reason().filter(|_| press == 0) {
                Some(reason) => runner.interrupted(reason.clone()),
                None => runner.stop(),
            }
        }
        *presses = pressed;
        if let Some(behind) = self.stalled.take() {
            runner.stood_still(behind);
        }
        if let Some(pause) = self.paused.take() {
            runner.paused_with_unit(self.bench.now(), pause);
        }
        if let Some(why) = self.bench.rig.take_intervention() {
            runner.interrupted(why);
        }
        runner.behind(self.behind());
    }

    fn emit(
        &mut self,
        runner: &mut Runner,
        rounds: &mut RepetitionTally,
        progress: &mut Progress<'_>,
        sink: &mut dyn FnMut(SessionEvent),
    ) {
        for event in runner.take_events() {
            self.note(&event, progress, sink);
            if let Some(event) = rounds.take(event, runner.to_be_resumed().is_some()) {
                sink(SessionEvent::Run(event));
            }
        }
    }

    /// Before a procedure or a step is repeated the unit settles as between two procedures.
    fn settle_again(
        &mut self,
        before: Before,
        rounds: &mut RepetitionTally,
        progress: &mut Progress<'_>,
        sink: &mut dyn FnMut(SessionEvent),
    ) {
        progress.step = None;
        progress.step_began = self.bench.now();
        for fault in between_procedures(self) {
            let name = fault.name.clone();
            let found = Finding::FoundBefore {
                fault: name,
                before,
            };
            let event = rounds.outside(Outside::BringUp, Verdict::Failed, found, fault.at);
            sink(SessionEvent::Run(event));
            self.report(fault, progress, sink);
        }
    }

    /// Hands rows on once there are `at_least` of them.
    fn hand_rows(&mut self, at_least: usize, sink: &mut dyn FnMut(SessionEvent)) {
        if let Some(rows) = self.rows.as_mut().filter(|rows| rows.len() >= at_least) {
            sink(SessionEvent::Rows(std::mem::take(rows)));
        }
    }

    /// Records an open trace window to its end while nothing is done. Events logged meanwhile are read by the next
    /// [`Session::idle`].
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
            RunEvent::UnitClockWrong { by_permille, at } => {
                Some(fault_watch::of_clock(*by_permille, *at, &self.sample))
            }
            RunEvent::UnsolicitedBrake { at } => {
                (!progress.explained).then(|| fault_watch::of_brake(*at, &self.sample))
            }
            RunEvent::StepFinished(result) => {
                let fault = fault_watch::of_step(
                    progress.procedure,
                    result,
                    progress.explained,
                    &self.sample,
                );
                if let Some(fault) = fault {
                    self.report(fault, progress, sink);
                } else if progress.traced.contains(&result.index) {
                    self.keep_trace(now, None, progress, sink);
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

    /// Keeps a trace around a moment of the step: of the fault of this number, or, without one, of a step that passed,
    /// to be seen beside the trace of its failure.
    fn keep_trace(
        &mut self,
        at: Instant,
        fault: Option<usize>,
        progress: &Progress<'_>,
        sink: &mut dyn FnMut(SessionEvent),
    ) {
        if let Some(cut) = self.recorder.trigger(at, progress.step_began, fault) {
            sink(SessionEvent::Trace(Box::new(cut)));
        }
    }

    fn report(
        &mut self,
        mut fault: FaultSeen,
        progress: &mut Progress<'_>,
        sink: &mut dyn FnMut(SessionEvent),
    ) {
        fault.step = progress.step.map(|_| progress.turn);
        let (at, number) = (fault.at, progress.faults);
        progress.faults += 1;
        sink(SessionEvent::Fault(fault));
        self.keep_trace(at, Some(number), progress, sink);
    }
}
