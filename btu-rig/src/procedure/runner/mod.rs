//! Runs one procedure once: a state machine stepped once per I/O scan.
//!
//! Three rules. Safe outputs are the runner's duty: whatever happened, the last thing it does is
//! [`Driver::make_safe`], until the driver confirms or [`SAFE_WITHIN`] is over. Clean-up always
//! runs, and never beside a live step: the step is finished first. No data is never `passed`.

mod attempts;
mod closing;
mod interrupt;
mod pause;
mod schedule;
mod steps;
mod unsolicited;

use std::collections::BTreeSet;
use std::sync::Arc;

use protocol::event::{Event, Severity};
use protocol::message::SelfTest;
use protocol::signal::Sample;
use protocol::{Duration, Instant, LruId};

pub use attempts::{ATTEMPTS, Resume};
pub use closing::{CLEANUP_WITHOUT_LINK, SAFE_WITHIN};
use pause::Pause;
pub use schedule::RunOptions;
use schedule::{ScheduledStep, schedule};

use super::action_run::{ActionRun, Progress};
use super::evidence::Evidence;
use super::finding::{Before, Finding, Findings};
use super::link_trouble::LinkTrouble;
use super::operator::Operator;
use super::plan::{Procedure, Step};
use super::report::{Outside, OutsideStep, RunEvent};
use super::scan::Scan;
use super::step_run::StepRun;
use super::{Driver, UnitEvent, Verdict};

/// Whether a runner needs more scans.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Poll {
    /// Yes.
    Running,
    /// No: outputs are safe or could not be made so.
    Done,
}

#[derive(Debug)]
enum Phase {
    NotStarted,
    Setup(ActionRun),
    Steps {
        next: usize,
        live: Option<Box<StepRun>>,
    },
    CleanUp {
        actions: ActionRun,
        since: Instant,
    },
    MakeSafe {
        since: Instant,
    },
    ReadLog {
        since: Instant,
    },
    Done,
}

impl Phase {
    /// The steps from this place in the schedule on, none of which has begun.
    fn steps_from(next: usize) -> Self {
        Self::Steps { next, live: None }
    }

    fn clean_up(since: Instant) -> Self {
        Self::CleanUp {
            actions: ActionRun::default(),
            since,
        }
    }
}

/// How often the operator has pressed stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd)]
enum Stop {
    No,
    Once,
    CutShort,
}

/// Runs one procedure once.
#[derive(Debug)]
pub struct Runner {
    pub procedure: Arc<Procedure>,
    options: RunOptions,
    schedule: Vec<ScheduledStep>,
    phase: Phase,
    captured: Vec<Option<f64>>,
    provoked: BTreeSet<Event>,
    brake_applied: Option<bool>,
    clock_reported: bool,
    /// First part of the train that TCMS reported in a step that did not provoke the report.
    train_part: Option<LruId>,
    stop: Stop,
    answer: Option<bool>,
    link_lost: bool,
    /// Reason for which nothing since the last scan can be judged.
    interrupted: Option<Finding>,
    /// Why the procedure is not run at all.
    passed_over: Option<Finding>,
    /// Evidence by which data from the unit can be trusted, as of the present scan.
    evidence: Evidence,
    /// Entries of the unit's log not kept before this procedure.
    not_kept_before: Option<u64>,
    /// Self-test items that failed, as the unit said while steps were run.
    self_test: SelfTest,
    /// The unit has restarted by itself, as its log says.
    restarted: bool,
    /// Events logged while nothing comes from the unit: it is still open whether the unit or the line caused them.
    left_open: Vec<UnitEvent>,
    /// Number of events reported that no step provoked.
    reported: usize,
    /// Unprovoked events beyond those reported, because there were too many.
    not_reported: u64,
    leaving: bool,
    pause: Pause,
    begun_at: Resume,
    /// Where the next runner goes on, if a next one is needed.
    resume: Option<Resume>,
    /// When the set-up before repeated steps was done.
    set_up_at: Option<Instant>,
    /// Time for which the tester's computer stood still since the last scan, if too long.
    stood_still: Option<Duration>,
    /// When computer, tester and unit stood still together last, and how long.
    last_pause: Option<(Instant, Duration)>,
    /// Times clean-up was begun.
    clean_ups: u32,
    verdict: Verdict,
    findings: Findings,
    out: Vec<RunEvent>,
}

impl Runner {
    /// A runner that has not begun, for the repetition of the procedure that comes after `round` others.
    pub fn new(procedure: Arc<Procedure>, options: RunOptions, round: u32) -> Self {
        let lacks = procedure.lacks.clone();
        Self {
            passed_over: lacks.map(|lacks| Finding::ConditionFalse { said: Some(lacks) }),
            schedule: schedule(&procedure, &options, round),
            captured: vec![None; procedure.slots],
            begun_at: Resume::from_the_start(procedure.slots),
            procedure,
            options,
            phase: Phase::NotStarted,
            provoked: BTreeSet::new(),
            brake_applied: None,
            clock_reported: false,
            train_part: None,
            stop: Stop::No,
            answer: None,
            link_lost: false,
            interrupted: None,
            evidence: Evidence::default(),
            not_kept_before: None,
            self_test: SelfTest::empty(),
            restarted: false,
            left_open: Vec::new(),
            reported: 0,
            not_reported: 0,
            leaving: false,
            pause: Pause::default(),
            resume: None,
            set_up_at: None,
            stood_still: None,
            last_pause: None,
            clean_ups: 1,
            verdict: Verdict::Skipped,
            findings: Findings::default(),
            out: Vec::new(),
        }
    }

    /// Operator's stop. The first ends the present step and goes on to clean-up; the second cuts
    /// clean-up short. Outputs are made safe in any case.
    pub fn stop(&mut self) {
        self.stop = match self.stop {
            Stop::No => Stop::Once,
            Stop::Once | Stop::CutShort => Stop::CutShort,
        };
    }

    /// Somebody else acted on the unit, or the tester cannot go on, so nothing the unit did meanwhile can be judged.
    /// The present step becomes an error with this reason; the remaining steps are not run.
    pub fn interrupted(&mut self, reason: Finding) {
        self.interrupted = Some(reason);
    }

    /// The procedure cannot be run on this connection: all its steps are skipped with this reason. To be said before
    /// the first scan.
    pub fn pass_over_all(&mut self, reason: Finding) {
        self.passed_over = Some(reason);
    }

    /// A fault was found while the unit was brought up, before any step.
    pub fn found_before(&mut self, what: &str, at: Instant) {
        let finding = Finding::FoundBefore {
            fault: what.to_owned(),
            before: Before::FirstStep,
        };
        self.outside(Outside::BringUp, Verdict::Failed, finding, at);
    }

    /// Leaves the procedure after the present step, with clean-up. The verdict covers the steps that were
    /// run; the rest is not reported.
    pub fn leave(&mut self) {
        self.leaving = true;
    }

    /// Operator's answer to the present prompt.
    pub fn answer(&mut self, yes: bool) {
        self.answer = Some(yes);
    }

    /// Whether `event` is nothing to report in the present state of the run.
    pub fn allowed(&self, event: Event) -> bool {
        event.definition().severity <= Severity::Info
            || !matches!(self.phase, Phase::Steps { .. })
            || self.provoked.contains(&event)
    }

    /// The stream of events since the last call.
    pub fn take_events(&mut self) -> Vec<RunEvent> {
        std::mem::take(&mut self.out)
    }

    /// One I/O scan: what was seen since the last one comes in, the next stimuli go out.
    ///
    /// `link_error` says that nothing can be judged any more: the unit cannot be reached, another one
    /// answers, or its log cannot be read.
    pub fn advance(
        &mut self,
        now: Instant,
        sample: &Sample,
        events: &[UnitEvent],
        link_error: Option<&LinkTrouble>,
        driver: &mut dyn Driver,
    ) -> Poll {
        self.begin(now);
        self.take_evidence(now, driver.evidence());
        // First, because what this scan brings may result from the interruption.
        if let Some(reason) = self.interrupted.take() {
            self.break_off(now, sample, reason);
        }
        self.obey_standstill(now);
        self.take_unit_events(events, now);
        self.watch_unit(now, sample);
        if let Some(error) = link_error.filter(|_| !self.link_lost) {
            self.lose_link(now, sample, error.clone());
        }
        self.obey_stop(now, sample);
        if matches!(self.phase, Phase::Setup(_)) {
            self.run_setup(now, sample, driver);
        }
        if matches!(self.phase, Phase::Steps { .. }) {
            self.run_steps(now, sample, driver);
        }
        if matches!(self.phase, Phase::CleanUp { .. }) {
            self.run_clean_up(now, sample, driver);
        }
        if let Phase::MakeSafe { since } = self.phase {
            self.make_safe(now, since, driver);
        }
        if let Phase::ReadLog { since } = self.phase {
            self.read_log(now, since);
        }
        self.answer = None;
        match self.phase {
            Phase::Done => Poll::Done,
            _ => Poll::Running,
        }
    }

    fn begin(&mut self, now: Instant) {
        if !matches!(self.phase, Phase::NotStarted) {
            return;
        }
        self.out.push(RunEvent::ProcedureStarted {
            steps: self.schedule.len(),
            at: now,
        });
        if self.schedule.is_empty() {
            let finding = Finding::NoStepToRun;
            self.outside(Outside::Whole, Verdict::Error, finding, now);
            self.phase = Phase::MakeSafe { since: now };
        } else if let Some(reason) = self.passed_over.take() {
            self.phase = Phase::steps_from(0);
            self.skip_rest(now, &reason.clone().not_run());
            self.findings.add(reason, 1);
            // Nothing was done, so there is nothing to clean up.
            self.phase = Phase::MakeSafe { since: now };
        } else {
            self.phase = Phase::Setup(ActionRun::default());
        }
    }

    fn run_setup(&mut self, now: Instant, sample: &Sample, driver: &mut dyn Driver) {
        let procedure = Arc::clone(&self.procedure);
        let mut operator = self.operator();
        let Phase::Setup(actions) = &mut self.phase else {
            return;
        };
        let scan = Scan::new(now, sample, &self.captured, &self.evidence);
        let progress =
            actions.advance(&procedure.setup, scan, &mut operator, driver, &mut self.out);
        let done = progress == Progress::Done;
        if progress == Progress::Waiting || (done && !self.has_settled(now)) {
            return;
        }
        self.phase = Phase::steps_from(self.begun_at.first);
        if let Progress::Stuck(problem) = progress {
            let finding = Finding::InSetUp(Box::new(problem.finding().clone()));
            self.outside(Outside::SetUp, Verdict::Error, finding.clone(), now);
            self.skip_rest(now, &finding.not_run());
        }
    }

    fn take_evidence(&mut self, now: Instant, evidence: Evidence) {
        self.evidence = evidence;
        self.not_kept_before.get_or_insert(evidence.not_kept);
        match &mut self.phase {
            Phase::Setup(_) => self.self_test |= evidence.self_test,
            Phase::Steps { live, .. } => {
                self.self_test |= evidence.self_test;
                if let Some(live) = live {
                    live.note_evidence(now, &evidence);
                }
            }
            _ => {}
        }
    }

    /// Reports the findings that stand beside the steps at the end.
    fn conclude(&mut self, now: Instant) {
        if !self.self_test.is_empty() {
            let items = self.self_test.bits();
            let finding = Finding::SelfTestFailed { items };
            self.outside(Outside::SelfTest, Verdict::Failed, finding, now);
        }
        let before = self.not_kept_before.unwrap_or_default();
        let more = self.not_reported + self.evidence.not_kept.saturating_sub(before);
        if more > 0 {
            let finding = Finding::TooManyEvents { more };
            self.outside(Outside::UnitLog, Verdict::Failed, finding, now);
        }
    }

    /// Verdict over all steps and what stands beside them. Where nothing could be judged any more,
    /// what was judged before is no verdict on the unit.
    fn overall(&self) -> Verdict {
        match self.verdict {
            Verdict::Aborted => Verdict::Aborted,
            _ if self.link_lost => Verdict::Error,
            verdict => verdict,
        }
    }

    /// Reports what failed outside a step.
    fn outside(&mut self, place: Outside, verdict: Verdict, finding: Finding, at: Instant) {
        self.out.push(RunEvent::OutsideStep(OutsideStep {
            place,
            verdict,
            finding: finding.clone(),
            at,
        }));
        self.note(verdict, finding);
    }

    fn note(&mut self, verdict: Verdict, finding: Finding) {
        self.verdict = self.verdict.and(verdict);
        self.findings.add(finding, 1);
    }

    /// Part to suspect when a step fails: a part of the train that TCMS has reported, as that part stays broken and
    /// shows in every later step, else the step's own.
    fn suspect(&self, step: &Step) -> Option<LruId> {
        self.train_part.clone().or_else(|| step.suspect.clone())
    }

    /// Hands the operator's answer on, once: an answer is for one prompt.
    fn operator(&mut self) -> Operator {
        Operator {
            policy: self.options.prompts,
            answer: self.answer.take(),
        }
    }
}
