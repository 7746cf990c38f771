//! A driverless train at a station, through the wire.

use crate::common::{self, fault};
use crate::journey::Journey;
use protocol::injection::{Effect, Place};
use protocol::message::{Mode, ModeSwitch, Outputs, Refusals, TrainLines, TwcWayside};

/// A scan, after which the doors do what the contacts order: on the right, whose line is that of all.
fn step(journey: &mut Journey) {
    journey.step();
    let bench = &mut journey.bench;
    let opens = bench.has(Outputs::OPEN_RIGHT) && bench.has(Outputs::DOOR_ENABLE_RIGHT);
    if opens || bench.has(Outputs::CLOSE_DOORS) {
        bench.input.lines.set(TrainLines::DOORS_CLOSED, !opens);
    }
}

fn scans(journey: &mut Journey, number: u32) {
    (0..number).for_each(|_| step(journey));
}

/// Runs until the train has stood at the stop point of section 61 for three seconds.
fn arrive(mut journey: Journey) -> Journey {
    // In motion: at rest it would end the run that has begun.
    while journey.v_mps < 1.0 {
        step(&mut journey);
    }
    journey.bench.input.mode_switch = ModeSwitch::Driverless;
    while journey.x_m < 1.0 || journey.v_mps > 0.0 {
        step(&mut journey);
        assert!(
            !journey.bench.has(Outputs::OPEN_RIGHT),
            "not before it stands"
        );
    }
    scans(&mut journey, 300);
    assert!(journey.stop_error_m().abs() < 0.3);
    journey
}

#[test]
fn a_driverless_train_opens_its_doors_at_the_stop_point_and_departs_with_them_proved() {
    let mut journey = arrive(Journey::new(&[]));
    scans(&mut journey, 1_000);
    let bench = &journey.bench;
    assert!(bench.has(Outputs::OPEN_RIGHT) && !bench.has(Outputs::OPEN_LEFT));
    assert!(bench.has(Outputs::HOLDING_BRAKE));
    let expected = Refusals::DOORS_OPEN | Refusals::NO_DEPARTURE | Refusals::DOOR_SEQUENCE;
    assert_eq!(bench.status.refusals, expected);
    let line = common::line();
    let onward = line.after(&journey.section).unwrap();
    journey.bench.station = Some(TwcWayside {
        departure: 1,
        ..common::departure(onward)
    });
    for _ in 0..1_000 {
        step(&mut journey);
        let closed = journey.bench.input.lines.contains(TrainLines::DOORS_CLOSED);
        assert!(closed || journey.bench.status.mode != Mode::AutomaticRun);
    }
    assert_eq!(journey.bench.status.mode, Mode::AutomaticRun);
    assert!(journey.v_mps > 1.0);
    assert_eq!(journey.faults(), [""; 0]);
}

/// Departure in the data of the section's end closes the doors; at its stop point the train has nowhere to run.
#[test]
fn a_train_at_its_stop_point_begins_no_run_whatever_departure_is_given() {
    let mut journey = arrive(Journey::new(&[]));
    let arrival = journey.bench.station.unwrap();
    journey.bench.station = Some(TwcWayside {
        departure: 1,
        ..arrival
    });
    scans(&mut journey, 1_500);
    let bench = &journey.bench;
    assert!(bench.input.lines.contains(TrainLines::DOORS_CLOSED));
    assert_eq!(bench.status.refusals, Refusals::NO_DEPARTURE);
    assert_eq!(bench.status.mode, Mode::Automatic);
    assert_eq!(journey.faults(), [""; 0]);
}

/// Goal: no door is closed on people where the unit has let nobody out. Method: at a platform on the right an obstacle keeps
/// the doors from closing, when a door on the left is opened by hand, and closed again.
#[test]
fn doors_are_not_ordered_to_close_while_one_is_open_that_is_not_enabled() {
    const LEFT: TrainLines = TrainLines::LEFT_CLOSED.union(TrainLines::LEFT_LOCKED);
    let mut journey = arrive(Journey::new(&[]));
    scans(&mut journey, 600);
    let lines = &mut journey.bench.input.lines;
    lines.remove(TrainLines::DOORS_CLOSED);
    lines.insert(TrainLines::DOORS_BY_SIDE | LEFT);
    let arrival = journey.bench.station.unwrap();
    journey.bench.station = Some(TwcWayside {
        departure: 1,
        ..arrival
    });
    for (left_closed, after_s) in [(true, 2.0), (false, 0.03), (false, 0.5), (true, 0.1)] {
        journey.bench.input.lines.set(LEFT, left_closed);
        journey.bench.run(after_s);
        let closes = journey.bench.has(Outputs::CLOSE_DOORS);
        assert_eq!(closes, left_closed, "after {after_s} s");
    }
}

#[test]
fn an_order_to_open_on_the_other_side_does_not_leave_the_unit() {
    let wrong_side = fault(Place::DoorOrder, Effect::Offset { by: -1.0 });
    let mut journey = arrive(Journey::new(&[wrong_side]));
    for _ in 0..600 {
        step(&mut journey);
        let bench = &journey.bench;
        assert!(!bench.has(Outputs::OPEN_LEFT) && !bench.has(Outputs::OPEN_RIGHT));
    }
    assert_eq!(journey.faults()[..1], ["door_order_refused"]);
    assert_eq!(journey.bench.parameters("door_order_refused"), [1]);
}
