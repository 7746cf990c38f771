use btu_rig::lever::Lever;
use btu_rig::stimulus::{Stimulus, TrainSwitch};
use protocol::Speed;
use protocol::message::ModeSwitch;

use super::*;
use crate::test_support::setup;

fn cab() -> Cab {
    Cab::new(&setup(&[]).config.content)
}

#[test]
fn orders_are_stimuli_of_procedures() {
    let cab = cab();
    let done = |line| cab.order(line);
    for (line, stimulus) in [
        ("key off", Stimulus::MaintenanceKey { on: false }),
        ("mode yard", Stimulus::ModeSwitch(ModeSwitch::Yard)),
        ("cab off", Stimulus::Hcr { on: false }),
        ("doors open", Stimulus::Doors { closed: false }),
        (" doors   closed ", Stimulus::Doors { closed: true }),
        ("ack", Stimulus::Acknowledge),
        ("start", Stimulus::Start),
        ("code off", Stimulus::CodeOff),
        (
            "lever B7",
            Stimulus::Controller {
                lever: Lever::Brake(7),
            },
        ),
        (
            "emergency_button on",
            Stimulus::Switch {
                switch: TrainSwitch::Button1,
                on: true,
            },
        ),
        ("reverser backward", Stimulus::Reverser { position: -1 }),
    ] {
        assert_eq!(done(line), Ok(Order::Do(stimulus)), "{line}");
    }
    assert_eq!(done("move 5"), Ok(Order::Push(Speed::from_kmh(5.0))));
    assert_eq!(done("move -2.5"), Ok(Order::Push(Speed::from_kmh(-2.5))));
    assert_eq!(done("stop"), Ok(Order::Push(Speed::ZERO)));
    assert_eq!(done("power off"), Ok(Order::Power(false)));
    assert_eq!(done("quit"), Ok(Order::Quit));
    assert!(matches!(
        done("code 55"),
        Ok(Order::Do(Stimulus::Code { .. }))
    ));
}

#[test]
fn what_is_no_order_is_refused_with_what_is_one() {
    let cab = cab();
    for (line, words) in [
        ("key", "key takes on or off"),
        ("key maybe", "key takes on or off"),
        ("mode fast", "off, yard, manual"),
        ("doors ajar", "open or closed"),
        ("code 56", "55, 65, 75 or off"),
        ("move", "km/h up to 100"),
        ("move 300", "km/h up to 100"),
        ("move nan", "km/h up to 100"),
        ("ack now", "ack takes no value"),
        ("lever B9", "lever takes EB, B7 to B1"),
        ("lever", "lever takes EB, B7 to B1"),
        ("brake_cut_out T1", "takes the number of a car"),
        ("dead_man maybe", "takes on or off"),
        ("key on now", "more than a word and a value"),
        ("fly", "orders, a line each"),
    ] {
        let text = cab.order(line).expect_err(line);
        assert!(text.contains(words), "{line}: {text}");
    }
}

/// Goal: a service drives its sections, and ends with the first that is not driven. Method: two sections on a good
/// train, and on one whose TCMS says nothing to the unit.
#[test]
fn a_service_ends_in_the_depot_whatever_happens_on_the_way() {
    for (faults, whole) in [(&[][..], true), (&["tcms.silent"], false)] {
        let setup = setup(faults);
        let mut aboard = setup.aboard(1, Instant::ZERO);
        let plans =
            service::sections(&["61-62".parse().expect("sections")], &setup).expect("plans");
        assert_eq!(plans.len(), 2);
        service::drive(&plans, &mut aboard, &setup, &Stop::default()).expect("driven");
        let rig = aboard.rig();
        assert_eq!(rig.truth().speed_mps, 0.0);
        let two_sections = rig.truth().position_m > 1500.0;
        assert_eq!(two_sections, whole, "{} m", rig.truth().position_m);
    }
}
