//! Jogging to a stop point that was missed: the unit, TCMS and the train of cars, with every controller.

use btu_rig::rig::Bench;
use btu_rig::stimulus::{CodeSignal, StationData, Stimulus, WaysideCondition};
use protocol::config::ControllerKind;
use protocol::line::Gradient;
use protocol::message::{AtoState, Mode, ModeSwitch, Refusals};
use protocol::signal::Signal;
use protocol::{Duration, Instant, Speed};

use crate::link::SimLink;
use crate::run::BenchSetup;
use crate::test_support;

/// Passengers of a full train, kg.
const FULL_KG: f64 = 160_000.0;
/// Tolerance of the unit's position, m: a few pulses.
const POSITION_M: f64 = 0.06;
/// From the section's start to its stop point, m: more than the train is long.
const WAY_M: f64 = 200.0;

fn setup(controller: ControllerKind, permille: f64) -> BenchSetup {
    let mut setup = test_support::setup(&[]);
    setup.config.content.ato.controller = controller;
    // A short way to the stop point, with the whole train on the gradient.
    let section = &mut setup.line.content.sections[0];
    section.length_m = WAY_M;
    section.stop_m = section.start_m + WAY_M;
    section.markers_m = [150.0, 100.0, 20.0, 3.5].map(|m| section.stop_m - m);
    section.gradients = vec![Gradient {
        at_m: section.start_m,
        permille,
    }];
    section.curves.clear();
    setup.line.content.sections.truncate(1);
    setup
}

struct Stop {
    bench: Bench<SimLink>,
    station: StationData,
    backward: bool,
}

#[derive(Debug)]
struct Recovery {
    tries: u32,
    fastest_kmh: f64,
    error_m: f64,
    aligned: bool,
    braked: bool,
}

impl Stop {
    /// A train that the bench has brought to its stop point.
    fn new(setup: &BenchSetup, load_kg: f64) -> Self {
        let section = setup.line.content.sections[0].clone();
        let mut stop = Self {
            bench: setup.on_bench(1, Instant::ZERO),
            station: StationData::at_arrival(&section, 0),
            backward: false,
        };
        let code = setup
            .config
            .content
            .codes
            .iter()
            .find(|code| code.limit_kmh > 70.0)
            .expect("a running code");
        for stimulus in [
            Stimulus::Hcr { on: true },
            Stimulus::Reverser { position: 1 },
            Stimulus::Doors { closed: true },
            Stimulus::ModeSwitch(ModeSwitch::Manual),
            Stimulus::Load {
                passengers_kg: load_kg,
            },
            Stimulus::Code(CodeSignal::new(code.carrier_hz, code.rate_hz, 500.0)),
            Stimulus::Station(StationData::at_departure(&section)),
            Stimulus::Wayside(WaysideCondition::Good),
        ] {
            stop.apply(stimulus);
        }
        stop.run(4_000);
        stop.apply(Stimulus::Acknowledge);
        stop.run(1_000);
        stop.apply(Stimulus::MarkersAlong {
            section: Some(section.section),
        });
        stop.apply(Stimulus::Station(stop.station));
        stop.run(1_000);
        stop.travel(WAY_M, 60.0);
        stop
    }

    fn apply(&mut self, stimulus: Stimulus) {
        let now = self.bench.now();
        let done = self.bench.rig.apply(now, &stimulus);
        done.unwrap_or_else(|refusal| panic!("{stimulus}: {refusal:?}"));
    }

    fn run(&mut self, ms: u64) {
        for _ in 0..ms / 10 {
            self.bench.tick().expect("the embedded unit answers");
        }
    }

    fn is(&self, signal: Signal, code: u8) -> bool {
        self.bench.rig.sample().get(signal) == Some(f64::from(code))
    }

    /// The bench turns the wheels by so many metres.
    fn travel(&mut self, by_m: f64, kmh: f64) {
        self.apply(Stimulus::TrainDriven { on: false });
        let backward = by_m < 0.0;
        // Backward no code lets a train run.
        self.apply(Stimulus::ModeSwitch(match backward {
            true => ModeSwitch::Yard,
            false => ModeSwitch::Manual,
        }));
        self.run(500);
        if backward != self.backward {
            self.backward = backward;
            let position = if backward { -1 } else { 1 };
            self.apply(Stimulus::Reverser { position });
            self.apply(Stimulus::Direction { backward });
        }
        self.apply(Stimulus::Travel {
            distance_m: by_m.abs(),
            speed: Speed::from_kmh(kmh),
            accel_mps2: 0.8,
        });
        let seconds = by_m.abs() / kmh * 3.6 + kmh / 3.6 / 0.8;
        self.run((seconds * 1000.0) as u64 + 1_500);
    }

    /// From this far past the stop point, or before it where negative.
    fn recover(&mut self, from_m: f64, switch: ModeSwitch) -> Recovery {
        let to_stop_m = self.bench.rig.truth().to_stop_m.expect("a section");
        self.travel(from_m + to_stop_m, 6.0);
        if self.backward {
            self.backward = false;
            self.apply(Stimulus::Reverser { position: 1 });
            self.apply(Stimulus::Direction { backward: false });
        }
        let departure = |departure| {
            Stimulus::Station(StationData {
                departure,
                ..self.station
            })
        };
        let (held, departs) = (departure(false), departure(true));
        self.apply(held);
        self.apply(Stimulus::ModeSwitch(switch));
        self.run(1_000);
        let sample = self.bench.rig.sample();
        let refusals = sample.get(Signal::Refusals);
        assert_eq!(refusals, Some(f64::from(Refusals::NO_DEPARTURE.bits())));
        // The holding brake has the train before it is on the gradient.
        self.apply(Stimulus::TrainDriven { on: true });
        self.run(500);
        self.apply(departs);
        self.run(500);
        if switch == ModeSwitch::Automatic {
            self.apply(Stimulus::Start);
        }
        self.watch()
    }

    /// Watches the train until the run is over.
    fn watch(&mut self) -> Recovery {
        let mut seen = Recovery {
            tries: 0,
            fastest_kmh: 0.0,
            error_m: f64::NAN,
            aligned: false,
            braked: false,
        };
        let (mut runs, mut stands) = (false, Duration::ZERO);
        for _ in 0..9_000 {
            self.bench.tick().expect("the embedded unit answers");
            let kmh = self.bench.rig.truth().speed_mps.abs() * 3.6;
            if kmh == 0.0 {
                stands += protocol::SCAN;
            } else {
                seen.tries += u32::from(stands >= Duration::from_ms(500));
                stands = Duration::ZERO;
            }
            seen.fastest_kmh = seen.fastest_kmh.max(kmh);
            seen.braked |= self.is(Signal::Eb, 1);
            let run = self.is(Signal::Mode, Mode::AutomaticRun.code());
            if runs && !run && self.is(Signal::AtoState, AtoState::Stop.code()) {
                seen.aligned = self.is(Signal::Aligned, 1);
                seen.error_m = -self.bench.rig.truth().to_stop_m.expect("a section");
                return seen;
            }
            runs |= run;
        }
        panic!("no end: {seen:?}");
    }
}

/// Overruns and short stops with the empty and the full train, on the level and on 35 ‰ both ways, in automatic and
/// driverless mode: within 30 cm after three tries at most, never above 5 km/h.
#[test]
fn every_controller_recovers_from_a_missed_stop_point() {
    let places_m = [0.6, -0.6, 1.0, -1.0, 2.5, -2.5, 4.0, -4.0];
    for controller in ControllerKind::ALL {
        for permille in [-35.0, 0.0, 35.0] {
            for load_kg in [0.0, FULL_KG] {
                let mut stop = Stop::new(&setup(controller, permille), load_kg);
                for (number, from_m) in places_m.into_iter().enumerate() {
                    let switch = match number % 4 {
                        0 | 3 => ModeSwitch::Automatic,
                        _ => ModeSwitch::Driverless,
                    };
                    let seen = stop.recover(from_m, switch);
                    let good = seen.aligned
                        && seen.error_m.abs() <= 0.3 + POSITION_M
                        && (1..=3).contains(&seen.tries)
                        && seen.fastest_kmh <= 5.0
                        && !seen.braked;
                    assert!(
                        good,
                        "{controller:?}, {permille} ‰, {load_kg} kg, from {from_m} m: {seen:?}"
                    );
                }
            }
        }
    }
}
