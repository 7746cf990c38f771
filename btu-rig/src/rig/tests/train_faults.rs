//! Faults of the train act at their place from their onset on, and nothing on the bench removes them.

use protocol::injection::{FaultCatalogue, FaultMode, Occurrence};
use protocol::message::{AtcToTcms, AtcToTcmsBits, ModeSwitch, Outputs};
use protocol::signal::Signal;
use protocol::{Duration, Instant, Speed};

use super::{FakeUnit, bench, order};
use crate::rig::train_side::TrainFaults;
use crate::rig::{Bench, Misplaced, check_places};
use crate::stimulus::{CodeSignal, Stimulus, TrainSwitch, WaysideCondition};
use crate::tcms::EbSources;
use crate::train::{CarSet, Equipment, TrainData};

/// When the faults of these tests set in after power-up, s.
const ONSET_S: f64 = 20.0;
/// When the unit is powered up on these benches.
const POWER_AT: Instant = Instant::from_ms(5_000);

fn catalogue() -> FaultCatalogue {
    FaultCatalogue::from_toml(include_str!("../../../../scripts/units/faults.toml")).unwrap()
}

fn mode(id: &str) -> FaultMode {
    let catalogue = catalogue();
    let mode = catalogue.fault(id).expect(id).clone();
    FaultMode {
        onset_s: ONSET_S,
        occurs: Occurrence::Always,
        ..mode
    }
}

/// The train stands braked by ATO with full service, then released: its equipment at either time.
fn braked_and_released(bench: &mut Bench<FakeUnit>) -> [Equipment; 2] {
    bench.apply(Stimulus::ModeSwitch(ModeSwitch::Automatic));
    bench.apply(Stimulus::TrainDriven { on: true });
    [(AtcToTcmsBits::BRAKE, -1024), (AtcToTcmsBits::empty(), 0)].map(|(bits, effort)| {
        bench.link.to_tcms = order(bits, effort);
        bench.run_ms(2_500);
        bench.rig.train.equipment()
    })
}

/// Air of a car when braked, over that of the car it is like.
fn air_share(equipment: &Equipment, car: usize, like: usize) -> f64 {
    equipment.air_n[car - 1] / equipment.air_n[like - 1]
}

/// Tells whether a fault shows now.
type Shows = fn(&mut Bench<FakeUnit>) -> bool;

const CASES: [(&str, Shows); 30] = [
    ("inverter.dead", |bench| inverter_silent(bench, 2)),
    ("inverter.regeneration_lost", |bench| {
        let [_, released] = braked_and_released(bench);
        released.regeneration_cut_out == CarSet::one(2)
    }),
    ("inverter.weak", |bench| {
        (0.65..0.75).contains(&traction_share(bench, 6, 2))
    }),
    ("inverter.trips_when_warm", |bench| {
        inverter_silent(bench, 7)
    }),
    ("brake_unit.dead", |bench| brake_unit_silent(bench, 4)),
    ("brake_unit.drops_out", |bench| brake_unit_silent(bench, 8)),
    ("brake_cylinder.not_releasing", |bench| {
        keeps_its_air(bench, 1, 8)
    }),
    ("brake_cylinder.weak", |bench| {
        let [braked, _] = braked_and_released(bench);
        (0.45..0.55).contains(&air_share(&braked, 5, 4))
    }),
    ("brake_cylinder.sticks", |bench| keeps_its_air(bench, 4, 5)),
    ("master_controller.pot_low", |bench| {
        bench.value(Signal::ControllerVolts) == 0.0
    }),
    ("master_controller.pot_high", |bench| {
        bench.value(Signal::ControllerVolts) == 10.0
    }),
    ("master_controller.pot_drifts", |bench| {
        let [_, low, high, _] = bench.rig.tcms.data.controller_v;
        (bench.value(Signal::ControllerVolts) - (low + high) / 2.0 - 0.3).abs() < 0.01
    }),
    ("master_controller.pot_drops_out", |bench| {
        bench.value(Signal::ControllerVolts) == 0.0
    }),
    ("door_contact.open", doors_say_open),
    ("door_contact.chatters", |bench| {
        (0..100).any(|_| {
            bench.run_ms(10);
            doors_say_open(bench)
        })
    }),
    ("door_contact.bridged", |bench| {
        bench.apply(Stimulus::Doors { closed: false });
        bench.run_ms(20);
        bench.value(Signal::Doors) == 1.0
    }),
    ("door_contact.loose", doors_say_open),
    ("door_contact.loose_at_speed", doors_say_open),
    ("door_contact.left_open", |bench| {
        bench.value(Signal::DoorsLeft) == 0.0 && bench.value(Signal::DoorsRight) == 2.0
    }),
    ("door_contact.right_bridged", |bench| {
        bench.apply(Stimulus::Doors { closed: false });
        bench.run_ms(20);
        bench.value(Signal::DoorsRight) == 1.0
    }),
    ("head_control_relay.dead", relay_is_down),
    ("head_control_relay.stuck", |bench| {
        bench.apply(Stimulus::Hcr { on: false });
        bench.run_ms(20);
        bench.value(Signal::Hcr) == 1.0
    }),
    ("head_control_relay.drops_out", relay_is_down),
    ("tcms.silent", tcms_is_silent),
    ("tcms.stale", |bench| bench.value(Signal::TcmsAlive) == 0.0),
    ("tcms.hangs", tcms_is_silent),
    ("tcms.keeps_cab", |bench| {
        bench.apply(Stimulus::Hcr { on: true });
        bench.link.to_tcms.bits = AtcToTcmsBits::CHANGE_OF_CABS;
        bench.run_ms(200);
        bench.value(Signal::Hcr) == 1.0
    }),
    ("air_supply.low", reservoir_is_low),
    ("air_supply.leak", reservoir_is_low),
    ("air_supply.switch_dead", |bench| {
        bench.apply(Stimulus::Switch {
            switch: TrainSwitch::MainReservoirLow,
            on: true,
        });
        bench.run_ms(40);
        !reservoir_is_low(bench)
    }),
];

/// Traction of a car on departure, over that of the car it is like.
fn traction_share(bench: &mut Bench<FakeUnit>, car: usize, like: usize) -> f64 {
    bench.apply(Stimulus::ModeSwitch(ModeSwitch::Automatic));
    bench.apply(Stimulus::TrainDriven { on: true });
    bench.link.to_tcms = order(AtcToTcmsBits::POWER, 1023);
    bench.run_ms(1_500);
    let given = bench.rig.train.equipment().traction_n;
    given[car - 1] / given[like - 1]
}

fn inverter_silent(bench: &mut Bench<FakeUnit>, car: usize) -> bool {
    braked_and_released(bench);
    bench.rig.tcms.view.found.inverters == CarSet::one(car - 1)
}

fn brake_unit_silent(bench: &mut Bench<FakeUnit>, car: usize) -> bool {
    let [braked, _] = braked_and_released(bench);
    let found = bench.rig.tcms.view.found.brake_units;
    braked.air_n[car - 1] == 0.0 && found == CarSet::one(car - 1)
}

fn keeps_its_air(bench: &mut Bench<FakeUnit>, car: usize, like: usize) -> bool {
    let [braked, released] = braked_and_released(bench);
    let kept = |car: usize| released.air_n[car - 1] / braked.air_n[car - 1];
    kept(car) >= 1.0 && kept(like) < 0.5
}

fn doors_say_open(bench: &mut Bench<FakeUnit>) -> bool {
    bench.value(Signal::Doors) == 0.0
}

fn relay_is_down(bench: &mut Bench<FakeUnit>) -> bool {
    bench.value(Signal::Hcr) == 0.0
}

fn tcms_is_silent(bench: &mut Bench<FakeUnit>) -> bool {
    bench.value(Signal::TcmsAlive) == 0.0 && bench.value(Signal::TcmsHears) == 1.0
}

fn reservoir_is_low(bench: &mut Bench<FakeUnit>) -> bool {
    let sources = bench.rig.tcms.view.line.sources;
    sources.contains(EbSources::MAIN_RESERVOIR)
}

fn make_safe(bench: &mut Bench<FakeUnit>) {
    bench.make_safe();
    bench.link.to_tcms = AtcToTcms::default();
    bench.run_ms(3_000);
    assert!(bench.rig.safe());
}

#[test]
fn every_fault_of_the_train_acts_at_its_place_and_nothing_removes_it() {
    for (id, shows) in CASES {
        let mut bench = bench(FakeUnit::default());
        bench.rig.inject(&[mode(id)], POWER_AT);
        bench.run_ms(5_000);
        assert!(!shows(&mut bench), "{id} before its onset");
        make_safe(&mut bench);
        let onset = POWER_AT + Duration::from_secs(ONSET_S);
        bench.run_ms(onset.since(bench.now()).as_ms() - 20);
        assert_eq!(bench.rig.faults, TrainFaults::default(), "{id}: too early");
        bench.run_ms(1_000);
        assert!(shows(&mut bench), "{id} after its onset");
        make_safe(&mut bench);
        assert!(shows(&mut bench), "{id} after making safe");
        make_safe(&mut bench);
        bench.rig.set_train(TrainData::line6());
        bench.run_ms(1_000);
        assert!(shows(&mut bench), "{id} with a new train");
    }
}

#[test]
fn the_table_has_every_fault_of_the_train() {
    let catalogue = catalogue();
    let on_train = catalogue.faults.iter().filter(|f| f.place.on_train());
    let ids: Vec<_> = on_train.map(|fault| fault.id.as_str()).collect();
    assert_eq!(ids, CASES.map(|(id, _)| id));
    let faults: Vec<_> = catalogue.faults.clone();
    assert_eq!(check_places(&faults, &TrainData::line6()), Ok(()));
}

/// The catalogue says how weak a cylinder is, and two cylinders can be weak by different shares.
#[test]
fn a_weak_cylinder_gets_the_share_of_its_own_mode() {
    let text = include_str!("../../../../scripts/units/faults.toml");
    let weaker = text.replace("factor = 0.5", "factor = 0.2");
    let weaker = FaultCatalogue::from_toml(&weaker).unwrap();
    let on_car_4 = FaultMode {
        car: Some(4),
        ..weaker.fault("brake_cylinder.weak").unwrap().clone()
    };
    let mut bench = bench(FakeUnit::default());
    let on_car_5 = FaultMode {
        onset_s: 0.0,
        ..mode("brake_cylinder.weak")
    };
    bench.rig.inject(&[on_car_5, on_car_4], Instant::ZERO);
    let [braked, _] = braked_and_released(&mut bench);
    let shares = [4, 5].map(|car| air_share(&braked, car, 1));
    assert!(
        (0.35..0.45).contains(&(shares[0] / shares[1])),
        "{shares:?}"
    );
}

#[test]
fn a_train_without_the_place_is_refused() {
    let train = TrainData::line6();
    let moved = |id: &str, car| FaultMode {
        car: Some(car),
        ..mode(id)
    };
    let refused = |mode: FaultMode, train: &TrainData| check_places(&[mode], train).unwrap_err();
    let fault = "inverter.dead".to_owned();
    assert_eq!(
        refused(moved("inverter.dead", 9), &train),
        Misplaced::NoSuchCar {
            fault: fault.clone(),
            car: 9,
            cars: 8
        }
    );
    assert_eq!(
        refused(moved("inverter.dead", 1), &train),
        Misplaced::Trailer {
            fault: fault.clone(),
            car: 1
        }
    );
    let text = include_str!("../../../../scripts/trains/ideal.toml");
    let ideal = TrainData::from_toml(text).unwrap();
    assert_eq!(
        refused(mode("inverter.dead"), &ideal),
        Misplaced::PointMass { fault }
    );
    assert_eq!(check_places(&[mode("door_contact.open")], &ideal), Ok(()));
}

/// Bytes that a bench sent, contacts of the unit that it read, and levels that it recorded as asked
/// for.
fn played(fault: Option<FaultMode>) -> (Vec<u8>, Vec<Option<f64>>, Vec<Option<f64>>) {
    let mut bench = bench(FakeUnit::default());
    bench.apply(Stimulus::Wayside(WaysideCondition::Good));
    bench.apply(Stimulus::Hcr { on: true });
    bench.apply(Stimulus::Code(CodeSignal::new(3_000.0, 15.0, 500.0)));
    bench.apply(Stimulus::Speed {
        to: Speed::from_kmh(30.0),
        accel_mps2: 2.0,
    });
    let modes: Vec<_> = fault.into_iter().collect();
    bench.rig.inject(&modes, Instant::ZERO);
    let all = [Outputs::EB_RELAY, Outputs::FSB, Outputs::DOOR_ENABLE_LEFT];
    let (mut read, mut asked) = (Vec::new(), Vec::new());
    for outputs in [Outputs::empty(), all.into_iter().collect()] {
        bench.link.outputs = outputs;
        bench.apply(Stimulus::Marker { psm: 1 });
        bench.run_ms(1_000);
        let sample = bench.rig.sample();
        let values = |signals: &[Signal]| {
            signals
                .iter()
                .map(|signal| sample.get(*signal))
                .collect::<Vec<_>>()
        };
        read.extend(values(&[Signal::Eb, Signal::Fsb, Signal::DoorEnableLeft]));
        asked.extend(values(&[
            Signal::CarrierHz,
            Signal::CodeRateHz,
            Signal::LevelMv,
            Signal::TrainSpeed,
            Signal::MarkerCoil,
            Signal::Wayside,
            Signal::Doors,
            Signal::Hcr,
        ]));
    }
    (std::mem::take(&mut bench.link.all_bytes), read, asked)
}

/// Goal: a fault of the bench acts, and the bench does not know of it. Method: each mode of the catalogue at each of its
/// levels against a sound bench: what is sent or what is read differs, what was asked for is recorded alike.
#[test]
fn a_fault_of_the_bench_changes_what_is_sent_or_read_and_not_what_is_recorded_of_it() {
    let sound = played(None);
    assert_eq!(sound, played(None));
    let catalogue = catalogue();
    let of_bench = catalogue.faults.iter().filter(|mode| mode.place.on_bench());
    let levels = of_bench.flat_map(|mode| (0..).map_while(|level| mode.at_level(level)));
    let levels: Vec<_> = levels.collect();
    assert!(levels.len() >= 20);
    for mode in levels {
        let (id, effect) = (mode.id.clone(), mode.effect);
        let faulty = played(Some(mode));
        assert!(
            (&faulty.0, &faulty.1) != (&sound.0, &sound.1),
            "{id} {effect:?}"
        );
        assert_eq!(faulty.2, sound.2, "{id} {effect:?}");
    }
}
