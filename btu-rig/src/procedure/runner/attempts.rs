//! Steps in which the tester's own computer stood still: not tested, and repeated from the procedure's set-up.
//!
//! The unit was not heard or not driven meanwhile, so it may have braked for that reason alone. What is left of the
//! procedure is run by another runner, which is made from a [`Resume`]: set-up, the earlier steps from which the
//! repeated step continues, the repeated step, and the steps after it. Only a step that was not tested is repeated,
//! never a step that failed.

use std::collections::BTreeSet;
use std::sync::Arc;

use protocol::event::Event;
use protocol::{Duration, Instant};

use super::pause::Pause;
use super::schedule::{RunOptions, ScheduledStep, group_start};
use super::{Phase, Runner};
use crate::procedure::Verdict;
use crate::procedure::action_run::ActionRun;
use crate::procedure::finding::Finding;
use crate::procedure::plan::Procedure;
use crate::procedure::report::{ResultKind, RunEvent, StepResult};

/// How often a step is begun at most.
pub const ATTEMPTS: u32 = 3;
/// After set-up the unit says within this time how much it has logged.
const LOG_SETTLES: Duration = Duration::from_ms(600);
/// Time after set-up within which the unit's log is read; then the steps begin all the same.
const LOG_WITHIN: Duration = Duration::from_ms(10_000);
/// Time in which the effects of frames lost in a pause show: unit and TCMS miss each other, brake and log it.
const AFTERMATH: Duration = Duration::from_ms(1_000);
/// How often clean-up is begun at most.
const CLEAN_UPS: u32 = 3;

/// Place in the schedule at which a runner is to go on, and what the runner before knew of earlier steps.
#[derive(Clone, Debug)]
pub struct Resume {
    /// Place in the schedule of the first step that is run again, so that the target finds the state it needs.
    pub(super) first: usize,
    /// Place of the first step that is not tested yet.
    pub(super) target: usize,
    /// Number of the target's attempt, from 1.
    pub(super) attempt: u32,
    pub(super) captured: Vec<Option<f64>>,
    pub(super) provoked: BTreeSet<Event>,
    pub(super) pause: Pause,
}

impl Resume {
    /// The runner begins with the first step, and nothing is known of earlier steps.
    pub(super) fn from_the_start(slots: usize) -> Self {
        Self {
            first: 0,
            target: 0,
            attempt: 1,
            captured: vec![None; slots],
            provoked: BTreeSet::new(),
            pause: Pause::default(),
        }
    }
}

impl Runner {
    /// A runner for what `resume` says is left of the procedure.
    pub fn resumed(
        procedure: Arc<Procedure>,
        options: RunOptions,
        round: u32,
        resume: Resume,
    ) -> Self {
        let new = Self::new(procedure, options, round);
        Self {
            captured: resume.captured.clone(),
            provoked: resume.provoked.clone(),
            pause: resume.pause,
            begun_at: resume,
            ..new
        }
    }

    /// Rest of the procedure, when this runner is done and has not run the whole procedure.
    pub fn to_be_resumed(&self) -> Option<&Resume> {
        self.resume.as_ref()
    }

    /// The tester's computer stood still for so long since the last scan that the unit was not driven: what the unit
    /// did meanwhile is not judged. The present step is repeated, by the runner that goes on as
    /// [`Runner::to_be_resumed`] says.
    pub fn stood_still(&mut self, by: Duration) {
        self.stood_still = Some(by);
    }

    /// Notes that the bench is behind the unit's clock: a step that fails meanwhile may have been looked at
    /// too late.
    pub fn behind(&mut self, by: Duration) {
        if let Phase::Steps {
            live: Some(live), ..
        } = &mut self.phase
        {
            live.note_behind(by);
        }
    }

    /// The computer on which both tester and unit run stood still: the time counts for neither. Frames may have been
    /// lost all the same, so a step that fails meanwhile or shortly after was not tested.
    pub fn paused_with_unit(&mut self, now: Instant, by: Duration) {
        self.last_pause = Some((now, by));
    }

    /// Length of the last pause of tester and unit together, if that pause may explain what is seen now.
    pub(super) fn after_pause(&self, now: Instant) -> Option<Duration> {
        let (at, by) = self.last_pause?;
        (now.since(at) <= AFTERMATH).then_some(by)
    }

    /// Whether, after the set-up before a repeated step, the unit's log is read, so that no step is blamed for entries
    /// from before.
    pub(super) fn has_settled(&mut self, now: Instant) -> bool {
        if self.begun_at.target == 0 && self.begun_at.attempt == 1 {
            return true;
        }
        let waited = now.since(*self.set_up_at.get_or_insert(now));
        (self.evidence.log).has_waited(waited, LOG_SETTLES, LOG_WITHIN)
    }

    pub(super) fn obey_standstill(&mut self, now: Instant) {
        if let Some(by) = self.after_pause(now) {
            self.behind(by);
        }
        let Some(by) = self.stood_still.take() else {
            return;
        };
        match &mut self.phase {
            Phase::Setup(_) => self.spoil(self.begun_at.target, now, now, by),
            Phase::Steps { next, live } => {
                let (place, live) = (*next, live.take());
                // A failure from before the standstill counts, although its step is repeated.
                let before = live.iter().flat_map(|run| run.failures());
                let before = before.map(|why| Finding::BeforeStandstill(Box::new(why.clone())));
                self.findings.extend(before);
                let wanted = live.is_some() || !self.leaving;
                if wanted && place < self.schedule.len() {
                    self.spoil(place, live.map_or(now, |run| run.started), now, by);
                }
            }
            // Actions of the clean-up may have waited for what the unit did not do while it braked.
            Phase::CleanUp { actions, since } if self.clean_ups < CLEAN_UPS => {
                self.clean_ups += 1;
                (*actions, *since) = (ActionRun::default(), now);
            }
            _ => {}
        }
    }

    /// The step at `place` was not tested: it is repeated, or given up after the last attempt.
    pub(super) fn spoil(&mut self, place: usize, started: Instant, now: Instant, by: Duration) {
        // A step that is run again only to reach the target's state counts as an attempt at the target.
        let target = place.max(self.begun_at.target);
        let attempt = match target == self.begun_at.target {
            true => self.begun_at.attempt,
            false => 1,
        };
        let last = attempt >= ATTEMPTS;
        let turn = self.schedule[target];
        self.report_spoiled(turn, (started, now), attempt, by);
        let next = match last {
            true => self.after_given_up(target, now),
            false => Some(target),
        };
        self.resume = next.map(|next| Resume {
            first: group_start(&self.procedure, &self.schedule, next),
            target: next,
            attempt: if last { 1 } else { attempt + 1 },
            captured: self.captured.clone(),
            provoked: self.provoked.clone(),
            pause: self.pause,
        });
        self.phase = Phase::clean_up(now);
    }

    /// Reports as skipped the steps that continue from the step given up; returns the place of the first that does not.
    fn after_given_up(&mut self, target: usize, now: Instant) -> Option<usize> {
        let procedure = Arc::clone(&self.procedure);
        let name = &procedure.steps[self.schedule[target].index].name;
        let mut next = target + 1;
        while let Some(turn) = self.schedule.get(next).copied() {
            if !procedure.steps[turn.index].continues {
                return Some(next);
            }
            let why = Finding::NotTestedBefore { step: name.clone() }.not_run();
            self.report_not_run(turn, now, Verdict::Skipped, &why);
            next += 1;
        }
        None
    }

    fn report_spoiled(
        &mut self,
        turn: ScheduledStep,
        (started, now): (Instant, Instant),
        attempt: u32,
        by: Duration,
    ) {
        let last = attempt >= ATTEMPTS;
        let (kind, verdict) = match last {
            true => (ResultKind::Step, Verdict::Error),
            false => (ResultKind::Attempt, Verdict::Skipped),
        };
        let finding = Finding::StoodStill { by, attempt };
        self.out.push(RunEvent::StepFinished(StepResult {
            kind,
            suspect: None,
            started,
            bench_time: now.since(started),
            ..self.result(turn, now, verdict, finding.into())
        }));
        if last {
            self.verdict = self.verdict.and(Verdict::Error);
        }
    }
}
