//! Failures of the equipment that TCMS finds, and their end.

use btu_rig::lever::Lever;
use btu_rig::tcms::{Lamps, PowerCuts};
use btu_rig::train::CarSet;
use protocol::event::Event;

use super::bench::Bench;

#[test]
fn an_inverter_that_does_not_answer_brakes_until_it_answers_or_is_cut_out() {
    let mut bench = Bench::new();
    bench.equipment.inverters_silent = CarSet::one(1);
    bench.run(490);
    assert!(!bench.full_service());
    bench.run(30);
    assert!(bench.full_service() && bench.view().lamps.contains(Lamps::FAILURE));
    // One word in between is no answer that counts.
    bench.equipment.inverters_silent = CarSet::NONE;
    bench.run(20);
    bench.equipment.inverters_silent = CarSet::one(1);
    bench.run(100);
    assert!(bench.full_service());
    bench.equipment.inverters_silent = CarSet::NONE;
    bench.run(600);
    assert!(!bench.full_service());
    bench.equipment.inverters_silent = CarSet::one(1);
    bench.run(600);
    bench.inputs.inverters_cut_out = CarSet::one(1);
    bench.run(10);
    assert!(!bench.full_service(), "cut out");
    assert_eq!(bench.events(), [Event::InverterFailed; 2]);
}

#[test]
fn a_brake_control_unit_that_does_not_answer_brakes_until_it_is_cut_out() {
    let mut bench = Bench::new();
    bench.equipment.brake_units_silent = CarSet::one(3);
    bench.run(600);
    assert!(bench.full_service());
    assert_eq!(bench.view().demands.air_n[3], 0.0, "nothing is asked of it");
    bench.inputs.brakes_cut_out = CarSet::one(3);
    bench.run(10);
    assert!(!bench.full_service());
    assert_eq!(bench.events(), [Event::BrakeUnitFailed]);
}

/// Found while braking, it stays through an emergency brake that hides it, and while it does not follow
/// a full demand.
#[test]
fn weak_cylinders_stay_found() {
    let mut bench = Bench::new();
    bench.weak = CarSet::one(3);
    bench.lever(Lever::Brake(7));
    bench.run(4000);
    assert_eq!(bench.view().found.cylinders, CarSet::one(3));
    bench.inputs.cabs[0].emergency_button = true;
    bench.run(5000);
    bench.inputs.cabs[0].emergency_button = false;
    bench.lever(Lever::Neutral);
    bench.run(5000);
    assert!(bench.full_service(), "it brakes by itself");
    assert_eq!(
        bench.events(),
        [Event::BrakeCylinderFailed],
        "reported once"
    );
    bench.weak = CarSet::NONE;
    bench.run(1900);
    assert!(bench.full_service());
    bench.run(200);
    assert!(!bench.full_service(), "repaired");
}

/// Asked only while nothing brakes; powering is cut, the driver and ATO are informed, the train brakes.
#[test]
fn a_brake_that_does_not_release_stops_the_train() {
    let mut bench = Bench::new();
    bench.speed_kmh(30.0);
    bench.stuck = CarSet::one(4);
    for (name, holds) in [
        ("braking", 0),
        ("security", 1),
        ("emergency", 2),
        ("parking", 3),
    ] {
        bench.lever(if holds == 0 {
            Lever::Brake(3)
        } else {
            Lever::Neutral
        });
        bench.inputs.security_brake = holds == 1;
        bench.inputs.cabs[0].emergency_button = holds == 2;
        bench.inputs.parking_brake = holds == 3;
        bench.run(8000);
        assert!(bench.view().found.not_released.is_empty(), "{name}");
    }
    bench.inputs.parking_brake = false;
    bench.lever(Lever::Power(4));
    bench.run(2900);
    assert!(bench.powers());
    let told = bench.run(200);
    let view = bench.view();
    assert_eq!(view.found.not_released, CarSet::one(4));
    assert!(view.power_cuts.contains(PowerCuts::NOT_RELEASED));
    assert!(view.lamps.contains(Lamps::NOT_RELEASED));
    assert_eq!(told.demand, -1.0);
    bench.lever(Lever::Neutral);
    bench.run(20_000);
    assert!(bench.full_service(), "its own brake does not hide it");
    assert_eq!(
        bench.events(),
        [Event::BrakeNotReleased],
        "nor does it come and go"
    );
}

#[test]
fn only_the_active_cab_releases_by_force() {
    let mut bench = Bench::new();
    bench.speed_kmh(30.0);
    bench.stuck = CarSet::one(4);
    bench.run(3500);
    assert!(bench.full_service());
    bench.inputs.cabs[1].forced_release = true;
    let told = bench.run(500);
    assert!(bench.full_service() && !told.forced_release);
    bench.inputs.cabs[1].forced_release = false;
    bench.inputs.cabs[0].forced_release = true;
    let told = bench.run(500);
    assert!(told.forced_release && !bench.full_service());
    let view = bench.view();
    assert!(view.power_cuts.is_empty() && view.found.not_released.is_empty());
    assert!(view.lamps.contains(Lamps::FORCED_RELEASE));
    // Let go while it still sticks, it is found again; cut out it no longer is.
    bench.inputs.cabs[0].forced_release = false;
    bench.run(6000);
    assert!(bench.full_service());
    bench.inputs.brakes_cut_out = CarSet::one(4);
    bench.run(10);
    assert!(!bench.full_service());
}

/// Braking and letting go asks again, with powering cut until the answer is there.
#[test]
fn braking_and_letting_go_asks_again() {
    let mut bench = Bench::new();
    bench.speed_kmh(30.0);
    bench.stuck = CarSet::one(4);
    bench.run(3500);
    bench.lever(Lever::Brake(2));
    bench.run(500);
    assert!(bench.full_service());
    bench.lever(Lever::Neutral);
    bench.run(500);
    assert!(!bench.full_service() && !bench.view().power_cuts.is_empty());
    bench.run(4000);
    assert!(bench.full_service(), "still not released");
    bench.lever(Lever::Brake(2));
    bench.run(500);
    bench.stuck = CarSet::NONE;
    bench.lever(Lever::Neutral);
    bench.run(4000);
    assert!(!bench.full_service() && bench.view().power_cuts.is_empty());
}
