//! The cab that counts, its modes and its dead man.

use btu_rig::lever::Lever;
use btu_rig::tcms::{EbSources, Lamps, PowerCuts, TcmsMode};
use protocol::event::Event;
use protocol::message::{AtcToTcmsBits, ModeSwitch};

use super::bench::Bench;

#[test]
fn commands_count_only_from_the_cab_whose_relay_is_energised() {
    let mut bench = Bench::new();
    let data = bench.tcms.data.clone();
    bench.inputs.cabs[1].controller = data.at(Lever::Power(4));
    bench.run(500);
    assert!(!bench.powers(), "the other cab's lever is ignored");
    assert_eq!(bench.view().mode, TcmsMode::Manual);

    bench.inputs.cabs[0].hcr = false;
    bench.inputs.cabs[1].hcr = true;
    bench.lever(Lever::Emergency);
    bench.run(500);
    assert!(bench.powers(), "now it is the other way round");
    assert!(!bench.view().line.applied);
}

#[test]
fn two_relays_are_none() {
    let mut bench = Bench::new();
    bench.inputs.cabs[1].hcr = true;
    bench.lever(Lever::Power(4));
    bench.run(1000);
    let view = bench.view();
    assert!(view.line.applied && view.line.sources == EbSources::HCR);
    assert_eq!(view.mode, TcmsMode::None);
    assert!(!bench.powers());
    assert_eq!(bench.events(), [Event::TwoCabsActive], "reported once");
}

#[test]
fn no_relay_is_an_emergency_brake() {
    let mut bench = Bench::new();
    bench.inputs.cabs[0].hcr = false;
    bench.lever(Lever::Power(4));
    let told = bench.run(100);
    assert!(told.emergency);
    assert!(bench.view().power_cuts.contains(PowerCuts::HCR));
    // Cut out, nothing but the full service brake of a train without a mode is left.
    bench.inputs.eb_cut_out = true;
    let told = bench.run(2000);
    assert!(!told.emergency && told.demand == -1.0);
    assert!(bench.view().lamps.contains(Lamps::EB_CUT_OUT));
}

/// Automatic and driverless only while the unit runs the train.
#[test]
fn modes_follow_switch_and_unit() {
    for (switch, with_unit, without) in [
        (ModeSwitch::Off, TcmsMode::None, TcmsMode::None),
        (
            ModeSwitch::Emergency,
            TcmsMode::Emergency,
            TcmsMode::Emergency,
        ),
        (ModeSwitch::Yard, TcmsMode::Yard, TcmsMode::Yard),
        (ModeSwitch::Manual, TcmsMode::Manual, TcmsMode::Manual),
        (ModeSwitch::Automatic, TcmsMode::Automatic, TcmsMode::Manual),
        (
            ModeSwitch::Driverless,
            TcmsMode::Driverless,
            TcmsMode::Manual,
        ),
        (ModeSwitch::Unknown(9), TcmsMode::None, TcmsMode::None),
    ] {
        let mut bench = Bench::automatic(AtcToTcmsBits::empty(), 0);
        bench.inputs.cabs[0].mode_switch = switch;
        bench.run(200);
        assert_eq!(bench.view().mode, with_unit, "{switch:?}");
        bench.order = Some(Default::default());
        bench.run(200);
        assert_eq!(bench.view().mode, without, "{switch:?}");
    }
}

#[test]
fn the_dead_man_acts_after_its_time_and_only_by_hand() {
    for switch in [ModeSwitch::Manual, ModeSwitch::Yard, ModeSwitch::Emergency] {
        let mut bench = Bench::new();
        bench.inputs.cabs[0].mode_switch = switch;
        bench.inputs.cabs[0].dead_man = false;
        bench.run(2500);
        assert!(!bench.full_service(), "{switch:?}");
        bench.run(20);
        assert!(bench.full_service(), "{switch:?}");
        bench.inputs.cabs[0].dead_man = true;
        bench.run(20);
        assert!(!bench.full_service(), "{switch:?}");
        assert_eq!(bench.events(), [Event::DeadMan]);
    }
    let mut bench = Bench::automatic(AtcToTcmsBits::empty(), 0);
    bench.inputs.cabs[0].dead_man = false;
    bench.run(10_000);
    assert!(!bench.full_service() && bench.events().is_empty());
    // The cab that takes the train over has the whole time for the dead man.
    bench.inputs.cabs[0].mode_switch = ModeSwitch::Manual;
    bench.run(2400);
    assert!(!bench.full_service());
    bench.run(200);
    assert!(bench.full_service());
}

#[test]
fn a_contradicting_controller_brakes_and_is_told_once() {
    let mut bench = Bench::new();
    bench.lever(Lever::Power(4));
    bench.inputs.cabs[0].controller.brake = true;
    bench.run(1000);
    assert_eq!(bench.view().driving.drytebe, -1023);
    bench.lever(Lever::Neutral);
    bench.inputs.cabs[0].controller.volts = 10.0;
    bench.run(1000);
    assert_eq!(bench.view().driving.drytebe, -1024, "potentiometer");
    let events = bench.events();
    assert_eq!(
        events,
        [Event::ControllerContradicts, Event::ControllerFailed]
    );
}
