//! One repetition of one step, from its first scan to its verdict.

use protocol::event::Event;
use protocol::message::SelfTest;
use protocol::{CYCLE, Duration, Instant, LruId};

use super::action_run::{ActionRun, Progress};
use super::evidence::{Evidence, LogState};
use super::expectation_run::ExpectationRun;
use super::finding::{Finding, Findings, LoggedEvent, WaitedFor};
use super::measure_run::MeasurementRun;
use super::operator::Operator;
use super::plan::{Action, Step, What};
use super::problem::Problem;
use super::report::{Measurement, RunEvent};
use super::scan::Scan;
use super::step_verdict::{findings, verdict};
use super::{Driver, UnitEvent, Verdict};

/// Delay beyond which the bench may fail a unit that reacts in time: limits are tens of milliseconds.
const TOO_LATE: Duration = CYCLE;
/// Time after a refused request for which the frame with the unit's reason may still be on its way.
const SAYS_WHY_WITHIN: Duration = Duration::from_ms(150);
/// Time after a refused request for which the log entry with the unit's reason may still be on its way.
const LOGS_WHY_WITHIN: Duration = Duration::from_ms(2_000);
/// Longest time that a step waits at its end for a silent unit; a lost link is noticed earlier.
const SPEAKS_WITHIN: Duration = Duration::from_ms(10_000);
/// Longest time that a step waits for the unit's log; the reader of the log gives up earlier.
const LOG_WITHIN: Duration = Duration::from_ms(60_000);

#[derive(Debug, Default)]
pub(super) struct StepRun {
    pub(super) started: Instant,
    actions: ActionRun,
    actions_done: Option<Instant>,
    expectations: Vec<ExpectationRun>,
    measurements: Vec<MeasurementRun>,
    /// Each problem once, with the number of times it came.
    problems: Vec<(Problem, u32)>,
    /// Logged events with their parameters.
    logged: Vec<(Event, i32)>,
    /// Suspected part of the first event that no step provoked, or of a failed item of the self-test.
    named_part: Option<LruId>,
    /// The step was given up: its remaining expectations are not judged.
    given_up: bool,
    /// When the unit refused a request of the step.
    refused_at: Option<Instant>,
    /// The unit has restarted by itself in this procedure, as its log says: a refused request is the unit's failure.
    restarted: bool,
    /// Nothing is measured any more: what is seen now is not the unit's doing.
    broken_off: bool,
    /// Greatest delay of the bench behind the unit in this step.
    behind: Duration,
    /// How far the unit's log is read.
    log: LogState,
    /// Since when the step waits for nothing but the unit's log.
    awaits_log: Option<Instant>,
    /// When the unit was silent last.
    silent_at: Option<Instant>,
    /// Since when the step waits for nothing but a unit that is silent.
    awaits_unit: Option<Instant>,
    /// Number of frames lost or damaged until the step began, and until now.
    lost_or_damaged: Option<(u64, u64)>,
}

pub(super) struct StepEnd {
    pub verdict: Verdict,
    pub findings: Findings,
    pub bench_time: Duration,
    pub measurements: Vec<Measurement>,
    /// Suspected part of an event that no step provoked, or of a failed item of the self-test.
    pub named_part: Option<LruId>,
    /// Delay of the tester, if the delay alone may have failed the step.
    pub too_late: Option<Duration>,
}

impl StepRun {
    pub(super) fn new(step: &Step, now: Instant) -> Self {
        Self {
            started: now,
            expectations: vec![ExpectationRun::default(); step.expectations.len()],
            measurements: vec![MeasurementRun::default(); step.measures.len()],
            ..Self::default()
        }
    }

    /// The step waits for the operator's answer.
    pub(super) fn asks(&self, step: &Step) -> bool {
        self.actions.asks(&step.actions)
    }

    /// Takes note of an event of the unit.
    pub(super) fn note_event(&mut self, event: Event, parameter: i32) {
        self.logged.push((event, parameter));
    }

    /// Counts an event that no step provoked against the step. The unit or TCMS, which logged the event, saw what
    /// happened, so the part that the event names counts for more than the part at which a failed step points.
    pub(super) fn fail_by_event(&mut self, entry: &UnitEvent) {
        let part = || Event::from_code(entry.code)?.suspect(entry.parameter);
        self.named_part = self.named_part.take().or_else(part);
        self.hold(Problem::Failed(Finding::Unprovoked(entry.into())));
    }

    /// Notes an event (`None` = an emergency brake) that frames lost between tester and unit may have caused: the step
    /// says nothing about the unit.
    pub(super) fn hold_against_line(&mut self, event: Option<LoggedEvent>) {
        self.hold(Problem::Bench(Finding::LineDisturbed { event }));
    }

    /// Fails the step for an emergency brake that it did not provoke.
    pub(super) fn fail_by_brake(&mut self) {
        self.hold(Problem::Failed(Finding::BrakeApplied));
    }

    /// Takes note that the unit has restarted by itself.
    pub(super) fn note_restart(&mut self) {
        self.restarted = true;
    }

    /// Ends the step as it stands, with a reason.
    pub(super) fn give_up(&mut self, problem: Problem) {
        self.hold(problem);
        self.given_up = true;
    }

    /// Ends the step as it stands, for a reason that makes what is seen now worthless.
    pub(super) fn break_off(&mut self, problem: Problem) {
        self.broken_off = true;
        self.give_up(problem);
    }

    /// Takes note of how far the bench, or what the link brings, is behind the unit's clock.
    pub(super) fn note_behind(&mut self, by: Duration) {
        self.behind = self.behind.max(by);
    }

    /// Takes note of how far what is heard in this scan can be trusted.
    pub(super) fn note_evidence(&mut self, now: Instant, evidence: &Evidence) {
        self.log = evidence.log;
        if evidence.line.silent {
            self.silent_at = Some(now);
        }
        self.note_behind(evidence.line.late);
        let lost_or_damaged = evidence.line.lost_or_damaged;
        let (before, _) = self
            .lost_or_damaged
            .unwrap_or((lost_or_damaged, lost_or_damaged));
        self.lost_or_damaged = Some((before, lost_or_damaged));
    }

    fn hold(&mut self, problem: Problem) {
        match self
            .problems
            .iter_mut()
            .find(|(known, _)| *known == problem)
        {
            Some((_, times)) => *times += 1,
            None => self.problems.push((problem, 1)),
        }
    }

    fn hold_if(&mut self, problem: Option<Problem>) {
        problem.into_iter().for_each(|problem| self.hold(problem));
    }

    /// Findings for which the step has failed so far.
    pub(super) fn failures(&self) -> impl Iterator<Item = &Finding> {
        let problems = self.problems.iter().map(|(problem, _)| problem);
        let failed = problems.filter(|problem| problem.is_failure());
        failed.map(Problem::finding)
    }

    fn has_failed(&self) -> bool {
        self.problems
            .iter()
            .any(|(problem, _)| problem.is_failure())
    }

    /// Whether a step that was given up is over. A unit that refused a request may have restarted, so the step waits
    /// until the unit's log can say so.
    fn is_told_why(&self, now: Instant) -> bool {
        let Some(since) = self.refused_at.filter(|_| !self.broken_off) else {
            return true;
        };
        self.has_said_why(now.since(since))
    }

    /// Whether the unit, `waited` after it refused a request or was silent, has had its time to say why.
    fn has_said_why(&self, waited: Duration) -> bool {
        (self.log).has_waited(waited, SAYS_WHY_WITHIN, LOGS_WHY_WITHIN)
    }

    /// Whether the step is held back until the unit's log is read: before, it is not known what the unit logged during
    /// the step.
    fn waits_for_log(&mut self, now: Instant) -> bool {
        if self.log != LogState::Unanswered {
            self.awaits_log = None;
            return false;
        }
        let since = *self.awaits_log.get_or_insert(now);
        if now.since(since) < LOG_WITHIN {
            return true;
        }
        let within = LOG_WITHIN;
        self.give_up(Problem::Bench(Finding::LogNotRead { within }));
        false
    }

    /// Whether the step is held back until a unit that is silent speaks again and its log is read: a unit that starts
    /// again by itself says so only then.
    fn waits_for_unit(&mut self, now: Instant) -> bool {
        let since = *self.awaits_unit.get_or_insert(now);
        let silent_for = |at: Instant| !self.has_said_why(now.since(at));
        now.since(since) < SPEAKS_WITHIN && self.silent_at.is_some_and(silent_for)
    }

    /// One scan; `true` when the step is over.
    pub(super) fn advance(
        &mut self,
        step: &Step,
        scan: Scan<'_>,
        operator: &mut Operator,
        driver: &mut dyn Driver,
        out: &mut Vec<RunEvent>,
    ) -> bool {
        if self.given_up {
            return self.is_told_why(scan.now);
        }
        let was_done = self.actions_done;
        self.look(step, scan, was_done);
        if self.actions_done.is_none() {
            match self
                .actions
                .advance(&step.actions, scan, operator, driver, out)
            {
                Progress::Waiting => {}
                Progress::Done => {
                    self.actions_done = Some(scan.now);
                    self.take_self_test(step, driver);
                }
                Progress::Stuck(problem) => {
                    let refused = matches!(problem, Problem::Refused(_));
                    self.refused_at = refused.then_some(scan.now);
                    self.give_up(problem);
                }
            }
            if self.actions_done.is_some() && !self.actions.sample_is_stale(scan.now) {
                self.look(step, scan, self.actions_done);
            }
        }
        if self.given_up {
            return self.is_told_why(scan.now);
        }
        if self.is_complete(step, scan.now) {
            for run in &mut self.expectations {
                run.explain(driver);
            }
            return !self.waits_for_log(scan.now) && !self.waits_for_unit(scan.now);
        }
        let late = scan.now.since(self.started) >= step.time_limit;
        // What the step waits for may stand in a log that the unit does not give: the reader of the log reports that.
        if late && !self.waits_for_log(scan.now) && !self.given_up {
            self.give_up(Problem::Bench(Finding::TimeLimit {
                limit: step.time_limit,
                waiting: self.waiting_for(step),
            }));
        }
        self.given_up
    }

    /// Takes the results of a self-test that the actions asked for.
    fn take_self_test(&mut self, step: &Step, driver: &dyn Driver) {
        let item = |bit: u8| driver.self_test_item(SelfTest::from_bits_retain(1 << bit));
        let any = (0..u16::BITS as u8).any(|bit| item(bit).is_some());
        for (run, measure) in self.measurements.iter_mut().zip(&step.measures) {
            if let What::SelfTest { bit } = measure.what {
                match item(bit) {
                    // A unit of an older version makes fewer tests.
                    None if any => run.leave_out(),
                    made => run.take_item(made),
                }
            }
        }
    }

    /// Verdict, message and measurements. A bench problem outranks all: then the step says nothing
    /// about the unit. A failure outranks missing data: a brake that never came also leaves its
    /// reaction time without a value, and the finding is the brake.
    pub(super) fn finish(mut self, step: &Step, scan: Scan<'_>, aborted: bool) -> StepEnd {
        let bench_time = scan.now.since(self.started);
        let complete = !self.given_up && !aborted;
        let failed_before = self.has_failed();
        for (run, expectation) in std::mem::take(&mut self.expectations)
            .into_iter()
            .zip(&step.expectations)
        {
            let decided = complete || !run.is_open(expectation);
            if let Some(problem) = run.finish(expectation).filter(|_| decided) {
                self.hold(problem);
            }
        }
        let mut measurements = Vec::with_capacity(step.measures.len());
        for (run, measure) in std::mem::take(&mut self.measurements)
            .into_iter()
            .zip(&step.measures)
        {
            let (measurement, found) = run.finish(measure, scan, self.broken_off);
            match measurement.verdict {
                Verdict::Failed => {
                    if let What::SelfTest { bit } = measure.what {
                        let part = Event::SelfTestFailed.suspect(1 << bit);
                        self.named_part = self.named_part.take().or(part);
                    }
                    self.hold_if(found.map(Problem::Failed));
                }
                _ if complete => self.hold_if(found.map(Problem::NoData)),
                _ => {}
            }
            measurements.push(measurement);
        }
        // An unprovoked event or brake, noted before, is a failure all the same. What fails only now may come from the
        // bench's delay, or from a frame that did not come through.
        let failed_now = !failed_before && self.has_failed() && !aborted;
        let too_late = (failed_now && self.behind > TOO_LATE).then_some(self.behind);
        if !failed_before && self.has_failed() {
            let lost = self
                .lost_or_damaged
                .map_or(0, |(before, now)| now.saturating_sub(before));
            if lost > 0 {
                self.hold(Problem::Bench(Finding::FramesLost { frames: lost }));
            }
        }
        StepEnd {
            verdict: verdict(&self.problems, self.restarted, aborted),
            findings: findings(&self.problems, step, aborted),
            bench_time,
            measurements,
            named_part: self.named_part,
            too_late,
        }
    }

    fn look(&mut self, step: &Step, scan: Scan<'_>, actions_end: Option<Instant>) {
        for (run, expectation) in self.expectations.iter_mut().zip(&step.expectations) {
            run.look(expectation, scan, actions_end, (&self.logged, self.log));
        }
        let request_last = matches!(step.actions.last(), Some(Action::Settle { .. }));
        for (run, measure) in self.measurements.iter_mut().zip(&step.measures) {
            run.look(measure, scan, self.started, (actions_end, request_last));
        }
    }

    fn is_complete(&self, step: &Step, now: Instant) -> bool {
        // After a stimulus one more scan, so that the last sample shows its effect.
        self.actions_done.is_some()
            && !self.actions.sample_is_stale(now)
            && !(self.expectations.iter().zip(&step.expectations)).any(|(w, e)| w.is_open(e))
            && !(self.measurements.iter().zip(&step.measures)).any(|(t, m)| t.is_open(m))
    }

    /// What the step is still waiting for.
    fn waiting_for(&self, step: &Step) -> Option<WaitedFor> {
        if self.actions_done.is_none() {
            return Some(WaitedFor::Actions);
        }
        let open = (self.expectations.iter().zip(&step.expectations)).find(|(w, e)| w.is_open(e));
        open.map(|(_, expectation)| WaitedFor::Expectation(expectation.clone()))
    }
}
