//! A minute in which a driver, a track and a wayside that know no rule do things to a unit, with at most two faults.

mod acts;
mod antenna;

use btu_rig::lever::Lever;
use btu_rig::rig::Bench;
use btu_rig::stimulus::{StationData, Stimulus, WaysideCondition};
use protocol::injection::{FaultMode, Place};
use protocol::line::Section;
use protocol::message::ModeSwitch;
use protocol::signal::Signal;
use protocol::{Duration, Instant, Random};

use super::monitor::{Hazard, Monitor, Observed};
use crate::link::SimLink;
use crate::run::BenchSetup;

const MINUTE: Duration = Duration::from_ms(60_000);
/// The unit is powered up a second in, and starts up in three.
const STARTED_MS: u32 = 4_000;

/// Time in which the bench notices that the unit has restarted.
const HEARD_AGAIN: Duration = Duration::from_ms(2_000);

/// Time for which a start button that was pressed may begin a run.
const PRESSED: Duration = Duration::from_ms(800);

/// Time for which a wheel diameter that is keyed in may be taken: the bench keys it in for 300 ms.
const KEYED_IN: Duration = Duration::from_ms(600);

/// A hazard in a minute.
#[derive(Debug)]
pub struct Find {
    pub hazard: Hazard,
    pub at: Instant,
    /// No tachometer gave pulses then.
    pub blind: bool,
    /// What the monitor saw then.
    pub state: String,
    /// Faults that were injected, and those of tachometers that the bench made.
    pub faults: Vec<String>,
    /// What was done, in order.
    pub acts: Vec<String>,
}

/// One random minute.
pub struct Minute<'a> {
    bench: Bench<SimLink>,
    setup: &'a BenchSetup,
    random: Random,
    /// Faults that may still be made.
    budget: usize,
    faults: Vec<FaultMode>,
    scaled: bool,
    section: Section,
    station: StationData,
    reverser: i8,
    powered: bool,
    /// Codes that come by turns, each for its time; the present one first.
    flicker: Option<[(Stimulus, Duration); 2]>,
    flicker_due: Instant,
    /// When the start button was pressed last.
    started: Option<Instant>,
    /// Carrier and code rate of the neighbouring track, Hz.
    crosstalk: [f64; 2],
    /// Wheel diameter that was keyed in last, mm, and when.
    wheel: Option<(f64, Instant)>,
    /// TCMS's link is as the minute's faults have it.
    tcms_good: bool,
    acts: Vec<(Instant, String)>,
}

impl<'a> Minute<'a> {
    /// The minute of a seed: faults are drawn from `catalogue`.
    pub fn new(setup: &'a BenchSetup, catalogue: &[FaultMode], seed: u64) -> Self {
        let mut random = Random::new(seed);
        let budget = [0, 0, 1, 1, 2][random.below(5)];
        let injected = random.below(budget + 1);
        let faults: Vec<_> = (0..injected)
            .map(|_| catalogue[random.below(catalogue.len())].clone())
            .collect();
        let setup_of_minute = BenchSetup {
            faults: faults.clone(),
            ..setup.clone()
        };
        let section =
            setup.line.content.sections[random.below(setup.line.content.sections.len())].clone();
        let power_at = Instant::ZERO + Duration::from_ms(1_000);
        Self {
            bench: setup_of_minute.on_bench(seed, power_at),
            setup,
            budget: budget - injected,
            faults,
            scaled: false,
            station: StationData::at_departure(&section),
            section,
            random,
            reverser: 1,
            powered: true,
            flicker: None,
            flicker_due: Instant::ZERO,
            started: None,
            crosstalk: [0.0; 2],
            wheel: None,
            tcms_good: true,
            acts: Vec::new(),
        }
    }

    /// Plays it; the first hazard, if there was one.
    pub fn play(mut self) -> Option<Find> {
        let mut monitor = Monitor::new(&self.setup.config.content);
        self.tidy_begin();
        let end = self.bench.now() + MINUTE;
        let mut next_act = self.bench.now();
        let started = self.started_in();
        let mut seen_from = self.bench.now() + started;
        let mut found: Option<(Find, u32)> = None;
        while self.bench.now() < end {
            let now = self.bench.now();
            if now >= next_act {
                let wait_ms = [20, 200, 1_000, 3_000, 8_000][self.random.below(5)];
                next_act = now + Duration::from_ms(wait_ms);
                self.act();
            }
            self.turn_code(now);
            self.bench.tick().expect("the embedded unit answers");
            // Without TCMS nothing tells of motion that no tachometer sees.
            if !self.powered || self.blind() && !self.tcms_good {
                seen_from = now + started;
            }
            let rig = self.bench.rig();
            let truth = rig.truth();
            let observed = Observed {
                now,
                blind: self.blind(),
                powered: self.powered,
                sample: rig.sample(),
                speed_mps: truth.speed_mps,
                accel_mps2: truth.accel_mps2,
                to_stop_m: truth.to_stop_m,
                traction_n: truth.traction_n,
                reverser: self.reverser,
                start: self.started.is_some_and(|at| now.since(at) < PRESSED),
                crosstalk: self.crosstalk,
                wheel_mm: self
                    .wheel
                    .filter(|(_, at)| now.since(*at) < KEYED_IN)
                    .map(|(mm, _)| mm),
            };
            let restarts = rig.unit_restarts();
            let hazard = monitor.step(observed).filter(|_| now >= seen_from);
            if found.is_none() {
                found = hazard.map(|hazard| (self.found(hazard, observed), restarts));
            }
            // A unit that restarts is heard again only after a while: until then the bench has its last contacts.
            if let Some((find, before)) =
                found.take_if(|(find, _)| now.since(find.at) > HEARD_AGAIN)
            {
                if before == restarts {
                    return Some(find);
                }
                seen_from = now + started;
            }
        }
        None
    }

    /// Time in which it has started, and holds no code any more that the monitor has not seen.
    fn started_in(&self) -> Duration {
        let receiver = &self.setup.config.content.receiver;
        let held_ms = 2 * receiver.hold_ms + receiver.detect_ms + 500;
        Duration::from_ms(u64::from(held_ms.max(STARTED_MS)))
    }

    fn found(&self, hazard: Hazard, seen: Observed<'_>) -> Find {
        let mut faults: Vec<_> = self.faults.iter().map(|fault| fault.id.clone()).collect();
        if self.scaled {
            faults.push("speed_sensor_1.of_the_bench".to_owned());
        }
        Find {
            hazard,
            at: seen.now,
            blind: seen.blind,
            state: state(seen),
            faults,
            acts: self
                .acts
                .iter()
                .map(|(at, act)| format!("{:.2} s {act}", at.as_us() as f64 / 1e6))
                .collect(),
        }
    }

    /// How the minute begins: a train at a platform, on the track, or on the bench's own wheels.
    fn tidy_begin(&mut self) {
        let switch = [
            ModeSwitch::Manual,
            ModeSwitch::Automatic,
            ModeSwitch::Driverless,
            ModeSwitch::Yard,
        ][self.random.below(4)];
        let driven = self.random.unit() < 0.6;
        for stimulus in [
            Stimulus::Hcr { on: true },
            Stimulus::Reverser { position: 1 },
            Stimulus::Doors { closed: true },
            // Until the driver moves them.
            Stimulus::DoorsFollow { on: true },
            Stimulus::Controller {
                lever: Lever::Neutral,
            },
            Stimulus::ModeSwitch(switch),
            Stimulus::MarkersAlong {
                section: Some(self.section.section),
            },
            Stimulus::CodesAlong { on: true },
            Stimulus::Station(self.station),
            Stimulus::Wayside(WaysideCondition::Good),
            Stimulus::TrainDriven { on: driven },
        ] {
            self.apply(stimulus);
        }
        for _ in 0..400 {
            self.bench.tick().expect("the embedded unit answers");
        }
        self.apply(Stimulus::Acknowledge);
        for _ in 0..100 {
            self.bench.tick().expect("the embedded unit answers");
        }
        if self.chance(0.2) {
            self.key_in_wheels();
        }
    }

    /// What cannot be done is not done, as a bench refuses it.
    fn apply(&mut self, stimulus: Stimulus) {
        let now = self.bench.now();
        if self.bench.rig_mut().apply(now, &stimulus).is_ok() {
            match stimulus {
                Stimulus::Reverser { position } => self.reverser = position,
                Stimulus::Crosstalk {
                    carrier_hz,
                    rate_hz,
                    ..
                } => self.crosstalk = [carrier_hz, rate_hz],
                Stimulus::WheelDiameter { diameter_mm } => self.wheel = Some((diameter_mm, now)),
                _ => {}
            }
            self.acts.push((now, stimulus.to_string()));
        }
    }

    fn one_of<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.random.below(of.len())]
    }

    fn chance(&mut self, p: f64) -> bool {
        self.random.unit() < p
    }

    /// No tachometer gives pulses.
    fn blind(&self) -> bool {
        let sample = self.bench.rig().sample();
        let dead = |signal| sample.get(signal) == Some(1.0);
        let unfed = |fault: &FaultMode| fault.place == Place::SpeedSensors;
        dead(Signal::Tacho1) && dead(Signal::Tacho2) || self.faults.iter().any(unfed)
    }
}

fn state(seen: Observed<'_>) -> String {
    let signals = [
        Signal::Mode,
        Signal::Limit,
        Signal::Speed,
        Signal::Eb,
        Signal::EbCause,
        Signal::Fsb,
        Signal::FsbCause,
        Signal::Standstill,
        Signal::Aligned,
        Signal::Started,
    ];
    let values = signals.map(|signal| format!("{} {:?}", signal.name(), seen.sample.get(signal)));
    format!("{:.2} km/h, {}", seen.speed_mps * 3.6, values.join(", "))
}
