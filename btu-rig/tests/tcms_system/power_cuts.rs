//! Each condition that cuts powering, made alone (S3: effort 0; S4).

use btu_rig::lever::Lever;
use btu_rig::tcms::PowerCuts;
use btu_rig::train::CarSet;
use protocol::message::{ModeSwitch, Outputs};

use crate::bench::Bench;

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
        |b| {
            b.stuck = CarSet::one(0);
            b.run(3500);
        },
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

fn names(cuts: PowerCuts) -> Vec<&'static str> {
    let all = PowerCuts::ALL.iter();
    all.filter(|(cut, _)| cuts.contains(*cut))
        .map(|(_, name)| *name)
        .collect()
}

#[test]
fn every_condition_alone_takes_power_off_and_gives_it_back() {
    let made: Vec<_> = CONDITIONS.iter().map(|(name, ..)| *name).collect();
    let all: Vec<_> = PowerCuts::ALL.iter().map(|(_, name)| *name).collect();
    assert_eq!(made, all, "every one can be made");
    for (name, make, brings) in CONDITIONS {
        let mut bench = Bench::new();
        bench.lever(Lever::Power(4));
        bench.run(2000);
        assert!(bench.powers() && bench.view().power_cuts.is_empty());
        let sound = bench.inputs;

        make(&mut bench);
        bench.run(10);
        assert!(!bench.view().driving.dryinp, "{name}: at once");
        let told = bench.run(2000);
        assert!(!bench.powers() && told.demand <= 0.0, "{name}");
        let mut wanted: Vec<_> = all
            .iter()
            .copied()
            .filter(|cut| *cut == name || brings.contains(cut))
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
