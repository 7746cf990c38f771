//! A station-to-station automatic run: what a depot does with a whole train, done with a unit and
//! the rig. Sans-IO: stepped once a scan after [`crate::rig::Bench::tick`], it gives the unit what
//! a wayside and a cab would, watches the train, and ends with an [`Outcome`].
//!
//! A drive knows of the unit only what its frames say. The train's true motion (position, speed, acceleration) is
//! known to the rig alone.
//!
//! * `plan`: what is run; `watch`: what is looked at each scan;
//! * `row`, `recording`: what is recorded each cycle;
//! * `metrics`: figures of a run, from its rows, with the names and units that reports use;
//! * `landmarks`: what happened where, from its rows and the unit's log;
//! * `scatter`: how trains and days differ, drawn for many runs.

pub mod landmarks;
pub mod metrics;
mod plan;
mod recording;
mod row;
pub mod scatter;
mod watch;

use std::fmt::Display;

use protocol::message::{EbCause, Mode, ModeSwitch, Refusals};
use protocol::signal::Signal;
use protocol::{Duration, Instant};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::procedure::Refusal;
use crate::procedure::describe::meanings;
use crate::rig::{LinkTrouble, Rig, TrueMotion};
use crate::stimulus::Stimulus;

pub use landmarks::{Landmark, Mark};
pub use metrics::{Figure, Metrics};
pub use plan::{Codes, DrivePlan, Load, PlanError, code_in_antenna};
pub use row::Row;
pub use scatter::{Scatter, ScatterDraw};

use recording::Recording;

/// Time a unit may take from power-up until ATP sets Automatic.
const READY_WITHIN: Duration = Duration::from_ms(10_000);
/// Time in which the unit hears the station data of the departure, sent every 250 ms. Before, ATP may set Automatic by
/// the station data of an arrival, under which no run begins.
const DEPARTURE_HEARD: Duration = Duration::from_ms(500);
/// Time from the start button until ATP sets Automatic Run.
const RUN_WITHIN: Duration = Duration::from_ms(2_000);
/// Time from Automatic Run until the train moves.
const LEAVE_WITHIN: Duration = Duration::from_ms(20_000);
/// Time of standing without any powering asked for, after which a run is over.
const STANDS: Duration = Duration::from_ms(1_000);
/// Time of standing after which a run is over, whatever is asked for.
const STANDS_AT_MOST: Duration = Duration::from_ms(10_000);
/// Longest time of a run, beside the time that the section takes at [`SLOWEST_MPS`].
const RUN_BASE: Duration = Duration::from_ms(60_000);
/// Slowest believable mean speed of a run, m/s.
const SLOWEST_MPS: f64 = 4.0;
/// A train that is no longer driven is observed for this long if nothing brakes it.
const COASTS: Duration = Duration::from_ms(60_000);
/// Distance after which the train has left the departure station's loop, m.
const LOOP_LEFT_M: f64 = 50.0;

/// End of a run.
#[derive(Clone, Debug, PartialEq, Eq, Error, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ending {
    /// The train stands and powers no more.
    #[error("stopped")]
    Stopped,
    /// The rig cannot do what the plan asks for.
    #[error("the bench refused: {0}")]
    Refused(String),
    /// ATP did not set Automatic.
    #[error("never ready: ATP did not set Automatic{}", after_colon(.refusals.map(lacking)))]
    NeverReady {
        /// Preconditions that do not hold, if the unit said.
        refusals: Option<u16>,
    },
    /// ATP did not set Automatic Run after the start button.
    #[error("never started: ATP did not set Automatic Run{}", after_colon(.refusals.map(lacking)))]
    NeverStarted {
        /// Preconditions that do not hold, if the unit said.
        refusals: Option<u16>,
    },
    #[error("never left: no motion in Automatic Run")]
    NeverLeft,
    /// The unit applied the emergency brake; the train stands.
    #[error("emergency brake{}", after_colon(.cause.map(EbCause::label)))]
    EmergencyBrake {
        /// Cause of the brake, if the unit said it.
        cause: Option<EbCause>,
    },
    /// ATP took the train out of Automatic Run while it moved; it stands, or rolls on.
    #[error("left Automatic Run while moving{}", after_colon(.mode.map(named)))]
    LeftAutomatic {
        /// Mode it went to, if the unit said.
        mode: Option<Mode>,
    },
    /// The run took too long.
    #[error("time limit: still under way")]
    TimeLimit,
    /// The unit cannot be reached any more.
    #[error("link lost: {0}")]
    LinkLost(LinkTrouble),
}

/// A detail that may be unknown, behind a colon.
fn after_colon(detail: Option<impl Display>) -> String {
    detail.map_or_else(String::new, |detail| format!(": {detail}"))
}

fn lacking(refusals: u16) -> String {
    meanings(&Refusals::SPEC, refusals)
}

fn named(mode: Mode) -> String {
    format!("mode {}", mode.label())
}

#[derive(Clone, Debug)]
pub struct Outcome {
    pub ending: Ending,
    /// One row a cycle from the start button on. Time 0 is when the train began to move.
    pub rows: Vec<Row>,
    /// What happened on the way, in order.
    pub landmarks: Vec<Landmark>,
    /// Head of the train at rest less stop point, m; above 0 = past it. `None` unless it stands
    /// after having moved.
    pub stop_error_m: Option<f64>,
    /// The other figures; `None` when the train never moved.
    pub metrics: Option<Metrics>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Begin,
    /// The cab is ready; ATP is to set Automatic.
    Preparing {
        since: Instant,
    },
    /// Start was pressed; ATP is to set Automatic Run.
    Starting {
        since: Instant,
    },
    /// Automatic Run; the train is to move.
    Leaving {
        since: Instant,
    },
    /// The train moves, or stands after having moved.
    Running,
    Over,
}

#[derive(Debug)]
pub struct Drive {
    plan: DrivePlan,
    phase: Phase,
    handed_over: bool,
    /// The emergency brake was applied, and why if the unit said.
    braked: Option<Option<EbCause>>,
    /// ATP took the moving train out of Automatic Run: when, and into which mode.
    left: Option<(Instant, Option<Mode>)>,
    /// When the train began to move.
    moves_since: Option<Instant>,
    /// Since when it stands after having moved.
    stands_since: Option<Instant>,
    to_stop_m: Option<f64>,
    recording: Recording,
}

impl Drive {
    /// A run that begins with the next step, on a rig whose train stands.
    pub fn new(plan: DrivePlan) -> Self {
        Self {
            plan,
            phase: Phase::Begin,
            handed_over: false,
            braked: None,
            left: None,
            moves_since: None,
            stands_since: None,
            to_stop_m: None,
            recording: Recording::default(),
        }
    }

    /// One scan; the outcome once it is over.
    pub fn step(&mut self, now: Instant, rig: &mut Rig) -> Option<Outcome> {
        if self.phase == Phase::Begin {
            if let Err(Refusal(text)) = self.prepare(now, rig) {
                return Some(self.end(Ending::Refused(text)));
            }
            self.phase = Phase::Preparing { since: now };
        }
        let truth = rig.truth();
        self.to_stop_m = truth.to_stop_m;
        self.recording.scan(now, &truth, rig);
        let ending = match self.hand_over(now, &truth, rig) {
            Err(Refusal(text)) => Some(Ending::Refused(text)),
            Ok(()) => self.advance(now, &truth, rig),
        };
        ending.map(|ending| self.end(ending))
    }

    /// Ends a run that cannot go on.
    pub fn abandon(&mut self, ending: Ending) -> Outcome {
        self.end(ending)
    }

    /// Everything the cab and the wayside give a train before departure.
    fn prepare(&mut self, now: Instant, rig: &mut Rig) -> Result<(), Refusal> {
        rig.set_train(self.plan.train.clone());
        rig.set_conditions(self.plan.conditions);
        for stimulus in [
            Stimulus::PtuSilent {
                on: !self.plan.tester,
            },
            Stimulus::Load {
                passengers_kg: self.plan.load_kg,
            },
            Stimulus::Station(self.plan.at_departure()),
            Stimulus::MarkersAlong {
                section: Some(self.plan.section.section),
            },
            match self.plan.codes {
                Codes::Along => Stimulus::CodesAlong { on: true },
                Codes::Fixed(code) => code,
            },
            Stimulus::TrainDriven { on: true },
            Stimulus::ModeSwitch(ModeSwitch::Automatic),
        ] {
            rig.apply(now, &stimulus)?;
        }
        Ok(())
    }

    /// Lets the wayside send the station data of the arrival's loop, once the train has left the departure's.
    fn hand_over(
        &mut self,
        now: Instant,
        truth: &TrueMotion,
        rig: &mut Rig,
    ) -> Result<(), Refusal> {
        let left_m = truth.position_m - self.plan.section.start_m;
        if !self.handed_over && left_m >= LOOP_LEFT_M {
            self.handed_over = true;
            rig.apply(now, &Stimulus::Station(self.plan.at_arrival()))?;
        }
        Ok(())
    }

    fn advance(&mut self, now: Instant, truth: &TrueMotion, rig: &mut Rig) -> Option<Ending> {
        if let Some(why) = watch::link_error(now, rig) {
            return Some(Ending::LinkLost(why));
        }
        let sample = rig.sample();
        let mode = watch::mode(sample);
        let refusals = sample.get(Signal::Refusals).map(|bits| bits as u16);
        let moving = truth.speed_mps != 0.0;
        let late = |since: Instant, limit: Duration| now.since(since) >= limit;
        match self.phase {
            Phase::Preparing { since }
                if mode == Some(Mode::Automatic) && late(since, DEPARTURE_HEARD) =>
            {
                if let Err(Refusal(text)) = rig.apply(now, &Stimulus::Start) {
                    return Some(Ending::Refused(text));
                }
                self.recording.began = Some(now);
                self.phase = Phase::Starting { since: now };
            }
            Phase::Preparing { since } if late(since, READY_WITHIN) => {
                return Some(Ending::NeverReady { refusals });
            }
            Phase::Starting { .. } if mode == Some(Mode::AutomaticRun) => {
                self.phase = Phase::Leaving { since: now };
            }
            Phase::Starting { since } if late(since, RUN_WITHIN) => {
                return Some(Ending::NeverStarted { refusals });
            }
            Phase::Leaving { .. } if moving => {
                self.moves_since = Some(now);
                self.phase = Phase::Running;
            }
            Phase::Leaving { since } if late(since, LEAVE_WITHIN) => {
                return Some(Ending::NeverLeft);
            }
            Phase::Running => return self.run(now, rig, mode, moving),
            _ => {}
        }
        None
    }

    fn run(&mut self, now: Instant, rig: &Rig, mode: Option<Mode>, moving: bool) -> Option<Ending> {
        let sample = rig.sample();
        if sample.get(Signal::Eb) == Some(1.0) && self.braked.is_none_or(|cause| cause.is_none()) {
            self.braked = Some(watch::eb_cause(sample));
        }
        // A unit that takes the last centimetres for a standstill goes back to Automatic there.
        let drives = matches!(mode, Some(Mode::AutomaticRun | Mode::Automatic));
        if moving && !drives && self.braked.is_none() && self.left.is_none() {
            self.left = Some((now, mode));
        }
        if moving {
            self.stands_since = None;
            return match self.left {
                Some((at, mode)) => {
                    (now.since(at) >= COASTS).then_some(Ending::LeftAutomatic { mode })
                }
                None => {
                    let began = self.moves_since?;
                    (now.since(began) >= self.longest()).then_some(Ending::TimeLimit)
                }
            };
        }
        let stands = *self.stands_since.get_or_insert(now);
        let powers = sample.get(Signal::Power) == Some(1.0)
            && sample
                .get(Signal::Effort)
                .is_some_and(|effort| effort > 0.0);
        let over = if powers { STANDS_AT_MOST } else { STANDS };
        let ending = match (self.left, self.braked) {
            (Some((_, mode)), _) => Ending::LeftAutomatic { mode },
            (None, Some(cause)) => Ending::EmergencyBrake { cause },
            (None, None) => Ending::Stopped,
        };
        (now.since(stands) >= over).then_some(ending)
    }

    fn longest(&self) -> Duration {
        let section = &self.plan.section;
        let at_slowest = Duration::from_secs((section.stop_m - section.start_m) / SLOWEST_MPS);
        Duration::from_us(RUN_BASE.as_us() + at_slowest.as_us())
    }

    /// Ends the run and gives its result.
    fn end(&mut self, ending: Ending) -> Outcome {
        self.phase = Phase::Over;
        let mut recording = std::mem::take(&mut self.recording);
        let Some(zero) = self.moves_since else {
            return Outcome {
                ending,
                rows: recording.rows,
                landmarks: Vec::new(),
                stop_error_m: None,
                metrics: None,
            };
        };
        let zero_s = zero.as_secs();
        for row in &mut recording.rows {
            row.t_s -= zero_s;
        }
        let stop_m = self.plan.section.stop_m;
        let stop = self.stands_since.zip(self.to_stop_m);
        let stop = stop.map(|(at, left_m)| Landmark {
            t_s: at.since(zero).as_secs(),
            x_m: stop_m - left_m,
            what: Mark::Stop,
        });
        let mut landmarks = landmarks::of_rows(&recording.rows, &self.plan);
        landmarks.extend(recording.logged(zero_s));
        landmarks.extend(stop.clone());
        landmarks.sort_by(|a, b| a.t_s.total_cmp(&b.t_s));
        Outcome {
            ending,
            metrics: Metrics::of(&recording.rows, stop.as_ref().map(|stop| stop.t_s)),
            rows: recording.rows,
            landmarks,
            stop_error_m: stop.map(|stop| stop.x_m - stop_m),
        }
    }
}
