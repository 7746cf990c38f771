//! A minute in which a driver, a track and a wayside that know no rule do things to a unit, with at most two faults.

use btu_rig::lever::Lever;
use btu_rig::rig::{Bench, Random};
use btu_rig::stimulus::{
    OrderData, StationData, Stimulus, TachoCondition, TcmsCondition, TrainSwitch, WaysideCondition,
};
use protocol::injection::{FaultMode, Place};
use protocol::line::Section;
use protocol::message::{DoorSide, ModeSwitch, RunningMode, TrainOrder};
use protocol::signal::Signal;
use protocol::{Duration, Instant, Speed};

use super::monitor::{Hazard, Monitor, Observed};
use crate::link::SimLink;
use crate::run::BenchSetup;

const MINUTE: Duration = Duration::from_ms(60_000);
/// The unit is powered up a second in, and starts up in three.
const STARTED: Duration = Duration::from_ms(4_000);

/// Time in which the bench notices that the unit has restarted.
const HEARD_AGAIN: Duration = Duration::from_ms(2_000);

/// Time for which a start button that was pressed may begin a run.
const PRESSED: Duration = Duration::from_ms(800);

/// A hazard in a minute.
#[derive(Debug)]
pub struct Find {
    pub hazard: Hazard,
    pub at: Instant,
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
        let mut seen_from = self.bench.now() + STARTED;
        let mut found: Option<(Hazard, Instant, u32, String)> = None;
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
                seen_from = now + STARTED;
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
            };
            let restarts = rig.unit_restarts();
            let hazard = monitor.step(observed).filter(|_| now >= seen_from);
            if found.is_none() {
                found = hazard.map(|hazard| (hazard, now, restarts, state(observed)));
            }
            // A unit that restarts is heard again only after a while: until then the bench has its last contacts.
            if let Some((hazard, at, before, state)) =
                found.take_if(|found| now.since(found.1) > HEARD_AGAIN)
            {
                if before == restarts {
                    return Some(self.found(hazard, at, state));
                }
                seen_from = now + STARTED;
            }
        }
        None
    }

    fn found(self, hazard: Hazard, at: Instant, state: String) -> Find {
        let mut faults: Vec<_> = self.faults.iter().map(|fault| fault.id.clone()).collect();
        if self.scaled {
            faults.push("speed_sensor_1.of_the_bench".to_owned());
        }
        Find {
            hazard,
            at,
            state,
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
    }

    /// What cannot be done is not done, as a bench refuses it.
    fn apply(&mut self, stimulus: Stimulus) {
        let now = self.bench.now();
        if self.bench.rig_mut().apply(now, &stimulus).is_ok() {
            if let Stimulus::Reverser { position } = stimulus {
                self.reverser = position;
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

    fn act(&mut self) {
        let act = self.random.below(28);
        match act {
            0..=2 => self.change_code(),
            3 => {
                let to = Speed::from_kmh(85.0 * self.random.unit());
                let accel_mps2 = 0.2 + 1.2 * self.random.unit();
                self.apply(Stimulus::Speed { to, accel_mps2 });
            }
            4 => {
                let to = Speed::from_kmh(6.0 * self.random.unit());
                self.apply(Stimulus::Speed {
                    to,
                    accel_mps2: 0.8,
                });
            }
            5..=7 => {
                let lever = self.one_of(&Lever::ALL);
                self.apply(Stimulus::Controller { lever });
            }
            8 => {
                let closed = self.chance(0.6);
                self.apply(Stimulus::Doors { closed });
            }
            9 => {
                let switch = self.one_of(&[
                    ModeSwitch::Off,
                    ModeSwitch::Yard,
                    ModeSwitch::Manual,
                    ModeSwitch::Manual,
                    ModeSwitch::Automatic,
                    ModeSwitch::Automatic,
                    ModeSwitch::Driverless,
                    ModeSwitch::Emergency,
                ]);
                self.apply(Stimulus::ModeSwitch(switch));
            }
            10 | 11 => self.change_station(),
            12 => {
                self.started = Some(self.bench.now());
                self.apply(Stimulus::Start);
            }
            13 | 14 => self.apply(Stimulus::Acknowledge),
            15 => self.change_wayside(),
            16 => self.change_tachometer(),
            17 => {
                let psm = 1 + self.random.below(4) as u8;
                self.apply(Stimulus::Marker { psm });
            }
            18 => {
                let permille = self.chance(0.7).then(|| 70.0 * (self.random.unit() - 0.5));
                self.apply(Stimulus::Gradient { permille });
            }
            19 => {
                let position = self.one_of(&[1, 1, 0, -1]);
                self.apply(Stimulus::Reverser { position });
            }
            20 => {
                let backward = self.chance(0.5);
                self.apply(Stimulus::Direction { backward });
            }
            21 => self.change_cab(),
            22 => {
                let on = self.chance(0.6);
                self.apply(Stimulus::TrainDriven { on });
            }
            23 => self.change_power(),
            24 | 25 => self.let_code_flicker(),
            26 => self.open_line(),
            _ => self.give_order(),
        }
    }

    fn change_code(&mut self) {
        self.flicker = None;
        if self.chance(0.4) {
            return self.apply(Stimulus::CodesAlong { on: true });
        }
        let code = self.any_code();
        self.apply(code);
    }

    /// Two codes by turns, or one and none, that stay from 10 ms to a second.
    fn let_code_flicker(&mut self) {
        let mut one = || {
            let ms = self.one_of(&[10, 20, 50, 100, 200, 380, 450, 900]);
            (self.any_code(), Duration::from_ms(ms))
        };
        let turns = [one(), one()];
        let [(first, _), (second, _)] = turns;
        let now = self.bench.now();
        self.acts.push((
            now,
            format!(
                "{first} and {second} by turns, {:?} and {:?}",
                turns[0].1, turns[1].1
            ),
        ));
        self.flicker = Some(turns);
        self.flicker_due = now;
    }

    fn turn_code(&mut self, now: Instant) {
        let Some(turns) = self.flicker.as_mut().filter(|_| now >= self.flicker_due) else {
            return;
        };
        turns.reverse();
        let (code, stays) = turns[0];
        self.flicker_due = now + stays;
        let refused = self.bench.rig_mut().apply(now, &code);
        refused.expect("any code can be put in");
    }

    fn any_code(&mut self) -> Stimulus {
        let config = &self.setup.config.content;
        let code = config.codes[self.random.below(config.codes.len())].clone();
        let level_mv = config.receiver.level_nominal_mv;
        let signal = |rate_hz| Stimulus::Code {
            carrier_hz: code.carrier_hz,
            rate_hz,
            level_mv,
        };
        match self.random.below(8) {
            0 => Stimulus::CodeOff,
            1 => signal(0.0),
            _ => signal(code.rate_hz),
        }
    }

    /// Somebody else than the unit opens the emergency brake line, or lets it close again.
    fn open_line(&mut self) {
        let switch = self.one_of(&[
            TrainSwitch::Button1,
            TrainSwitch::Button2,
            TrainSwitch::MainReservoirLow,
        ]);
        let on = self.chance(0.4);
        for switch in [
            TrainSwitch::Button1,
            TrainSwitch::Button2,
            TrainSwitch::MainReservoirLow,
        ] {
            self.apply(Stimulus::Switch { switch, on: false });
        }
        if on {
            self.apply(Stimulus::Switch { switch, on });
        }
    }

    /// The wayside puts the train away, wakes it, or orders nothing.
    fn give_order(&mut self) {
        let order = self.one_of(&[
            TrainOrder::PutAway,
            TrainOrder::WakeUp,
            TrainOrder::WakeUp,
            TrainOrder::None,
        ]);
        let orders = OrderData::of_section(order, None, 0.0);
        self.apply(Stimulus::Orders(Some(orders)));
    }

    /// No tachometer gives pulses.
    fn blind(&self) -> bool {
        let sample = self.bench.rig().sample();
        let dead = |signal| sample.get(signal) == Some(1.0);
        let unfed = |fault: &FaultMode| fault.place == Place::SpeedSensors;
        dead(Signal::Tacho1) && dead(Signal::Tacho2) || self.faults.iter().any(unfed)
    }

    fn change_station(&mut self) {
        let line = &self.setup.line.content;
        let mut station = match self.chance(0.5) {
            true => StationData::at_departure(&self.section),
            false => {
                let after = line.after(&self.section);
                StationData::at_arrival(&self.section, after.map_or(0, |next| next.to_station))
            }
        };
        station.departure = self.chance(0.6);
        if self.chance(0.2) {
            station.door_side = self.one_of(&[
                DoorSide::None,
                DoorSide::Left,
                DoorSide::Right,
                DoorSide::Both,
            ]);
        }
        if self.chance(0.1) {
            let section = &line.sections[self.random.below(line.sections.len())];
            station = StationData::at_departure(section);
        }
        if self.chance(0.2) {
            station.running_mode = match station.departure {
                true => RunningMode::Slow,
                false => RunningMode::Recovery,
            };
        }
        self.station = station;
        self.apply(Stimulus::Station(station));
    }

    fn change_wayside(&mut self) {
        let wayside = self.one_of(&[
            WaysideCondition::Silent,
            WaysideCondition::Good,
            WaysideCondition::Good,
            WaysideCondition::Corrupt,
        ]);
        self.apply(Stimulus::Wayside(wayside));
        let tcms = self.one_of(&[
            TcmsCondition::Good,
            TcmsCondition::Good,
            TcmsCondition::Silent,
            TcmsCondition::Stale,
        ]);
        self.tcms_good = tcms == TcmsCondition::Good;
        self.apply(Stimulus::Tcms(tcms));
        let on = self.chance(0.8);
        self.apply(Stimulus::AtoEnable { on });
    }

    /// A fault of the first tachometer, or both die at once; and its repair.
    fn change_tachometer(&mut self) {
        let good = self.chance(0.3);
        let condition = match self.random.below(4) {
            _ if good => TachoCondition::Good,
            0 | 1 => TachoCondition::Dead,
            2 => TachoCondition::Noisy { per_s: 50.0 },
            _ => TachoCondition::Scaled {
                factor: 0.8 + 0.4 * self.random.unit(),
            },
        };
        let both = good || condition == TachoCondition::Dead && self.chance(0.5);
        if !good && !self.scaled {
            if self.budget == 0 {
                return;
            }
            self.budget -= 1;
            self.scaled = true;
        }
        for channel in 1..=1 + u8::from(both) {
            self.apply(Stimulus::Tacho { channel, condition });
        }
    }

    fn change_cab(&mut self) {
        let on = self.chance(0.8);
        self.apply(Stimulus::Hcr { on });
        let passengers_kg = 1e5 * self.random.unit();
        self.apply(Stimulus::Load { passengers_kg });
    }

    /// The supply fails, or comes back.
    fn change_power(&mut self) {
        self.powered = !self.powered || self.chance(0.7);
        let (now, on) = (self.bench.now(), self.powered);
        self.bench.link_mut().set_power(now, on);
        self.acts.push((now, format!("supply {on}")));
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
