//! Plays a plan on a bench, and has the monitor watch.

use std::iter::Peekable;

use btu_rig::rig::Bench;
use btu_rig::stimulus::{StationData, Stimulus, WaysideCondition};
use protocol::injection::{FaultMode, Place};
use protocol::line::Section;
use protocol::signal::Signal;
use protocol::{Duration, Instant};

use super::find::{Find, state};
use super::monitor::{Breach, MOVES_KMH, Monitor};
use super::observed::Observed;
use super::plan::{Act, Plan, Scene};
use super::ride::Ride;
use ptu_runs::link::SimLink;
use ptu_runs::run::BenchSetup;

/// The unit is powered up a second in, and starts up in three.
const STARTED_MS: u32 = 4_000;
/// Time in which the bench notices that the unit has restarted.
const HEARD_AGAIN: Duration = Duration::from_ms(2_000);
/// Time for which a start button that was pressed may begin a run.
const PRESSED: Duration = Duration::from_ms(800);
/// Time for which a wheel diameter that is keyed in may be taken: the bench keys it in for 300 ms.
const KEYED_IN: Duration = Duration::from_ms(600);

pub(super) struct Player<'a> {
    pub(super) bench: Bench<SimLink>,
    pub(super) setup: &'a BenchSetup,
    pub(super) plan: &'a Plan,
    pub(super) section: &'a Section,
    pub(super) ride: Ride,
    reverser: i8,
    powered: bool,
    turns: Option<[(Stimulus, Duration); 2]>,
    turn_due: Instant,
    started: Option<Instant>,
    crosstalk: [f64; 2],
    wheel: Option<(f64, Instant)>,
    pub(super) told: StationData,
    tacho_made: bool,
    tcms_good: bool,
    driven: bool,
    pulsed: usize,
    acts: Vec<(Instant, Act)>,
}

/// Plays it; what was found first, if anything was, and what only conditions explain.
pub fn play(setup: &BenchSetup, plan: &Plan) -> Option<Find> {
    Player::new(setup, plan).play()
}

/// The limit that the unit tells in each scan of a plan, km/h.
pub fn limits(setup: &BenchSetup, plan: &Plan) -> Vec<f64> {
    Player::new(setup, plan).limits()
}

impl<'a> Player<'a> {
    fn new(setup: &'a BenchSetup, plan: &'a Plan) -> Self {
        let of_plan = BenchSetup {
            faults: plan.faults.clone(),
            ..setup.clone()
        };
        let power_at = Instant::ZERO + Duration::from_ms(1_000);
        let section = &setup.line.content.sections[plan.section];
        Self {
            bench: of_plan.on_bench(plan.number, power_at),
            setup,
            plan,
            section,
            ride: Ride::Over,
            reverser: 1,
            powered: true,
            turns: None,
            turn_due: Instant::ZERO,
            started: None,
            crosstalk: [0.0; 2],
            wheel: None,
            told: StationData::at_departure(section),
            tacho_made: false,
            tcms_good: true,
            driven: false,
            pulsed: 0,
            acts: Vec::new(),
        }
    }

    fn play(mut self) -> Option<Find> {
        let config = &self.setup.config.content;
        let mut monitor = Monitor::new(config, &self.setup.line.content);
        self.begin();
        let begin = self.bench.now();
        let end = begin + Duration::from_ms(u64::from(self.plan.length_ms));
        let held_ms = 2 * config.receiver.hold_ms + config.receiver.detect_ms + 500;
        let started = Duration::from_ms(u64::from(held_ms.max(STARTED_MS)));
        let mut seen_from = begin + started;
        let mut acts = self.plan.acts.iter().peekable();
        let mut found: Option<(Find, u32)> = None;
        while self.bench.now() < end {
            let now = self.bench.now();
            self.scan(begin, &mut acts);
            // Without TCMS nothing tells of motion that no tachometer sees.
            if !self.powered || self.blind() && !self.tcms_good {
                seen_from = now + started;
            }
            let observed = self.observed();
            let breach = monitor.step(observed).filter(|_| now >= seen_from);
            let restarts = self.bench.rig.unit_restarts();
            if found.is_none() {
                found = breach.map(|breach| (self.found(breach), restarts));
            }
            // A unit that restarts is heard again only after a while: until then the bench has its last contacts.
            let ripe = |(find, _): &mut (Find, u32)| now.since(find.at) > HEARD_AGAIN;
            if let Some((find, before)) = found.take_if(ripe) {
                if before == restarts {
                    return Some(find);
                }
                seen_from = now + started;
            }
        }
        None
    }

    /// One scan, with what is due in it.
    fn scan<'p>(
        &mut self,
        begin: Instant,
        acts: &mut Peekable<impl Iterator<Item = &'p (u32, Act)>>,
    ) {
        let now = self.bench.now();
        let due = |at_ms: u32| now >= begin + Duration::from_ms(u64::from(at_ms));
        while let Some((_, act)) = acts.next_if(|(at_ms, _)| due(*at_ms)) {
            self.act(*act);
        }
        self.turn(now);
        self.go_on(now);
        self.bench.tick().expect("the embedded unit answers");
    }

    /// The limit in each scan, km/h.
    fn limits(mut self) -> Vec<f64> {
        self.begin();
        let begin = self.bench.now();
        let end = begin + Duration::from_ms(u64::from(self.plan.length_ms));
        let mut acts = self.plan.acts.iter().peekable();
        let mut limits = Vec::new();
        while self.bench.now() < end {
            self.scan(begin, &mut acts);
            limits.push(self.bench.rig.sample().get(Signal::Limit).unwrap_or(0.0));
        }
        limits
    }

    fn observed(&self) -> Observed<'_> {
        let (rig, now) = (&self.bench.rig, self.bench.now());
        let truth = rig.truth();
        Observed {
            now,
            sample: rig.sample(),
            speed_mps: truth.speed_mps,
            accel_mps2: truth.accel_mps2,
            to_stop_m: truth.to_stop_m,
            traction_n: truth.traction_n,
            sliding: truth.sliding,
            driven: self.driven,
            doors_open: rig.doors_open(),
            reverser: self.reverser,
            chatters: self.chatters(),
            section: self.section.section,
            told: self.told.section,
            start: self.started.is_some_and(|at| now.since(at) < PRESSED),
            blind: self.blind(),
            powered: self.powered,
            crosstalk: self.crosstalk,
            wheel_mm: (self.wheel.filter(|(_, at)| now.since(*at) < KEYED_IN)).map(|(mm, _)| mm),
            pulsed: self.pulsed,
            displaced: self.plan.displaced_m,
        }
    }

    fn found(&self, breach: Breach) -> Find {
        let seen = self.observed();
        let mut faults: Vec<_> = (self.plan.faults.iter())
            .map(|fault| fault.id.clone())
            .collect();
        if self.tacho_made {
            faults.push("speed_sensor_1.of_the_bench".to_owned());
        }
        Find {
            breach,
            at: seen.now,
            state: state(seen),
            hidden_kmh: seen.kmh() - seen.value(Signal::Speed),
            faults,
            acts: self.acts.clone(),
        }
    }

    /// Brings the bench to the beginning of the scene.
    fn begin(&mut self) {
        let scene = self.plan.scene;
        let ride = matches!(scene, Scene::Ride(_));
        self.lay();
        for stimulus in [
            Stimulus::DoorsFollow { on: true },
            Stimulus::ModeSwitch(scene.switch()),
            Stimulus::CodesAlong { on: true },
            Stimulus::Station(self.told),
            Stimulus::Wayside(WaysideCondition::Good),
            Stimulus::TrainDriven {
                on: scene != Scene::OnBench,
            },
        ] {
            self.apply(stimulus);
        }
        self.wait(4_000);
        self.apply(Stimulus::Acknowledge);
        self.wait(1_000);
        if let Some(coefficient) = self.plan.adhesion {
            self.apply(Stimulus::Adhesion {
                coefficient: Some(coefficient),
            });
        }
        if let Some(stimulus) = scene.begins() {
            self.apply(stimulus);
        }
        if ride {
            self.ride = Ride::At(self.bench.now());
        }
    }

    fn wait(&mut self, ms: u32) {
        for _ in 0..ms / 10 {
            self.bench.tick().expect("the embedded unit answers");
        }
    }

    /// Lays the section, with its markers where they lie in truth.
    pub(super) fn lay(&mut self) {
        let section = Some(self.section.section);
        self.apply(Stimulus::MarkersAlong { section });
        for (psm, by_m) in (1..).zip(self.plan.displaced_m) {
            if by_m != 0.0 {
                self.apply(Stimulus::MarkerMoved {
                    psm,
                    by_m: Some(by_m),
                });
            }
        }
    }

    fn act(&mut self, act: Act) {
        let now = self.bench.now();
        match act {
            Act::Do(stimulus) => self.apply(stimulus),
            Act::Supply(on) => {
                self.powered = on;
                self.bench.link.set_power(now, on);
                self.acts.push((now, act));
            }
            Act::Alternate(turns) => {
                self.acts.push((now, act));
                self.turns = Some(turns);
                self.turn_due = now;
            }
        }
    }

    fn turn(&mut self, now: Instant) {
        let Some(turns) = self.turns.as_mut().filter(|_| now >= self.turn_due) else {
            return;
        };
        turns.reverse();
        let (stimulus, stays) = turns[0];
        self.turn_due = now + stays;
        let refused = self.bench.rig.apply(now, &stimulus);
        refused.expect("any code and any position can be put in");
    }

    /// Contacts of the desk change all the time.
    fn chatters(&self) -> bool {
        self.turns
            .is_some_and(|turns| of_desk(turns) && turns[0].0 != turns[1].0)
    }

    /// Applies a stimulus; an impossible one is left out, as a bench refuses it.
    pub(super) fn apply(&mut self, stimulus: Stimulus) {
        let now = self.bench.now();
        // No train that moves comes to stand on a bench, or off it, in no time.
        if matches!(stimulus, Stimulus::TrainDriven { .. }) && self.observed().kmh() > MOVES_KMH {
            return;
        }
        if self.bench.rig.apply(now, &stimulus).is_err() {
            return;
        }
        match stimulus {
            Stimulus::Reverser { position } => self.reverser = position,
            Stimulus::Crosstalk(signal) => self.crosstalk = [signal.carrier_hz, signal.rate_hz],
            Stimulus::WheelDiameter { diameter_mm } => self.wheel = Some((diameter_mm, now)),
            Stimulus::Station(data) => self.told = data,
            Stimulus::Start => self.started = Some(now),
            Stimulus::Tcms(condition) => {
                self.tcms_good = condition == btu_rig::stimulus::TcmsCondition::Good;
            }
            Stimulus::TrainDriven { on } => self.driven = on,
            Stimulus::Tacho { .. } => self.tacho_made = true,
            Stimulus::Marker { .. } => self.pulsed += 1,
            _ => {}
        }
        self.turns = self.turns.filter(|turns| !ends(*turns, stimulus));
        self.acts.push((now, Act::Do(stimulus)));
    }

    /// No tachometer gives pulses.
    fn blind(&self) -> bool {
        let sample = self.bench.rig.sample();
        let dead = |signal| sample.get(signal) == Some(1.0);
        let unfed = |fault: &FaultMode| fault.place == Place::SpeedSensors;
        dead(Signal::Tacho1) && dead(Signal::Tacho2) || self.plan.faults.iter().any(unfed)
    }
}

/// Whether contacts of the desk alternate, and not codes.
fn of_desk(turns: [(Stimulus, Duration); 2]) -> bool {
    let [(one, _), _] = turns;
    matches!(one, Stimulus::ModeSwitch(_) | Stimulus::Reverser { .. })
}

/// A stimulus takes the place of two that alternate.
pub fn ends(turns: [(Stimulus, Duration); 2], stimulus: Stimulus) -> bool {
    match stimulus {
        Stimulus::Code { .. } | Stimulus::CodeOff | Stimulus::CodesAlong { .. } => !of_desk(turns),
        Stimulus::ModeSwitch(_) | Stimulus::Reverser { .. } => of_desk(turns),
        _ => false,
    }
}
