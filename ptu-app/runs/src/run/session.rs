//! A bench with its pace, its recorder and its stop: scans it, keeps up with a unit in real time, makes it safe.

mod in_step;
mod procedure;

use std::sync::Arc;

use btu_rig::procedure::runner::SAFE_WITHIN;
use btu_rig::procedure::{EventSource, UnitEvent};
use btu_rig::recorded::StimulusPlayer;
use btu_rig::recorder::{RecordedWindow, Recorder, Row};
use btu_rig::rig::{Bench, LinkTrouble, UnitLink};
use fault_db::TraceData;
use protocol::signal::Sample;
use protocol::{CYCLE, Duration, Instant, SCAN};

use self::in_step::InStep;
use super::fault_watch::{self, FaultSeen};
use super::run_control::RunControl;
use super::trace_data::trace_data;
use crate::link::Pace;
use crate::stop::Stop;

/// A bench that is less behind than this is in time.
const IN_TIME: Duration = Duration::from_us(2 * SCAN.as_us());

/// A bench, its recorder and its pace.
pub struct Session<L: UnitLink> {
    pub bench: Bench<L>,
    pace: Pace,
    stop: Stop,
    recorder: Recorder,
    sample: Sample,
    link_failure: Option<LinkTrouble>,
    /// Permitted lag of the bench behind the wall clock: beyond it a unit in real time misses its inputs and brakes, so that
    /// nothing the unit does then is judged. `None` for a unit in virtual time.
    pub max_lag: Option<Duration>,
    /// Largest lag beyond `max_lag` since it was last taken.
    stalled: Option<Duration>,
    in_step: InStep,
    /// Largest time that unit and bench stood still together since it was last taken.
    paused: Option<Duration>,
    fresh_unit: bool,
    pub(super) run_control: Option<Arc<dyn RunControl>>,
    /// Rows that were not handed on yet, of a run that is recorded whole.
    pub(super) rows: Option<Vec<Row>>,
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

impl<L: UnitLink> Session<L> {
    /// A session on `bench`; `fresh_unit` = the unit is powered up within the session, so that all it logs belongs to
    /// the session.
    pub fn new(bench: Bench<L>, pace: Pace, stop: Stop, fresh_unit: bool) -> Self {
        Self {
            bench,
            pace,
            stop,
            recorder: Recorder::default(),
            sample: Sample::default(),
            link_failure: None,
            max_lag: None,
            stalled: None,
            paused: None,
            in_step: InStep::default(),
            fresh_unit,
            run_control: None,
            rows: None,
            with_person: false,
        }
    }

    /// Replaces the stop that ends runs on this session.
    pub fn set_stop(&mut self, stop: &Stop) {
        self.stop = stop.clone();
    }

    pub fn set_pace(&mut self, pace: Pace) {
        self.pace = pace;
    }

    /// Bench time.
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
        while self.bench.now() < until && self.stop.presses() == 0 && self.link_failure.is_none() {
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
    pub fn has_stalled(&mut self) -> bool {
        self.stalled.take().is_some()
    }

    /// Makes up the scans that were missed; completed windows go to `cut`, events to `seen`.
    pub(super) fn make_up(
        &mut self,
        cut: &mut dyn FnMut(RecordedWindow),
        seen: &mut dyn FnMut(&UnitEvent, Instant, &Sample),
    ) {
        // A computer that is too slow for good never catches up.
        let at_most = 100 + 3 * self.behind().as_us() / SCAN.as_us();
        for _ in 0..at_most {
            if self.behind() < IN_TIME || self.stop.presses() > 0 || self.link_failure.is_some() {
                break;
            }
            self.scan(cut);
            for entry in self.take_events() {
                seen(&entry, self.bench.now(), &self.sample);
            }
        }
    }

    /// Lag of the bench behind a unit that goes on by itself.
    fn behind(&self) -> Duration {
        self.max_lag.map_or(Duration::ZERO, |_| self.pace.behind())
    }

    /// Reason for which nothing can be sent or received any more; none if the link works.
    pub fn link_failure(&self) -> Option<&LinkTrouble> {
        self.link_failure.as_ref()
    }

    /// Reason for which nothing can be judged, if there is one: the unit cannot be reached, another one
    /// answers, or its log cannot be read.
    pub fn link_error(&self) -> Option<LinkTrouble> {
        self.link_failure
            .clone()
            .or_else(|| self.bench.rig.link_error())
    }

    /// New entries of the unit's log. What it logged before this bench was heard is history.
    fn take_events(&mut self) -> Vec<UnitEvent> {
        let rig = &mut self.bench.rig;
        let mut events = rig.take_events();
        if rig.unit_restarts() == 0
            && let Some(first) = rig.events_at_contact().filter(|_| !self.fresh_unit)
        {
            events.retain(|entry| entry.source != EventSource::Unit || entry.index >= first);
        }
        events
    }

    /// One scan of the bench, recorded; a completed window goes to `cut`.
    fn scan(&mut self, cut: &mut dyn FnMut(RecordedWindow)) {
        self.pace.wait();
        if let Err(failure) = self.bench.tick() {
            self.link_failure.get_or_insert(failure);
        }
        self.keep_in_step();
        let late = self.bench.link.take_late();
        let behind = self.behind().max(late);
        let is_late = late > Duration::ZERO || self.max_lag.is_some_and(|at_most| behind > at_most);
        // A link that broke is late, too, and to repeat the step does not repair it.
        if is_late && self.link_failure.is_none() {
            self.stalled = self.stalled.max(Some(behind));
            let now = self.bench.now();
            self.bench.rig.note_stalled(now);
        }
        self.sample.clone_from(self.bench.rig.sample());
        let now = self.bench.now();
        if !now.as_us().is_multiple_of(CYCLE.as_us()) {
            return;
        }
        if let Some(run_control) = &self.run_control {
            run_control.after_cycle(now, &self.bench.rig);
        }
        if let Some(rows) = &mut self.rows {
            rows.push(Row {
                at: now,
                sample: self.sample.clone(),
            });
        }
        if let Some(done) = self.recorder.record(now, &self.sample) {
            cut(done);
        }
    }

    /// Leaves out the time in which bench and unit stood still together: it spoils nothing that the unit does.
    fn keep_in_step(&mut self) {
        let pause = self.bench.link.take_pause();
        let now = self.bench.now();
        if pause > Duration::ZERO {
            self.bench.rig.note_pause(now, pause);
            self.in_step.begin(now, pause);
            self.paused = self.paused.max(Some(pause));
            self.shift(pause.as_us() as i64);
        }
        if self.max_lag.is_some() {
            let stamp = self.bench.rig.unit_stamp_ms();
            let correction_us = self.in_step.correction_us(stamp);
            self.shift(correction_us);
        }
    }

    fn shift(&mut self, later_us: i64) {
        if later_us != 0 {
            self.pace.shift(later_us);
            self.bench.link.shift_clock(later_us);
        }
    }

    /// Judges what the unit logged during bring-up: nothing was provoked yet, so each fault event counts.
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

    /// Repeats recorded stimuli up to `until` and keeps every scan from `from` on as a trace.
    /// `None` when nothing could be recorded. What the bench refused goes to `refused`.
    pub fn play(
        &mut self,
        mut player: StimulusPlayer<'_>,
        window: Window,
        refused: &mut Vec<String>,
    ) -> Option<TraceData> {
        // Some traces show a unit that falls silent: only a broken connection ends the replay early.
        while self.bench.now() < window.until
            && self.stop.presses() == 0
            && self.link_failure.is_none()
        {
            self.scan(&mut |_| {});
            self.take_events();
            let now = self.bench.now();
            let refusals = player.play(now, &mut self.bench.rig);
            refused.extend(refusals.into_iter().map(|refusal| refusal.0));
        }
        let partial = self.bench.now() < window.until;
        let cut = self.recorder.cut(window.from, window.trigger, partial)?;
        Some(trace_data(&cut))
    }

    /// Brings the bench to the quiescent state, for as long as that may take.
    pub fn make_safe(&mut self) -> bool {
        let until = self.bench.now() + SAFE_WITHIN;
        while self.bench.now() < until && self.link_error().is_none() {
            let now = self.bench.now();
            self.bench.rig.make_safe(now);
            if self.bench.rig.safe() {
                return true;
            }
            self.scan(&mut |_| {});
            self.take_events();
        }
        false
    }

    /// A person takes time by the clock: virtual time keeps to the clock while a person is waited for.
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
}
