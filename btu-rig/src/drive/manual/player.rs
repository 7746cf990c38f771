//! Plays a sequence on a rig, scan by scan: prepares the train, waits for each step's condition, performs its
//! actions, and ends when the sequence, ATP or the link ends it.

use protocol::message::{EbCause, FsbCause, Mode, ModeSwitch};
use protocol::signal::Signal;
use protocol::{CYCLE, Duration, Instant};

use super::file::MAX_STEPS;
use super::keys::powers;
use super::outcome::behind_colon;
use super::{AtpBrake, Ending, Figures, Outcome, Plan, StepDone, When};
use crate::drive::recording::Recording;
use crate::drive::{Landmark, Row, watch};
use crate::lever::Lever;
use crate::procedure::Refusal;
use crate::rig::{Rig, TrueMotion};
use crate::stimulus::Stimulus;
use crate::tcms::TcmsMode;
use crate::train::TrainData;

/// Time a unit may take from power-up until it lets the train be driven.
const READY_WITHIN: Duration = Duration::from_ms(10_000);
/// Time a step may wait for a speed or a standstill [default].
pub(super) const REACHED_WITHIN: Duration = Duration::from_ms(120_000);
/// Share of full service up to which brakes count as released.
const RELEASED_SHARE: f64 = 0.001;
/// Standing for so long after the last step, the run is over.
const STANDS: Duration = Duration::from_ms(2_000);
/// A train that ATP brakes is watched for so long, should it neither stand nor be released.
const ATP_STOPS_WITHIN: Duration = Duration::from_ms(60_000);
/// Released for so long, a brake of ATP is over.
const RELEASED: Duration = Duration::from_ms(2_000);
/// Longest run [default].
pub(super) const LONGEST: Duration = Duration::from_ms(3_600_000);

/// Where the run is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Begin,
    /// The cab is ready; the unit is to let it drive.
    Preparing {
        since: Instant,
    },
    /// The sequence is played.
    Playing {
        since: Instant,
    },
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

/// A brake of ATP: the gravest, since when, and since when there is none any more.
#[derive(Clone, Copy, Debug)]
struct AtpBraking {
    brake: AtpBrake,
    since: Instant,
    released: Option<Instant>,
}

/// A run under way.
#[derive(Debug)]
pub struct Player {
    plan: Plan,
    phase: Phase,
    next: usize,
    waiting: Waiting,
    braked: Option<AtpBraking>,
    done: Vec<StepDone>,
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
            braked: None,
            done: Vec::new(),
            recording: Recording::default(),
        }
    }

    /// One scan; the outcome once it is over.
    pub fn step(&mut self, now: Instant, rig: &mut Rig) -> Option<Outcome> {
        let truth = rig.truth();
        self.recording.scan(now, &truth, rig);
        match self.advance(now, &truth, rig) {
            Ok(None) => None,
            Ok(Some(ending)) => Some(self.end(ending)),
            Err(Refusal(text)) => Some(self.end(Ending::Refused(text))),
        }
    }

    /// Does something now, by hand; nothing before the train may be driven.
    ///
    /// # Errors
    /// What the bench cannot do, and more than a sequence can hold.
    pub fn act(&mut self, now: Instant, rig: &mut Rig, action: Stimulus) -> Result<(), Refusal> {
        if !matches!(self.phase, Phase::Playing { .. }) {
            return Ok(());
        }
        if self.done.len() >= MAX_STEPS {
            return Err(Refusal(format!("no more than {MAX_STEPS} actions a run")));
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
        self.braked.map(|braked| braked.brake)
    }

    /// Ends the run.
    pub fn end(&mut self, ending: Ending) -> Outcome {
        self.phase = Phase::Over;
        let mut recording = std::mem::take(&mut self.recording);
        let done = std::mem::take(&mut self.done);
        let mut landmarks: Vec<_> = done.iter().map(Landmark::from).collect();
        if let Some(began) = recording.began {
            for row in &mut recording.rows {
                row.t_s = row.signals.at.since(began).as_secs();
                row.speed_kmh = row.speed_kmh.abs();
            }
            landmarks.extend(recording.logged(began.as_secs()));
            landmarks.sort_by(|a, b| a.t_s.total_cmp(&b.t_s));
        }
        let rows = recording.rows;
        Outcome {
            ending,
            figures: Figures::of(&rows, &done, &self.plan),
            landmarks,
            rows,
            done,
        }
    }

    fn advance(
        &mut self,
        now: Instant,
        truth: &TrueMotion,
        rig: &mut Rig,
    ) -> Result<Option<Ending>, Refusal> {
        if let Some(text) = watch::link_error(now, rig) {
            return Ok(Some(Ending::LinkLost(text)));
        }
        match self.phase {
            Phase::Begin => {
                self.prepare(now, rig)?;
                self.phase = Phase::Preparing { since: now };
            }
            // On a cycle, so that a sequence driven again has its rows at the same times.
            Phase::Preparing { .. }
                if now.as_us().is_multiple_of(CYCLE.as_us())
                    && self.lacking(truth, rig).is_none() =>
            {
                self.phase = Phase::Playing { since: now };
                self.recording.began = Some(now);
                self.wait(now, truth, true);
                return self.play(now, now, truth, rig);
            }
            Phase::Preparing { since } if now.since(since) >= READY_WITHIN => {
                let lacks = self.lacking(truth, rig).unwrap_or_default();
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

    /// What keeps the train from being driven, in words; none = nothing does.
    fn lacking(&self, truth: &TrueMotion, rig: &Rig) -> Option<String> {
        let brakes = truth.air_brake_n > RELEASED_SHARE * self.plan.full_service_n();
        let brakes = brakes.then(|| "the brakes do not release".into());
        refusal(rig).or(brakes)
    }

    fn play(
        &mut self,
        now: Instant,
        since: Instant,
        truth: &TrueMotion,
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
        if let Some(braked) = self.braked {
            let lasted = |since: Instant, limit| now.since(since) >= limit;
            let released = braked.released.is_some_and(|at| lasted(at, RELEASED));
            let over = stood(&self.waiting) || released || lasted(braked.since, ATP_STOPS_WITHIN);
            return Ok(over.then_some(Ending::Atp(braked.brake)));
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

    fn reached(&self, now: Instant, truth: &TrueMotion, when: When) -> bool {
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
        truth: &TrueMotion,
        rig: &mut Rig,
        line: usize,
        actions: Vec<Stimulus>,
    ) -> Result<(), Refusal> {
        for action in &actions {
            rig.apply(now, action)?;
        }
        let leaves = truth.speed_mps == 0.0 && actions.iter().any(powers);
        let began = self.recording.began.unwrap_or(now);
        self.done.push(StepDone {
            line,
            t_s: now.since(began).as_secs(),
            x_m: truth.position_m,
            speed_kmh: truth.speed_mps.abs() * 3.6,
            actions,
        });
        self.wait(now, truth, leaves);
        Ok(())
    }

    /// Begins to wait for the next step.
    fn wait(&mut self, now: Instant, truth: &TrueMotion, leaves: bool) {
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
        let on = |signal| sample.get(signal) == Some(1.0);
        let found = if on(Signal::Eb) {
            AtpBrake::Emergency(watch::eb_cause(sample))
        } else if on(Signal::Fsb) {
            let cause = sample.get(Signal::FsbCause);
            let cause = cause.map(|code| FsbCause::from_code(code as u8));
            AtpBrake::FullService(cause.filter(|cause| *cause != FsbCause::None))
        } else {
            // By hand one drives on once ATP has released.
            if self.plan.by_hand {
                self.braked = None;
            }
            if let Some(braked) = &mut self.braked {
                braked.released.get_or_insert(now);
            }
            return;
        };
        let braked = self.braked.get_or_insert(AtpBraking {
            brake: found,
            since: now,
            released: None,
        });
        braked.released = None;
        if braked.brake.is_outranked_by(found) {
            braked.brake = found;
        }
    }
}

/// What unit and TCMS have against driving, in words; none = nothing.
fn refusal(rig: &Rig) -> Option<String> {
    let sample = rig.sample();
    let is = |signal, value: f64| sample.get(signal) == Some(value);
    let mode = watch::mode(sample);
    if mode != Some(Mode::Manual) {
        let named = mode.map_or("unknown", Mode::label);
        return Some(format!("the unit is in mode {named}"));
    }
    if !is(Signal::TcmsMode, f64::from(TcmsMode::Manual.code())) {
        return Some("TCMS does not drive by hand".into());
    }
    if !is(Signal::Eb, 0.0) {
        let cause = behind_colon(watch::eb_cause(sample), EbCause::label);
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
