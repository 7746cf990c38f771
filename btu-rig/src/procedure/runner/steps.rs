//! Running the steps of the schedule, one after the other.

use std::sync::Arc;

use protocol::signal::Sample;
use protocol::{Duration, Instant};

use super::schedule::ScheduledStep;
use super::{Phase, Runner};
use crate::procedure::PromptPolicy;
use crate::procedure::condition::Answer;
use crate::procedure::finding::{Finding, Findings};
use crate::procedure::plan::{Action, OnFail, Step};
use crate::procedure::report::{ResultKind, RunEvent, StepResult};
use crate::procedure::scan::Scan;
use crate::procedure::step_run::StepRun;
use crate::procedure::{Driver, Verdict};

/// Steps that need no time are run one after the other in one scan, up to this many.
const STEPS_PER_SCAN: usize = 32;

impl Runner {
    pub(super) fn run_steps(&mut self, now: Instant, sample: &Sample, driver: &mut dyn Driver) {
        let procedure = Arc::clone(&self.procedure);
        let mut operator = self.operator();
        for _ in 0..STEPS_PER_SCAN {
            let Phase::Steps { next, live } = &mut self.phase else {
                return;
            };
            let wanted = !self.leaving || live.is_some();
            let Some(turn) = self.schedule.get(*next).copied().filter(|_| wanted) else {
                self.phase = Phase::clean_up(now);
                return;
            };
            let step = &procedure.steps[turn.index];
            let idle = live.is_none();
            if idle && self.holds_back(&step.name, now) {
                return;
            }
            if !idle || self.start_step(step, turn, (now, sample), driver) {
                let Phase::Steps {
                    live: Some(live), ..
                } = &mut self.phase
                else {
                    return;
                };
                let scan = Scan::new(now, sample, &self.captured, &self.evidence);
                if !live.advance(step, scan, &mut operator, driver, &mut self.out) {
                    return;
                }
                self.finish_step(now, sample, false);
            }
            if self.options.one_by_one {
                return;
            }
        }
    }

    /// Begins the next step; `false` if the step is reported as not run instead.
    fn start_step(
        &mut self,
        step: &Step,
        turn: ScheduledStep,
        (now, sample): (Instant, &Sample),
        driver: &dyn Driver,
    ) -> bool {
        if let Some(lacks) = &step.lacks {
            let said = Some(lacks.clone());
            let why = Finding::ConditionFalse { said };
            self.pass_over(turn, now, Verdict::Skipped, &why);
            return false;
        }
        let truth = step
            .when
            .as_ref()
            .map_or(Answer::Yes, |when| when.truth(sample, &self.captured));
        match truth {
            Answer::Yes if self.options.prompts == PromptPolicy::Refuse => {
                if let Some(question) = question(step, driver.has_harness()) {
                    let question = question.to_owned();
                    let why = Finding::NeedsOperator { question };
                    self.pass_over(turn, now, Verdict::Skipped, &why);
                    return false;
                }
            }
            Answer::Yes => {}
            Answer::No => {
                let said = step.when.as_ref().and_then(|when| when.said(driver));
                let said = said.map(str::to_owned);
                let why = Finding::ConditionFalse { said };
                self.pass_over(turn, now, Verdict::Skipped, &why);
                return false;
            }
            Answer::NoData(missing) => {
                let why = Finding::ConditionUnknown { missing };
                self.pass_over(turn, now, Verdict::Error, &why);
                self.stop_unless_passed(turn, Verdict::Error, now);
                return false;
            }
        }
        self.out.push(RunEvent::StepStarted {
            index: turn.index,
            name: step.name.clone(),
            turn: turn.turn,
            turns: turn.turns,
            at: now,
        });
        self.provoked.extend(step.provoked());
        if let Phase::Steps { live, .. } = &mut self.phase {
            let mut run = StepRun::new(step, now);
            if self.restarted {
                run.note_restart();
            }
            *live = Some(Box::new(run));
        }
        true
    }

    /// Ends the live step, reports it and decides whether the next one has its turn.
    pub(super) fn finish_step(&mut self, now: Instant, sample: &Sample, aborted: bool) {
        let procedure = Arc::clone(&self.procedure);
        let Phase::Steps { next, live } = &mut self.phase else {
            return;
        };
        let Some(run) = live.take() else { return };
        let turn = self.schedule[*next];
        *next += 1;
        let step = &procedure.steps[turn.index];
        let scan = Scan::new(now, sample, &self.captured, &self.evidence);
        let started = run.started;
        let place = *next - 1;
        let before_target = place < self.begun_at.target;
        let end = run.finish(step, scan, aborted);
        if let Some(by) = end.too_late {
            self.spoil(place, started, now, by);
            return;
        }
        for (measure, measurement) in step.measures.iter().zip(&end.measurements) {
            self.captured[measure.slot] = measurement.value;
        }
        // A step run again only for the state that it leaves has its result already; a failure now is reported, too.
        if before_target
            && matches!(
                end.verdict,
                Verdict::Passed | Verdict::Skipped | Verdict::Aborted
            )
        {
            return;
        }
        for measurement in &end.measurements {
            self.out.push(RunEvent::Measured {
                index: turn.index,
                measurement: measurement.clone(),
            });
        }
        self.out.push(RunEvent::StepFinished(StepResult {
            kind: match before_target {
                true => ResultKind::Again,
                false => ResultKind::Step,
            },
            suspect: end.named_part.or_else(|| self.suspect(step)),
            started,
            bench_time: end.bench_time,
            limit_source: step.origin.text(),
            measurements: end.measurements,
            ..self.result(turn, now, end.verdict, end.findings)
        }));
        self.verdict = self.verdict.and(end.verdict);
        self.stop_unless_passed(turn, end.verdict, now);
    }

    /// Skips the rest after a step that did not pass, if the run's options or the step's `on_fail` say so.
    fn stop_unless_passed(&mut self, turn: ScheduledStep, verdict: Verdict, now: Instant) {
        let step = &self.procedure.steps[turn.index];
        let stops = self.options.stop_on_fail || step.on_fail == OnFail::Stop;
        if stops && verdict != Verdict::Passed {
            let step = step.name.clone();
            self.skip_rest(now, &Finding::NotPassed { step }.not_run());
        }
    }

    /// Reports all steps still to come as skipped and goes on to clean-up.
    pub(super) fn skip_rest(&mut self, now: Instant, reason: &Finding) {
        if let Phase::Steps { next, .. } = &mut self.phase {
            // Steps before the target have their results.
            *next = (*next).max(self.begun_at.target);
        }
        while let Phase::Steps { next, .. } = &self.phase
            && let Some(turn) = self.schedule.get(*next).copied()
        {
            self.pass_over(turn, now, Verdict::Skipped, reason);
        }
        self.phase = Phase::clean_up(now);
    }

    /// Reports a step that is not run.
    fn pass_over(&mut self, turn: ScheduledStep, now: Instant, verdict: Verdict, reason: &Finding) {
        let Phase::Steps { next, .. } = &mut self.phase else {
            return;
        };
        *next += 1;
        if *next > self.begun_at.target {
            self.report_not_run(turn, now, verdict, reason);
        }
    }

    pub(super) fn report_not_run(
        &mut self,
        turn: ScheduledStep,
        now: Instant,
        verdict: Verdict,
        reason: &Finding,
    ) {
        let result = self.result(turn, now, verdict, reason.clone().into());
        self.out.push(RunEvent::StepFinished(result));
        self.verdict = self.verdict.and(verdict);
    }

    /// Result of a step that took no time and measured nothing.
    pub(super) fn result(
        &self,
        turn: ScheduledStep,
        now: Instant,
        verdict: Verdict,
        findings: Findings,
    ) -> StepResult {
        let step = &self.procedure.steps[turn.index];
        StepResult {
            index: turn.index,
            name: step.name.clone(),
            turn: turn.turn,
            turns: turn.turns,
            kind: ResultKind::Step,
            line: step.line,
            verdict,
            findings,
            suspect: self.suspect(step),
            started: now,
            bench_time: Duration::ZERO,
            limit_source: None,
            measurements: Vec::new(),
        }
    }
}

/// What a step asks the operator.
fn question(step: &Step, with_harness: bool) -> Option<&str> {
    step.actions
        .iter()
        .find_map(|action| match action.where_done(with_harness) {
            (Action::Prompt { text, .. }, true) => Some(text.as_str()),
            _ => None,
        })
}
