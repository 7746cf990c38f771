//! Each condition that cuts powering, made alone (S3: effort 0; S4).

#![allow(
    clippy::print_stdout,
    reason = "figures, for whoever asks with --nocapture"
)]

use btu_rig::conditions::Conditions;
use btu_rig::lever::Lever;
use btu_rig::tcms::{PowerCuts, names_of};
use btu_rig::train::{CarSet, CarsData, Train, TrainData, TrainInputs};
use protocol::message::{ModeSwitch, Outputs};

use super::bench::Bench;

type Make = fn(&mut Bench);

/// Each condition, how it is made, and what it brings with it.
const CONDITIONS: [(&str, Make, &[&str]); 14] = [
    (
        "doors",
        |b| b.inputs.doors_closed = false,
        &["full_service"],
    ),
    (
        "hcr",
        |b| b.inputs.cabs[0].hcr = false,
        &["emergency", "mode"],
    ),
    ("reverser", |b| b.inputs.cabs[0].reverser = 0, &[]),
    (
        "emergency",
        |b| b.inputs.cabs[0].emergency_button = true,
        &[],
    ),
    (
        "full_service",
        |b| b.inputs.contacts = Some(Outputs::EB_RELAY | Outputs::FSB),
        &[],
    ),
    (
        "atc",
        |b| b.inputs.contacts = Some(Outputs::EB_RELAY | Outputs::POWER_CUT),
        &[],
    ),
    ("atc_silent", |b| b.inputs.contacts = None, &["emergency"]),
    (
        "holding",
        |b| b.inputs.contacts = Some(Outputs::EB_RELAY | Outputs::HOLDING_BRAKE),
        &[],
    ),
    ("security", |b| b.inputs.security_brake = true, &[]),
    ("parking", |b| b.inputs.parking_brake = true, &[]),
    (
        "not_released",
        |b| b.stuck = CarSet::one(0),
        &["full_service"],
    ),
    (
        "main_reservoir",
        |b| b.inputs.main_reservoir_low = true,
        &["emergency"],
    ),
    (
        "mode",
        |b| b.inputs.cabs[0].mode_switch = ModeSwitch::Off,
        &[],
    ),
    ("turn_back", |b| b.inputs.turn_back = true, &[]),
];

fn names(cuts: PowerCuts) -> Vec<String> {
    names_of::<PowerCuts>(cuts.bits())
}

/// Scans until powering is cut.
fn until_cut(bench: &mut Bench) -> u32 {
    for scans in 1..=400 {
        bench.run(10);
        if !bench.view().power_cuts.is_empty() {
            return scans;
        }
    }
    panic!("never");
}

/// Nothing but the inverters' own times stands between a cut and the end of traction: not the jerk
/// limit of powering.
#[test]
fn traction_goes_by_the_inverters_times_alone() {
    let cars = CarsData::line6();
    let within_s = cars.traction.dead_time_s + 5.0 * cars.traction.lag_s;
    let dead_man: Make = |b| b.inputs.cabs[0].dead_man = false;
    let full_brake: Make = |b| b.lever(Lever::Brake(7));
    let more = [("dead man", dead_man), ("B7", full_brake)];
    let alone = CONDITIONS.iter().map(|(name, make, _)| (*name, *make));
    for (name, make) in alone.chain(more) {
        let mut bench = Bench::new();
        let mut train = Train::new(&TrainData::line6(), &Conditions::default());
        let mut follow = |told: &TrainInputs| {
            train.step(0.005, told);
            train.step(0.005, told).traction_n
        };
        bench.lever(Lever::Power(4));
        let before_n = (0..200).fold(0.0, |_, _| follow(&bench.run(10)));
        assert!(before_n > 200e3, "{name}: {before_n}");
        make(&mut bench);
        until_cut(&mut bench);
        let mut seconds = 0.0;
        loop {
            // First what the cut's own scan told.
            let told = bench.run(if seconds == 0.0 { 0 } else { 10 });
            assert!(told.motor_n.iter().all(|n| *n <= 0.0), "{name}: {told:?}");
            seconds += 0.01;
            // Five time constants leave 0.7 %.
            if follow(&told) < 0.01 * before_n {
                break;
            }
            assert!(seconds <= within_s, "{name}: {seconds}");
        }
        println!("{name:<16} 1 % of traction after {seconds:.2} s of {within_s:.2}");
    }
}

#[test]
fn every_condition_alone_takes_power_off_and_gives_it_back() {
    let made: Vec<_> = CONDITIONS.iter().map(|(name, ..)| *name).collect();
    let all = names(PowerCuts::all());
    assert_eq!(made, all, "every one can be made");
    for (name, make, brings) in CONDITIONS {
        let mut bench = Bench::new();
        bench.lever(Lever::Power(4));
        bench.run(2000);
        assert!(bench.powers() && bench.view().power_cuts.is_empty());
        let sound = bench.inputs;

        make(&mut bench);
        let scans = until_cut(&mut bench);
        // A brake counts as not released when that has lasted.
        assert_eq!(scans > 1, name == "not_released", "{name}: {scans}");
        assert!(!bench.view().driving.dryinp, "{name}: at once");
        let told = bench.run(2000);
        assert!(!bench.powers() && told.demand <= 0.0, "{name}");
        let mut wanted: Vec<_> = all
            .iter()
            .filter(|cut| *cut == name || brings.contains(&cut.as_str()))
            .cloned()
            .collect();
        assert_eq!(names(bench.view().power_cuts), wanted, "{name}");
        wanted.clear();

        bench.inputs = sound;
        bench.stuck = CarSet::NONE;
        bench.inputs.cabs[0].forced_release = name == "not_released";
        bench.run(2500);
        assert_eq!(names(bench.view().power_cuts), wanted, "{name}");
        assert!(bench.powers(), "{name} is over");
    }
    println!(
        "{} conditions that cut powering, each alone",
        CONDITIONS.len()
    );
}
