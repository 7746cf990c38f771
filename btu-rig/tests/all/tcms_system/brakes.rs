//! Emergency, holding, security and parking brake.

use btu_rig::lever::Lever;
use btu_rig::tcms::{EbSources, Lamps};
use btu_rig::train::{CarSet, TrainData};
use protocol::message::{AtcToTcmsBits, ModeSwitch, Outputs};

use super::bench::{Bench, order};

/// The emergency brake masks P, value and electric brake; cut out, it masks itself and nothing
/// else.
#[test]
fn the_emergency_brake_masks_power_and_value_unless_cut_out() {
    for lever in [Lever::Power(4), Lever::Brake(4)] {
        let mut bench = Bench::new();
        bench.speed_kmh(50.0);
        bench.lever(lever);
        bench.run(2000);
        assert_ne!(bench.view().driving.drytebe, 0);
        bench.inputs.cabs[1].emergency_button = true;
        let told = bench.run(3000);
        let view = bench.view();
        assert!(told.emergency && view.lamps.contains(Lamps::EMERGENCY));
        assert_eq!(view.driving.drytebe, 0);
        assert!(!view.driving.dryinp);
        assert_eq!(told.motor_n, [0.0; 12], "no effort of inverters");

        bench.inputs.eb_cut_out = true;
        let told = bench.run(3000);
        let view = bench.view();
        assert!(!told.emergency && !view.lamps.contains(Lamps::EMERGENCY));
        assert!(view.lamps.contains(Lamps::EB_CUT_OUT));
        assert_eq!(view.line.sources, EbSources::BUTTON_2);
        assert!(!view.line.energised, "read back as it is");
        assert_ne!(view.driving.drytebe, 0);
    }
}

#[test]
fn a_brake_that_lasts_at_low_speed_holds_until_one_motor_car_pulls() {
    let mut bench = Bench::new();
    bench.speed_kmh(1.9);
    bench.lever(Lever::Brake(1));
    bench.run(1000);
    assert!(!bench.view().holding);
    bench.run(100);
    assert!(bench.view().holding);
    bench.lever(Lever::Neutral);
    let told = bench.run(5000);
    assert!(
        bench.view().holding,
        "letting go of the lever releases nothing"
    );
    assert_eq!(told.demand, -0.7);
    bench.pulling = CarSet::NONE;
    bench.lever(Lever::Power(4));
    bench.run(2000);
    assert!(bench.view().holding, "no motor current");
    bench.pulling = CarSet::one(6);
    bench.run(2000);
    assert!(!bench.view().holding, "one motor car is enough");
}

#[test]
fn a_brake_at_speed_never_becomes_the_holding_brake() {
    let mut bench = Bench::new();
    bench.speed_kmh(2.1);
    bench.lever(Lever::Brake(4));
    bench.run(10_000);
    assert!(!bench.view().holding);
}

/// ATO asks for the holding brake by message or by contact; P is masked for as long.
#[test]
fn ato_asks_for_it_and_is_refused_power_meanwhile() {
    let asks = AtcToTcmsBits::POWER | AtcToTcmsBits::HOLDING_BRAKE;
    for by_contact in [false, true] {
        let mut bench = Bench::automatic(
            if by_contact {
                AtcToTcmsBits::POWER
            } else {
                asks
            },
            500,
        );
        if by_contact {
            bench.inputs.contacts = Some(Outputs::EB_RELAY | Outputs::HOLDING_BRAKE);
        }
        bench.run(2000);
        assert!(bench.view().holding && !bench.powers(), "{by_contact}");
        bench.inputs.contacts = Some(Outputs::EB_RELAY);
        bench.order = Some(order(AtcToTcmsBits::empty(), 0));
        bench.run(2000);
        assert!(bench.view().holding, "not asked, but nothing pulls");
        bench.order = Some(order(AtcToTcmsBits::POWER, 500));
        bench.run(2000);
        assert!(!bench.view().holding && bench.powers(), "{by_contact}");
    }
    // A brake of ATO's is no brake by hand, however long it lasts.
    let mut bench = Bench::automatic(AtcToTcmsBits::BRAKE, -500);
    bench.run(5000);
    assert!(!bench.view().holding);
}

#[test]
fn driverless_begins_held_and_turns_back_held() {
    let mut bench = Bench::automatic(AtcToTcmsBits::empty(), 0);
    bench.run(500);
    assert!(!bench.view().holding);
    bench.inputs.cabs[0].mode_switch = ModeSwitch::Driverless;
    bench.run(100);
    assert!(bench.view().holding, "initialisation");
    bench.order = Some(order(AtcToTcmsBits::POWER, 500));
    bench.run(2000);
    assert!(!bench.view().holding);
    bench.inputs.turn_back = true;
    bench.run(2000);
    assert!(bench.view().holding && !bench.powers());
}

/// The hard-wired brakes: lamps for as long as they are on, no electric brake with security.
#[test]
fn security_and_parking_brake_light_their_lamps() {
    let mut bench = Bench::new();
    bench.speed_kmh(50.0);
    bench.lever(Lever::Brake(5));
    bench.run(2000);
    bench.inputs.security_brake = true;
    let told = bench.run(1000);
    assert!(told.security && told.motor_n.iter().all(|n| *n == 0.0));
    assert!(bench.view().lamps.contains(Lamps::SECURITY));
    bench.inputs.security_brake = false;
    bench.inputs.parking_brake = true;
    let told = bench.run(1000);
    assert!(told.parking && !told.security);
    let lamps = bench.view().lamps;
    assert!(lamps.contains(Lamps::PARKING) && !lamps.contains(Lamps::SECURITY));
    bench.inputs.parking_brake = false;
    bench.run(10);
    assert!(bench.view().lamps.is_empty());
}

/// The point mass is driven by the same system, by what its own file says.
#[test]
fn the_point_mass_holds_with_its_own_share() {
    let TrainData::Ideal(mut data) = TrainData::ideal() else {
        panic!("a point mass");
    };
    data.holding_share = 0.4;
    let mut bench = Bench::of(&TrainData::Ideal(data));
    bench.lever(Lever::Brake(1));
    bench.run(2000);
    bench.lever(Lever::Neutral);
    assert_eq!(bench.run(10).demand, -0.4);
    bench.lever(Lever::Power(4));
    assert_eq!(bench.run(50).demand, 1.0);
    assert!(!bench.view().holding);
    bench.inputs.cabs[0].emergency_button = true;
    let told = bench.run(50);
    assert!(told.emergency && told.demand <= 0.0);
}
