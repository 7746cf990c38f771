//! Runs one procedure: a state machine stepped once per I/O scan.
//!
//! Three rules. Safe outputs are the runner's duty: whatever happened, the last thing it does is
//! [`Driver::make_safe`], until the driver confirms or [`SAFE_WITHIN`] is over. Clean-up always
//! runs, and never beside a live step: the step is finished first. No data is never `passed`.

use std::sync::Arc;

use protocol::event::{Event, Severity};
use protocol::signal::{Sample, Signal};
use protocol::{Duration, Instant};

use super::action_run::{ActionRun, Operator, Problem, Progress, Scan};
use super::condition::Truth;
use super::event_set::EventSet;
use super::plan::{OnFail, Procedure, Step, total_worst_case};
use super::report::{RunEvent, StepResult, Verdict};
use super::step_run::StepRun;
use super::{Driver, UnitEvent};

/// Time outputs have to become safe.
pub const SAFE_WITHIN: Duration = Duration::from_ms(2000);
/// Time clean-up has when the link to the unit is lost.
pub const CLEANUP_WITHOUT_LINK: Duration = Duration::from_ms(2000);
/// Steps that need no time are run one after the other in one scan, up to this many.
const STEPS_PER_SCAN: usize = 32;

/// Events after which the emergency brake is applied.
const BRAKING_EVENTS: [Event; 15] = [
    Event::SelfTestFailed,
    Event::InternalError,
    Event::InputsLost,
    Event::OverspeedEb,
    Event::ServiceBrakeIneffective,
    Event::TachoDisagree,
    Event::TachoDead1,
    Event::TachoDead2,
    Event::TachoDirection,
    Event::TachoNoise1,
    Event::TachoNoise2,
    Event::Rollback,
    Event::EbRelayWelded,
    Event::EbRelayOpen,
    Event::DoorOpenMoving,
];

/// What a prompt does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PromptPolicy {
    /// Nobody is there: a prompt is an error.
    #[default]
    Refuse,
    /// A [`RunEvent::Prompt`] is sent and [`Runner::answer`] awaited.
    Ask,
}

/// What to run and how.
#[derive(Clone, Debug)]
pub struct RunOptions {
    /// Places of the chosen steps; `None` = all.
    pub chosen: Option<Vec<usize>>,
    /// How often the chosen steps are run through.
    pub repeat: u32,
    /// Skip the rest after the first step that did not pass.
    pub stop_on_fail: bool,
    /// What a prompt does.
    pub prompts: PromptPolicy,
}

impl Default for RunOptions {
    fn default() -> Self {
        Self {
            chosen: None,
            repeat: 1,
            stop_on_fail: false,
            prompts: PromptPolicy::Refuse,
        }
    }
}

/// Whether a runner needs more scans.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Poll {
    /// Yes.
    Running,
    /// No: outputs are safe or could not be made so.
    Done,
}

/// One entry of the schedule.
#[derive(Clone, Copy, Debug)]
struct Turn {
    index: usize,
    number: u32,
    of: u32,
}

#[derive(Debug)]
enum Phase {
    NotStarted,
    Setup(ActionRun),
    Steps { next: usize, live: Option<StepRun> },
    CleanUp { actions: ActionRun, since: Instant },
    MakeSafe { since: Instant },
    Done,
}

/// How often the operator has pressed stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd)]
enum Stop {
    No,
    Once,
    CutShort,
}

/// Runs one procedure.
#[derive(Debug)]
pub struct Runner {
    procedure: Arc<Procedure>,
    options: RunOptions,
    schedule: Vec<Turn>,
    phase: Phase,
    captured: Vec<Option<f64>>,
    provoked: EventSet,
    brake_applied: Option<bool>,
    stop: Stop,
    answer: Option<bool>,
    link_lost: bool,
    verdict: Verdict,
    messages: Vec<String>,
    out: Vec<RunEvent>,
}

impl Runner {
    /// A runner that has not begun.
    pub fn new(procedure: Arc<Procedure>, options: RunOptions) -> Self {
        Self {
            schedule: schedule(&procedure, &options),
            captured: vec![None; procedure.slots],
            procedure,
            options,
            phase: Phase::NotStarted,
            provoked: EventSet::default(),
            brake_applied: None,
            stop: Stop::No,
            answer: None,
            link_lost: false,
            verdict: Verdict::Skipped,
            messages: Vec::new(),
            out: Vec::new(),
        }
    }

    /// The procedure it runs.
    pub fn procedure(&self) -> &Arc<Procedure> {
        &self.procedure
    }

    /// Operator's stop. The first ends the present step and goes on to clean-up; the second cuts
    /// clean-up short. Outputs are made safe in any case.
    pub fn stop(&mut self) {
        self.stop = match self.stop {
            Stop::No => Stop::Once,
            Stop::Once | Stop::CutShort => Stop::CutShort,
        };
    }

    /// Operator's answer to the present prompt.
    pub fn answer(&mut self, yes: bool) {
        self.answer = Some(yes);
    }

    /// Whether `event` is nothing to report in the present state of the run.
    pub fn allowed(&self, event: Event) -> bool {
        event.definition().severity <= Severity::Info
            || !matches!(self.phase, Phase::Steps { .. })
            || self.provoked.contains(event)
    }

    /// The stream of events since the last call.
    pub fn take_events(&mut self) -> Vec<RunEvent> {
        std::mem::take(&mut self.out)
    }

    /// One I/O scan: what was seen since the last one comes in, the next stimuli go out.
    ///
    /// `link_error` says that the unit cannot be reached any more.
    pub fn advance(
        &mut self,
        now: Instant,
        sample: &Sample,
        events: &[UnitEvent],
        link_error: Option<&str>,
        driver: &mut dyn Driver,
    ) -> Poll {
        self.begin(now);
        self.take_unit_events(events);
        self.watch_brake(now, sample);
        if let Some(error) = link_error.filter(|_| !self.link_lost) {
            self.lose_link(now, sample, error);
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
            self.fault("no step to run".into());
            self.phase = Phase::MakeSafe { since: now };
        } else {
            self.phase = Phase::Setup(ActionRun::default());
        }
    }

    /// Hands the unit's events to the live step and reports those nobody asked for.
    ///
    /// Only while steps run: power-up, making safe and what the last procedure left behind cause
    /// events of their own.
    fn take_unit_events(&mut self, events: &[UnitEvent]) {
        let Phase::Steps { live, .. } = &mut self.phase else {
            return;
        };
        for entry in events {
            let known = Event::from_code(entry.code);
            if let (Some(step), Some(event)) = (live.as_mut(), known) {
                step.note_event(event);
            }
            // An event that is not in the dictionary cannot have been asked for.
            let asked = known.is_some_and(|event| {
                event.definition().severity <= Severity::Info || self.provoked.contains(event)
            });
            if !asked {
                self.out.push(RunEvent::UnsolicitedEvent(*entry));
                if let Some(step) = live.as_mut() {
                    step.blame_event(entry);
                }
            }
        }
    }

    fn watch_brake(&mut self, now: Instant, sample: &Sample) {
        let applied = sample.get(Signal::Eb).map(|value| value != 0.0);
        let before = self.brake_applied;
        self.brake_applied = applied.or(before);
        if (before, applied) != (Some(false), Some(true)) {
            return;
        }
        if let Phase::Steps {
            live: Some(live),
            next,
        } = &mut self.phase
        {
            let step = &self.procedure.steps[self.schedule[*next].index];
            if !asks_for_brake(step) {
                live.blame_brake();
                self.out.push(RunEvent::UnsolicitedBrake { at: now });
            }
        }
    }

    fn lose_link(&mut self, now: Instant, sample: &Sample, error: &str) {
        self.link_lost = true;
        let text = format!("link to the unit: {error}");
        match &mut self.phase {
            Phase::Steps { live, .. } => {
                if let Some(step) = live.as_mut() {
                    step.give_up(Problem::Bench(text.clone()));
                    self.finish_step(now, sample, false);
                }
                self.fault(text.clone());
                self.skip_rest(now, &format!("not run, {text}"));
            }
            Phase::Setup(_) => {
                self.fault(text.clone());
                self.phase = Phase::Steps {
                    next: 0,
                    live: None,
                };
                self.skip_rest(now, &format!("not run, {text}"));
            }
            Phase::CleanUp { .. } => self.fault(text),
            Phase::NotStarted | Phase::MakeSafe { .. } | Phase::Done => {}
        }
    }

    fn obey_stop(&mut self, now: Instant, sample: &Sample) {
        if self.stop == Stop::No {
            return;
        }
        match &self.phase {
            Phase::Setup(_) | Phase::Steps { .. } => {
                if matches!(self.phase, Phase::Steps { live: Some(_), .. }) {
                    self.finish_step(now, sample, true);
                } else if matches!(self.phase, Phase::Setup(_)) {
                    self.phase = Phase::Steps {
                        next: 0,
                        live: None,
                    };
                }
                self.note(Verdict::Aborted, "stopped by the operator".into());
                self.skip_rest(now, "not run, stopped by the operator");
            }
            Phase::CleanUp { .. } if self.stop == Stop::CutShort => {
                self.note(
                    Verdict::Aborted,
                    "clean-up cut short by the operator".into(),
                );
                self.phase = Phase::MakeSafe { since: now };
            }
            _ => {}
        }
    }

    fn run_setup(&mut self, now: Instant, sample: &Sample, driver: &mut dyn Driver) {
        let procedure = Arc::clone(&self.procedure);
        let operator = self.operator();
        let Phase::Setup(actions) = &mut self.phase else {
            return;
        };
        let scan = Scan {
            now,
            sample,
            captured: &self.captured,
        };
        let progress = actions.advance(&procedure.setup, scan, operator, driver, &mut self.out);
        if progress == Progress::Waiting {
            return;
        }
        self.phase = Phase::Steps {
            next: 0,
            live: None,
        };
        if let Progress::Stuck(problem) = progress {
            let text = format!("setup: {}", problem.message());
            self.skip_rest(now, &format!("not run, {text}"));
            self.fault(text);
        }
    }

    fn run_steps(&mut self, now: Instant, sample: &Sample, driver: &mut dyn Driver) {
        let procedure = Arc::clone(&self.procedure);
        let operator = self.operator();
        for _ in 0..STEPS_PER_SCAN {
            let Phase::Steps { next, live } = &mut self.phase else {
                return;
            };
            let Some(turn) = self.schedule.get(*next).copied() else {
                self.phase = Phase::CleanUp {
                    actions: ActionRun::default(),
                    since: now,
                };
                return;
            };
            let step = &procedure.steps[turn.index];
            if live.is_none() && !self.start_step(step, turn, now, sample) {
                continue;
            }
            let Phase::Steps {
                live: Some(live), ..
            } = &mut self.phase
            else {
                return;
            };
            let scan = Scan {
                now,
                sample,
                captured: &self.captured,
            };
            if !live.advance(step, scan, operator, driver, &mut self.out) {
                return;
            }
            self.finish_step(now, sample, false);
        }
    }

    /// Begins the next step; `false` if its condition lets it be skipped or cannot be told.
    fn start_step(&mut self, step: &Step, turn: Turn, now: Instant, sample: &Sample) -> bool {
        let truth = step
            .when
            .as_ref()
            .map_or(Truth::Yes, |when| when.truth(sample, &self.captured));
        match truth {
            Truth::Yes => {}
            Truth::No => {
                self.pass_over(turn, now, Verdict::Skipped, "its condition does not hold");
                return false;
            }
            Truth::NoData(lack) => {
                self.pass_over(turn, now, Verdict::Error, &format!("its condition: {lack}"));
                return false;
            }
        }
        self.out.push(RunEvent::StepStarted {
            index: turn.index,
            name: turn.name(step),
            at: now,
        });
        self.provoked = self.provoked.union(step.provoked().collect());
        if let Phase::Steps { live, .. } = &mut self.phase {
            *live = Some(StepRun::new(step, now));
        }
        true
    }

    /// Ends the live step, reports it and decides whether the next one has its turn.
    fn finish_step(&mut self, now: Instant, sample: &Sample, aborted: bool) {
        let procedure = Arc::clone(&self.procedure);
        let Phase::Steps { next, live } = &mut self.phase else {
            return;
        };
        let Some(run) = live.take() else { return };
        let turn = self.schedule[*next];
        *next += 1;
        let step = &procedure.steps[turn.index];
        let scan = Scan {
            now,
            sample,
            captured: &self.captured,
        };
        let started = run.started();
        let end = run.finish(step, scan, aborted);
        for (measure, measurement) in step.measures.iter().zip(&end.measurements) {
            self.captured[measure.slot] = measurement.value;
            self.out.push(RunEvent::Measured {
                index: turn.index,
                measurement: measurement.clone(),
            });
        }
        self.out.push(RunEvent::StepFinished(StepResult {
            index: turn.index,
            name: turn.name(step),
            line: step.line,
            verdict: end.verdict,
            message: end.message,
            suspect: self.suspect(step),
            started,
            bench_time: end.bench_time,
            measurements: end.measurements,
        }));
        self.verdict = self.verdict.and(end.verdict);
        let stops = self.options.stop_on_fail || step.on_fail == OnFail::Stop;
        if stops && end.verdict != Verdict::Passed {
            let name = turn.name(step);
            self.skip_rest(now, &format!("not run, \"{name}\" did not pass"));
        }
    }

    /// Reports all steps still to come as skipped and goes on to clean-up.
    fn skip_rest(&mut self, now: Instant, reason: &str) {
        while let Phase::Steps { next, .. } = &self.phase
            && let Some(turn) = self.schedule.get(*next).copied()
        {
            self.pass_over(turn, now, Verdict::Skipped, reason);
        }
        self.phase = Phase::CleanUp {
            actions: ActionRun::default(),
            since: now,
        };
    }

    /// Reports a step that is not run.
    fn pass_over(&mut self, turn: Turn, now: Instant, verdict: Verdict, reason: &str) {
        let step = &self.procedure.steps[turn.index];
        self.out.push(RunEvent::StepFinished(StepResult {
            index: turn.index,
            name: turn.name(step),
            line: step.line,
            verdict,
            message: reason.into(),
            suspect: self.suspect(step),
            started: now,
            bench_time: Duration::ZERO,
            measurements: Vec::new(),
        }));
        self.verdict = self.verdict.and(verdict);
        if let Phase::Steps { next, .. } = &mut self.phase {
            *next += 1;
        }
    }

    /// An action of clean-up that does not succeed is reported and the next one tried.
    fn run_clean_up(&mut self, now: Instant, sample: &Sample, driver: &mut dyn Driver) {
        let procedure = Arc::clone(&self.procedure);
        let operator = self.operator();
        let Phase::CleanUp { actions, since } = &mut self.phase else {
            return;
        };
        let mut allowed = total_worst_case(&procedure.cleanup) + super::plan::TIME_LIMIT_MARGIN;
        if self.link_lost {
            allowed = allowed.min(CLEANUP_WITHOUT_LINK);
        }
        let scan = Scan {
            now,
            sample,
            captured: &self.captured,
        };
        let mut problems = Vec::new();
        let mut over = loop {
            match actions.advance(&procedure.cleanup, scan, operator, driver, &mut self.out) {
                Progress::Waiting => break false,
                Progress::Done => break true,
                Progress::Stuck(problem) => {
                    problems.push(format!("clean-up: {}", problem.message()));
                    actions.skip();
                }
            }
        };
        if !over && now.since(*since) >= allowed {
            problems.push(format!("clean-up took longer than {allowed}"));
            over = true;
        }
        problems.into_iter().for_each(|text| self.fault(text));
        if over {
            self.phase = Phase::MakeSafe { since: now };
        }
    }

    fn make_safe(&mut self, now: Instant, since: Instant, driver: &mut dyn Driver) {
        driver.make_safe(now);
        if !driver.safe() {
            if now.since(since) < SAFE_WITHIN {
                return;
            }
            self.fault(format!(
                "outputs are not confirmed safe after {SAFE_WITHIN}"
            ));
        }
        self.phase = Phase::Done;
        self.out.push(RunEvent::ProcedureFinished {
            verdict: self.verdict,
            message: self.messages.join("; "),
            at: now,
        });
    }

    fn fault(&mut self, text: String) {
        self.note(Verdict::Error, text);
    }

    fn note(&mut self, verdict: Verdict, text: String) {
        self.verdict = self.verdict.and(verdict);
        self.messages.push(text);
    }

    fn suspect(&self, step: &Step) -> String {
        step.suspect
            .as_ref()
            .unwrap_or(&self.procedure.suspect)
            .clone()
    }

    fn operator(&self) -> Operator {
        Operator {
            policy: self.options.prompts,
            answer: self.answer,
        }
    }
}

impl Turn {
    fn name(self, step: &Step) -> String {
        if self.of == 1 {
            step.name.clone()
        } else {
            format!("{} ({}/{})", step.name, self.number, self.of)
        }
    }
}

/// Rounds of the chosen steps, each with its own repetitions.
fn schedule(procedure: &Procedure, options: &RunOptions) -> Vec<Turn> {
    let all: Vec<usize> = (0..procedure.steps.len()).collect();
    let chosen = options.chosen.as_ref().unwrap_or(&all);
    let mut turns = Vec::new();
    for round in 0..options.repeat {
        for &index in chosen.iter().filter(|&&i| i < procedure.steps.len()) {
            let repeat = procedure.steps[index].repeat;
            turns.extend((1..=repeat).map(|k| Turn {
                index,
                number: round * repeat + k,
                of: options.repeat * repeat,
            }));
        }
    }
    turns
}

/// Whether a step looks at the emergency brake or provokes an event that applies it.
fn asks_for_brake(step: &Step) -> bool {
    let mut looks = false;
    step.for_each_signal(&mut |signal| {
        looks |= matches!(signal, Signal::Eb | Signal::EbLoop | Signal::EbCause);
    });
    let provoked: EventSet = step.provoked().collect();
    looks || provoked.intersects(BRAKING_EVENTS.into_iter().collect())
}
