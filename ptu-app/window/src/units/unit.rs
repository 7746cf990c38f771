//! One unit under test: its bench, its log and its current or last run.

use std::collections::VecDeque;

use btu_rig::procedure::plan::Connection;
use btu_rig::procedure::{Finding, UnitEvent};
use btu_rig::rig::LinkTrouble;
use btu_rig::stimulus::Stimulus;
use protocol::message::Identity;
use protocol::signal::Signal;

use crate::messages::{About, Messages, told};
use crate::query_worker::QueryWorker;
use crate::request::Request;
use ptu_report::coverage_text;
use ptu_report::words::{Words, fill};
use ptu_runs::bench_worker::{BenchEvent, BenchWorker, Phase, Progress, RunOrder, Wake};
use ptu_runs::failure::{Failure, Trouble};
use ptu_runs::run::{BenchChoice, BenchSetup, SessionEvent, unit_text};

/// Most entries of a unit's log that are kept; the oldest are dropped.
const LOG: usize = 500;

pub struct Unit {
    /// Number of the unit in this window; no later unit gets the same number.
    pub id: u64,
    pub choice: BenchChoice,
    pub bench: BenchWorker,
    /// What the bench needs to connect, requested when a person connects the unit.
    pub setup: Request<BenchSetup>,
    /// Events that the unit and TCMS logged outside runs, oldest first.
    pub log: VecDeque<UnitEvent>,
    /// Present or last run of the unit.
    pub run: Option<Progress>,
    /// The page of the unit's case ordered `run`.
    pub is_run_of_case: bool,
    pub(super) runs_ended: usize,
    /// The link to the unit is lost, and a message has said so.
    pub lost: bool,
    /// `run` broke off when the link was lost, and can go on until a person ends it.
    waits: bool,
    is_other: bool,
    /// Run and stimuli are being stopped; the bench has not confirmed the stop yet.
    pub stopping: bool,
    /// The window is locked: no run begins until a person has given a name.
    pub(super) locked: bool,
    /// The unit was disconnected without its outputs being confirmed safe.
    pub(super) not_safe: bool,
}

impl Unit {
    /// The run was made on another unit than the one connected now.
    pub fn is_other(&self) -> bool {
        self.is_other
    }

    pub(super) fn new(id: u64, choice: BenchChoice, wake: Wake) -> Result<Self, Failure> {
        Ok(Self {
            id,
            choice,
            bench: BenchWorker::new(wake)?,
            setup: Request::Idle,
            log: VecDeque::new(),
            run: None,
            is_run_of_case: false,
            runs_ended: 0,
            lost: false,
            waits: false,
            is_other: false,
            stopping: false,
            locked: false,
            not_safe: false,
        })
    }

    /// State of the bench's thread.
    pub fn phase(&self) -> Phase {
        match self.setup {
            Request::Pending(_) => Phase::Connecting,
            _ => self.bench.live().phase,
        }
    }

    /// A unit is connected, with a run or without.
    pub fn is_connected(&self) -> bool {
        matches!(self.phase(), Phase::Idle | Phase::Running)
    }

    /// A unit is connected, and no run is under way or ordered. The phase alone does not tell: a busy bench
    /// takes seconds to begin a run that was ordered.
    pub fn may_run(&self) -> bool {
        !self.locked
            && self.phase() == Phase::Idle
            && !self.run.as_ref().is_some_and(Progress::is_running)
    }

    pub fn identity(&self) -> Option<Identity> {
        self.bench.live().identity
    }

    /// Serial number, once the unit has told it.
    pub fn serial(&self) -> Option<String> {
        self.identity().as_ref().map(unit_text::serial)
    }

    /// Name of the unit: its serial number, or its port.
    pub fn name(&self) -> String {
        self.serial()
            .unwrap_or_else(|| self.choice.endpoint.clone())
    }

    pub fn connect(&mut self, queries: &QueryWorker) {
        if self.locked {
            return;
        }
        let choice = self.choice.clone().with_offered_faults();
        self.setup = Request::Pending(queries.run(move |paths| choice.setup(&paths.scripts)));
    }

    /// Disconnects the unit, or gives up connecting.
    pub fn disconnect(&mut self) {
        if matches!(self.setup, Request::Pending(_)) {
            self.setup = Request::Idle;
        }
        self.bench.disconnect();
    }

    /// Stops the unit's run, takes every stimulus away and disarms.
    pub(super) fn stop_all(&mut self) {
        self.stopping = self.is_connected();
        self.bench.stop_all();
    }

    /// Begins a run, if nothing else has the bench; true = begun. `of_case`: the unit's case ordered the run.
    pub fn begin(&mut self, order: RunOrder, of_case: bool) -> bool {
        if !self.may_run() {
            return false;
        }
        self.run = Some(Progress::new(&order.plan, self.name()));
        self.is_run_of_case = of_case;
        (self.waits, self.is_other) = (false, false);
        self.bench.run(order);
        true
    }

    /// Present or last run, if the unit's case ordered it: a run that another page ordered says nothing of the case.
    pub fn run_of_case(&self) -> Option<&Progress> {
        self.run.as_ref().filter(|_| self.is_run_of_case)
    }

    /// The run that broke off when the link was lost and can go on, and the finding that tells the place.
    pub fn waiting_run(&self) -> Option<(&Progress, &Finding)> {
        let run = self.run.as_ref().filter(|_| self.waits)?;
        Some((run, link_loss(run)?))
    }

    /// The run that broke off will not go on; it is no longer shown if it belongs to another unit.
    pub fn end_run(&mut self) {
        self.waits = false;
        if std::mem::take(&mut self.is_other) {
            self.run = None;
        }
    }

    /// Answers the prompt of the run's script, which takes the prompt off the screen.
    pub fn answer(&mut self, yes: bool) {
        if let Some(present) = self.run.as_mut().and_then(|run| run.present.as_mut())
            && present.prompt.take().is_some()
        {
            self.bench.live_state().answer(yes);
        }
    }

    /// Connection that the bench found; before a unit is connected, the connection that was chosen.
    pub fn connection(&self) -> Connection {
        let found = self.bench.live().connection;
        found.unwrap_or_else(|| self.choice.connection())
    }

    pub fn is_armed(&self) -> bool {
        self.bench.live().sample.get(Signal::Armed) == Some(1.0)
    }

    /// Takes test signals away and disarms, unless a run has the bench.
    pub(super) fn disarm(&mut self) {
        if self.is_armed() && self.bench.permits(&Stimulus::PtuDisarm).is_ok() {
            // Refused only while a run has the bench.
            let _ = self.bench.apply(Stimulus::PtuDisarm);
        }
    }

    /// Takes the bench's events since the last call, and adds messages about those that matter to a person.
    pub(super) fn poll(&mut self, words: &Words, said: &mut UnitMessages<'_>) {
        let connection = About::Connection(self.id);
        if self.setup.poll() {
            said.messages.over(connection);
            match &self.setup {
                Request::Ready(setup) => self.bench.connect(setup.clone()),
                Request::Failed(why) => {
                    said.trouble(connection, words.frame.cannot_connect, why.clone());
                }
                _ => {}
            }
        }
        let events: Vec<_> = self.bench.events().collect();
        for event in events {
            self.on_event(event, words, said);
        }
    }

    fn on_event(&mut self, event: BenchEvent, words: &Words, said: &mut UnitMessages<'_>) {
        let frame = &words.frame;
        let (connection, this_run) = (About::Connection(self.id), About::Run(self.id));
        if ends_stop(&event) {
            self.stopping = false;
        }
        match event {
            BenchEvent::Connected { serial } => {
                self.log.clear();
                self.lost = false;
                self.not_safe = false;
                // A run of another unit is no longer shown, unless it broke off: then it stays until a person ends it.
                let other = self.run.as_ref().is_some_and(|run| run.unit != serial);
                self.is_other = other && self.waits;
                if other && !self.waits {
                    self.run = None;
                }
                said.note(connection, fill(frame.is_connected, &[("unit", &serial)]));
            }
            BenchEvent::NotConnected(why) => said.trouble(connection, frame.cannot_connect, why),
            BenchEvent::Disconnected { safe: true } => {
                said.note(connection, frame.is_disconnected);
            }
            BenchEvent::Disconnected { safe: false } | BenchEvent::NotSafe => {
                self.not_safe = true;
                said.trouble(None, frame.not_safe, told(""));
            }
            BenchEvent::StopEnded => {}
            BenchEvent::LinkLost(why) => self.lose(why, words, said),
            BenchEvent::Broken => {
                self.not_safe = true;
                said.trouble(None, frame.broken, told(""));
                if let Some(run) = self.run.as_mut().filter(|run| run.is_running()) {
                    run.end(None);
                }
            }
            BenchEvent::UnitRestarted => said.trouble(None, frame.unit_restarted, told("")),
            BenchEvent::NotDone { asked, why } => {
                said.trouble(None, fill(frame.not_done, &[("what", &asked)]), told(why));
            }
            BenchEvent::Logged(entry) => {
                if self.log.len() == LOG {
                    self.log.pop_front();
                }
                self.log.push_back(entry);
            }
            BenchEvent::Run { procedure, event } => {
                if let SessionEvent::LinkLost(why) = &event {
                    self.lose(why.clone(), words, said);
                }
                if let Some(run) = &mut self.run {
                    run.on_event(&procedure, &event);
                }
            }
            BenchEvent::RunEnded(outcome) => {
                self.runs_ended += 1;
                let verdict = words.common.verdict(outcome.verdict);
                let mut ended = fill(frame.run_ended, &[("verdict", &verdict)]);
                let coverage = self.run.as_ref().map(Progress::coverage);
                if let Some(part) = coverage.and_then(|coverage| coverage_text(&coverage, words)) {
                    ended += &format!(" ({part})");
                }
                said.note(this_run, ended);
                if let Some(run) = &mut self.run {
                    run.end(Some(outcome));
                    self.waits = link_loss(run).is_some();
                }
            }
            BenchEvent::RunFailed(why) => {
                self.runs_ended += 1;
                said.trouble(this_run, frame.run_failed, why);
                if let Some(run) = &mut self.run {
                    run.end(None);
                }
            }
        }
    }

    /// Adds one message that the link is lost, though every procedure of a run reports the loss.
    fn lose(&mut self, why: LinkTrouble, words: &Words, said: &mut UnitMessages<'_>) {
        self.stopping = false;
        if !std::mem::replace(&mut self.lost, true) {
            said.trouble(
                About::Connection(self.id),
                words.frame.link_lost,
                Trouble::Link(why),
            );
        }
    }
}

/// The finding that the link was lost during a run; the latest procedure is searched first.
fn link_loss(run: &Progress) -> Option<&Finding> {
    let results = run.procedures.iter().rev().flat_map(|of| &of.results);
    let mut all = results.flat_map(|result| result.findings.iter());
    let lost = |finding: &Finding| {
        matches!(
            finding,
            Finding::LinkLostAt { .. } | Finding::LinkLost { .. }
        )
    };
    let found = all.find(|found| lost(&found.finding));
    found.map(|found| &found.finding)
}

/// Whether the event ends a stop: run and stimuli are stopped, or can no longer be stopped.
fn ends_stop(event: &BenchEvent) -> bool {
    matches!(
        event,
        BenchEvent::Disconnected { .. }
            | BenchEvent::NotSafe
            | BenchEvent::StopEnded
            | BenchEvent::Broken
            | BenchEvent::RunEnded(_)
            | BenchEvent::RunFailed(_)
    )
}

/// Messages that say which unit they are about when there are several.
pub(super) struct UnitMessages<'a> {
    pub unit: Option<String>,
    pub messages: &'a mut Messages,
}

impl UnitMessages<'_> {
    fn named(&self, text: impl Into<String>) -> String {
        let text = text.into();
        match &self.unit {
            Some(unit) => format!("{unit}: {text}"),
            None => text,
        }
    }

    fn trouble(
        &mut self,
        about: impl Into<Option<About>>,
        text: impl Into<String>,
        detail: impl Into<Trouble>,
    ) {
        let text = self.named(text);
        self.messages.trouble_about(about, text, detail);
    }

    fn note(&mut self, about: impl Into<Option<About>>, text: impl Into<String>) {
        let text = self.named(text);
        self.messages.note_about(about, text);
    }
}

#[cfg(test)]
mod tests;
