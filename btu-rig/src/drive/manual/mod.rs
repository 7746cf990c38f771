//! Driving by hand: notches and switches in sequence, with the unit in the loop. Sans-IO as
//! [`super::Drive`]: stepped once a scan after [`crate::rig::Bench::tick`].
//!
//! * `sequence`, `action`, `file`: what is done when, and its file;
//! * `plan`: on which train, under which code;
//! * `row`, `recording`: what is recorded each cycle;
//! * `settle`, `figures`: what it came to.
//!
//! Terms: a *step* waits for its condition and then does its actions; a *deed* is a step done.

mod action;
mod figures;
mod file;
mod plan;
mod recording;
mod row;
mod sequence;
mod settle;

use protocol::message::{EbCause, FsbCause, Mode, ModeSwitch};
use protocol::signal::Signal;
use protocol::{CYCLE, Duration, Instant};
use thiserror::Error;

use super::Landmark;
use crate::lever::Lever;
use crate::procedure::Refusal;
use crate::rig::{Rig, Truth};
use crate::stimulus::Stimulus;
use crate::tcms::TcmsMode;
use crate::train::TrainData;

pub use action::Action;
pub use figures::Figures;
pub use file::{MAX_AFTER_S, MAX_STEPS, SequenceError, Wrong};
pub use plan::{ManualError, Plan};
pub use row::{PAIRS, Pair, Row};
pub use sequence::{Load, Sequence, Step, When};
pub use settle::{Settled, WITHIN, settled};

use recording::Recording;

/// Time a unit may take from power-up until it lets the train be driven.
const READY_WITHIN: Duration = Duration::from_ms(10_000);
/// Time a step may wait for a speed or a standstill [default].
const REACHED_WITHIN: Duration = Duration::from_ms(120_000);
/// Standing for so long after the last step, the run is over.
const STANDS: Duration = Duration::from_ms(2_000);
/// A train that ATP brakes is watched for so long, should it not come to a stand.
const ATP_STOPS_WITHIN: Duration = Duration::from_ms(60_000);
/// Longest run [default].
const LONGEST: Duration = Duration::from_ms(3_600_000);

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Ending {
    /// All steps were done.
    #[error("all steps done")]
    Played,
    /// Whoever drove ended it.
    #[error("ended by hand")]
    ByHand,
    /// The bench cannot do what the sequence asks for.
    #[error("the bench refused: {0}")]
    Refused(String),
    /// The unit did not let the train be driven.
    #[error("never ready: {0}")]
    NeverReady(String),
    /// ATP braked.
    #[error("{0}")]
    Atp(AtpBrake),
    /// What a step waited for did not come.
    #[error("line {line}: {what} not reached within {} s", REACHED_WITHIN.as_secs())]
    NotReached {
        /// Line of the step.
        line: usize,
        /// What it waited for.
        what: String,
    },
    /// All steps were done, and the train does not stand.
    #[error("the train does not stand {} s after the last step", REACHED_WITHIN.as_secs())]
    NeverStood,
    /// The run took too long.
    #[error("time limit of {} s", LONGEST.as_secs())]
    TimeLimit,
    /// The unit cannot be reached any more.
    #[error("link lost: {0}")]
    LinkLost(String),
}

/// A brake ATP applied, with the unit's cause if it said one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum AtpBrake {
    /// Full service.
    #[error("ATP applied the full service brake{}", told(*.0, FsbCause::None, FsbCause::label))]
    FullService(Option<FsbCause>),
    /// Emergency.
    #[error("ATP applied the emergency brake{}", told(*.0, EbCause::None, EbCause::label))]
    Emergency(Option<EbCause>),
}

fn told<C: PartialEq>(cause: Option<C>, none: C, label: fn(C) -> &'static str) -> String {
    let known = cause.filter(|cause| *cause != none);
    known.map_or_else(String::new, |cause| {
        format!(": {}", label(cause).replace('_', " "))
    })
}

/// A step as it was done.
#[derive(Clone, Debug, PartialEq)]
pub struct Done {
    /// Line of its file; 0 = by hand.
    pub line: usize,
    /// Time since the sequence began, s.
    pub t_s: f64,
    /// Head of the train in the section, m.
    pub x_m: f64,
    /// Speed, km/h, a size.
    pub speed_kmh: f64,
    /// What was done.
    pub actions: Vec<Action>,
}

impl Done {
    /// What was done, in words.
    pub fn what(&self) -> String {
        let words: Vec<_> = self.actions.iter().map(ToString::to_string).collect();
        words.join(", ")
    }
}

/// What a run came to.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// How it ended.
    pub ending: Ending,
    /// One row a cycle. Time 0 is the beginning of the sequence.
    pub rows: Vec<Row>,
    /// Steps that were done.
    pub done: Vec<Done>,
    /// Those, and what unit and TCMS logged, in order.
    pub landmarks: Vec<Landmark>,
    /// Figures.
    pub figures: Figures,
}

/// Where the run is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// Nothing done yet.
    Begin,
    /// The cab is ready; the unit is to let it drive.
    Preparing { since: Instant },
    /// The sequence is played.
    Playing { since: Instant },
    /// Over.
    Over,
}

/// What the next step has seen while it waits.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    since: Instant,
    /// Speed when it began to wait, km/h.
    from_kmh: f64,
    /// The train has moved since it last was to leave.
    moved: bool,
    stands_since: Option<Instant>,
}

/// A run under way.
#[derive(Debug)]
pub struct Player {
    plan: Plan,
    phase: Phase,
    next: usize,
    waiting: Waiting,
    lever: Lever,
    braked: Option<(Instant, AtpBrake)>,
    recording: Recording,
}

impl Player {
    /// A run that begins with the next step, on a rig whose train stands.
    pub fn new(plan: Plan) -> Self {
        Self {
            plan,
            phase: Phase::Begin,
            next: 0,
            waiting: Waiting {
                since: Instant::ZERO,
                from_kmh: 0.0,
                moved: false,
                stands_since: None,
            },
            lever: Lever::Neutral,
            braked: None,
            recording: Recording::default(),
        }
    }

    /// One scan; the outcome once it is over.
    pub fn step(&mut self, now: Instant, rig: &mut Rig) -> Option<Outcome> {
        let truth = rig.truth();
        self.recording.scan(now, &truth, self.lever.number(), rig);
        match self.advance(now, &truth, rig) {
            Ok(None) => None,
            Ok(Some(ending)) => Some(self.end(ending)),
            Err(Refusal(text)) => Some(self.end(Ending::Refused(text))),
        }
    }

    /// Does something now, by hand; nothing before the train may be driven.
    ///
    /// # Errors
    /// What the bench cannot do.
    pub fn act(&mut self, now: Instant, rig: &mut Rig, action: Action) -> Result<(), Refusal> {
        if !matches!(self.phase, Phase::Playing { .. }) {
            return Ok(());
        }
        let truth = rig.truth();
        self.perform(now, &truth, rig, 0, vec![action])
    }

    /// The newest row, once the train may be driven.
    pub fn newest(&self) -> Option<&Row> {
        self.recording.rows.last()
    }

    /// The brake ATP has applied, if it has.
    pub fn atp_brake(&self) -> Option<AtpBrake> {
        self.braked.map(|(_, brake)| brake)
    }

    /// Position of the master controller.
    pub fn lever(&self) -> Lever {
        self.lever
    }

    /// Ends the run.
    pub fn end(&mut self, ending: Ending) -> Outcome {
        self.phase = Phase::Over;
        let recording = std::mem::take(&mut self.recording);
        let landmarks = recording.landmarks();
        Outcome {
            ending,
            figures: Figures::of(&recording.rows, &recording.done, &self.plan),
            landmarks,
            rows: recording.rows,
            done: recording.done,
        }
    }

    fn advance(
        &mut self,
        now: Instant,
        truth: &Truth,
        rig: &mut Rig,
    ) -> Result<Option<Ending>, Refusal> {
        // Silence lasts for many cycles before it is one, so it need not be looked for each scan.
        if now.as_us().is_multiple_of(CYCLE.as_us())
            && let Some(text) = rig.link_error()
        {
            return Ok(Some(Ending::LinkLost(text)));
        }
        match self.phase {
            Phase::Begin => {
                self.prepare(now, rig)?;
                self.phase = Phase::Preparing { since: now };
            }
            // On a cycle, so that a sequence driven again has its rows at the same times.
            Phase::Preparing { .. }
                if now.as_us().is_multiple_of(CYCLE.as_us()) && lacking(rig).is_none() =>
            {
                self.phase = Phase::Playing { since: now };
                self.recording.began = Some(now);
                self.wait(now, truth, true);
            }
            Phase::Preparing { since } if now.since(since) >= READY_WITHIN => {
                let lacks = lacking(rig).unwrap_or_default();
                return Ok(Some(Ending::NeverReady(lacks)));
            }
            Phase::Playing { since } => return self.play(now, since, truth, rig),
            Phase::Preparing { .. } | Phase::Over => {}
        }
        Ok(None)
    }

    /// Everything cab and wayside give a train that is to be driven by hand.
    fn prepare(&mut self, now: Instant, rig: &mut Rig) -> Result<(), Refusal> {
        rig.set_train(TrainData::Cars(self.plan.train.clone()));
        rig.set_conditions(self.plan.conditions);
        for stimulus in [
            Stimulus::Load {
                passengers_kg: self.plan.load_kg,
            },
            Stimulus::MarkersAlong {
                section: Some(self.plan.section.section),
            },
            self.plan.antenna,
            Stimulus::TrainDriven { on: true },
            Stimulus::ModeSwitch(ModeSwitch::Manual),
            Stimulus::Reverser { position: 1 },
            Stimulus::Controller {
                lever: Lever::Neutral,
            },
        ] {
            rig.apply(now, &stimulus)?;
        }
        Ok(())
    }

    fn play(
        &mut self,
        now: Instant,
        since: Instant,
        truth: &Truth,
        rig: &mut Rig,
    ) -> Result<Option<Ending>, Refusal> {
        if now.since(since) >= LONGEST {
            return Ok(Some(Ending::TimeLimit));
        }
        self.watch_atp(now, rig);
        let waiting = &mut self.waiting;
        if truth.speed_mps != 0.0 {
            waiting.moved = true;
            waiting.stands_since = None;
        } else if waiting.moved && waiting.stands_since.is_none() {
            waiting.stands_since = Some(now);
        }
        if self.plan.by_hand {
            return Ok(None);
        }
        let stood = |waiting: &Waiting| {
            let stands = waiting
                .stands_since
                .or((!waiting.moved).then_some(waiting.since));
            stands.is_some_and(|stands| now.since(stands) >= STANDS)
        };
        if let Some((at, brake)) = self.braked {
            let over = stood(&self.waiting) || now.since(at) >= ATP_STOPS_WITHIN;
            return Ok(over.then_some(Ending::Atp(brake)));
        }
        while let Some(step) = self.plan.sequence.steps.get(self.next) {
            if !self.reached(now, truth, step.when) {
                let late = now.since(self.waiting.since) >= REACHED_WITHIN;
                let timed = matches!(step.when, When::After(_));
                return Ok((late && !timed).then(|| Ending::NotReached {
                    line: step.line,
                    what: step.when.to_string(),
                }));
            }
            let (line, actions) = (step.line, step.actions.clone());
            self.next += 1;
            self.perform(now, truth, rig, line, actions)?;
        }
        let waited = now.since(self.waiting.since);
        Ok(match self.plan.sequence.end_after_s {
            Some(end_after_s) => {
                (waited >= Duration::from_secs(end_after_s)).then_some(Ending::Played)
            }
            None if stood(&self.waiting) => Some(Ending::Played),
            None => (waited >= REACHED_WITHIN).then_some(Ending::NeverStood),
        })
    }

    fn reached(&self, now: Instant, truth: &Truth, when: When) -> bool {
        let waiting = &self.waiting;
        match when {
            When::After(seconds) => now.since(waiting.since) >= Duration::from_secs(seconds),
            When::AtKmh(kmh) => {
                let (from, to) = (waiting.from_kmh, truth.speed_mps.abs() * 3.6);
                (from <= kmh && kmh <= to) || (to <= kmh && kmh <= from)
            }
            When::AtStandstill => waiting.moved && truth.speed_mps == 0.0,
        }
    }

    fn perform(
        &mut self,
        now: Instant,
        truth: &Truth,
        rig: &mut Rig,
        line: usize,
        actions: Vec<Action>,
    ) -> Result<(), Refusal> {
        for action in &actions {
            rig.apply(now, &action.stimulus())?;
            if let Action::Lever(lever) = action {
                self.lever = *lever;
            }
        }
        let leaves = truth.speed_mps == 0.0 && actions.iter().any(|action| action.powers());
        self.recording.note(now, line, truth, actions);
        self.wait(now, truth, leaves);
        Ok(())
    }

    /// Begins to wait for the next step.
    fn wait(&mut self, now: Instant, truth: &Truth, leaves: bool) {
        self.waiting.since = now;
        self.waiting.from_kmh = truth.speed_mps.abs() * 3.6;
        if leaves {
            self.waiting.moved = false;
            self.waiting.stands_since = None;
        }
    }

    /// Notes a brake that ATP applies, and its cause as soon as the unit says it.
    fn watch_atp(&mut self, now: Instant, rig: &Rig) {
        let sample = rig.sample();
        let code = |signal| sample.get(signal).map(|code| code as u8);
        let on = |signal| sample.get(signal) == Some(1.0);
        let found = if on(Signal::Eb) {
            let cause = code(Signal::EbCause).map(EbCause::from_code);
            AtpBrake::Emergency(cause.filter(|cause| *cause != EbCause::None))
        } else if on(Signal::Fsb) {
            let cause = code(Signal::FsbCause).map(FsbCause::from_code);
            AtpBrake::FullService(cause.filter(|cause| *cause != FsbCause::None))
        } else {
            // By hand one drives on once ATP has released.
            if self.plan.by_hand {
                self.braked = None;
            }
            return;
        };
        match &mut self.braked {
            None => self.braked = Some((now, found)),
            Some((_, brake)) if brake.told_less_than(found) => *brake = found,
            Some(_) => {}
        }
    }
}

impl AtpBrake {
    /// The other is graver, or has a cause where this has none.
    fn told_less_than(self, other: Self) -> bool {
        let rank = |brake: Self| match brake {
            Self::FullService(None) => 0,
            Self::FullService(Some(_)) => 1,
            Self::Emergency(None) => 2,
            Self::Emergency(Some(_)) => 3,
        };
        rank(self) < rank(other)
    }
}

/// What keeps the train from being driven, in words; none = nothing does.
fn lacking(rig: &Rig) -> Option<String> {
    let sample = rig.sample();
    let is = |signal, value: f64| sample.get(signal) == Some(value);
    let mode = sample
        .get(Signal::Mode)
        .map(|code| Mode::from_code(code as u8));
    if mode != Some(Mode::Manual) {
        let named = mode.map_or("unknown", Mode::label);
        return Some(format!("the unit is in mode {named}"));
    }
    if !is(Signal::TcmsMode, f64::from(TcmsMode::Manual.code())) {
        return Some("TCMS does not drive by hand".into());
    }
    if !is(Signal::Eb, 0.0) {
        let cause = sample
            .get(Signal::EbCause)
            .map(|code| EbCause::from_code(code as u8));
        let cause = told(cause, EbCause::None, EbCause::label);
        return Some(format!("the unit keeps the emergency brake applied{cause}"));
    }
    if !is(Signal::Fsb, 0.0) {
        return Some("the unit asks for the full service brake".into());
    }
    if !is(Signal::PowerCutCauses, 0.0) {
        return Some("TCMS cuts powering".into());
    }
    None
}
