//! Promises of the unit about braking, seen from the wire.

use crate::common::{Bench, fault};
use protocol::injection::{Effect, Place};
use protocol::message::{EbCause, FsbCause, Mode, ModeSwitch, Outputs, Refusals, TrainLines};

#[test]
fn a_healthy_unit_at_rest_logs_no_fault() {
    let mut bench = Bench::new(&[]);
    bench.run(10.0);
    assert_eq!(bench.events(), ["power_up", "mode_changed", "eb_released"]);
    assert!(!bench.braking());
    assert_eq!(bench.status.fsb_cause, FsbCause::NoCode);
    assert_eq!(bench.output.limit_cms, 0);
}

#[test]
fn each_code_gives_its_limit_and_its_loss_the_most_restrictive_one() {
    let mut bench = Bench::new(&[]);
    for (index, code) in crate::common::config().codes.iter().enumerate() {
        bench.code(&code.name);
        bench.run(0.6);
        assert_eq!(usize::from(bench.status.code_index), index);
        assert!((f64::from(bench.output.limit_cms) * 0.036 - code.limit_kmh).abs() < 0.02);
    }
    bench.input.level_mv = 0;
    bench.run(0.9);
    assert!(bench.output.limit_cms > 0, "held for a second");
    bench.run(0.2);
    assert_eq!(bench.output.limit_cms, 0);
}

#[test]
fn overspeed_goes_from_alarm_to_service_brake_to_emergency_brake() {
    let mut bench = Bench::under("55", 54.0);
    bench.run(1.0);
    assert!(!bench.has(Outputs::ALARM));
    bench.speed_kmh(57.0);
    bench.run(1.0);
    assert!(bench.has(Outputs::ALARM) && !bench.has(Outputs::FSB));
    bench.speed_kmh(59.0);
    bench.run(1.0);
    assert!(bench.has(Outputs::FSB) && !bench.braking());
    assert!(
        bench.until(3.0, Bench::braking).is_some(),
        "the service brake shows no effect"
    );
    assert_eq!(bench.status.eb_cause, EbCause::ServiceBrakeIneffective);
    bench.acknowledge();
    assert!(bench.braking(), "latched while moving");
    bench.speed_kmh(0.0);
    bench.run(2.0);
    assert!(bench.braking(), "latched until acknowledged");
    bench.acknowledge();
    assert!(!bench.braking());
}

/// Goal: contacts that come to rest at no position brake a train in three seconds, though by each of their positions none is
/// braked, and by no sum and no delay; at rest they let it go on. Method: 40 km/h; the mode switch at manual and automatic,
/// each for 100 ms, and the reverser forward alone and with backward, each for 20 ms.
#[test]
fn contacts_of_the_desk_that_never_come_to_rest_brake() {
    type Turn = fn(&mut Bench, bool);
    let switch: Turn = |bench, other| {
        let positions = [ModeSwitch::Manual, ModeSwitch::Automatic];
        bench.input.mode_switch = positions[usize::from(other)];
    };
    let reverser: Turn = |bench, other| bench.input.lines.set(TrainLines::BACKWARD, other);
    for (turn, every_ms, event) in [
        (switch, 100, "mode_switch_chatters"),
        (reverser, 20, "reverser_chatters"),
    ] {
        let mut bench = Bench::under("75", 40.0);
        let began = bench.now;
        let braked_ms = loop {
            let ms = bench.now.since(began).as_ms();
            if bench.braking() || ms > 5_000 {
                break ms;
            }
            turn(&mut bench, ms / every_ms % 2 == 1);
            bench.scan();
        };
        assert!(
            (2_900..3_300).contains(&braked_ms),
            "{event}: {braked_ms} ms"
        );
        turn(&mut bench, false);
        bench.run(2.0);
        assert!(bench.braking(), "{event}: until standstill");
        bench.stop();
        bench.run(1.5);
        bench.acknowledge();
        assert!(!bench.braking() && bench.status.mode == Mode::Manual);
        assert!(bench.events().contains(&event));
    }
}

/// Goal: who only forgets a button does not release a brake. Method: it is held since the train moved, and
/// pressed while the cab is not active.
#[test]
fn the_emergency_brake_is_released_only_by_a_press_while_it_may_be() {
    let mut bench = Bench::under("55", 63.0);
    assert!(bench.until(1.0, Bench::braking).is_some());
    bench.input.lines.insert(TrainLines::ACKNOWLEDGE);
    bench.speed_kmh(0.0);
    bench.run(3.0);
    assert!(bench.braking(), "the button is held, not pressed");
    bench
        .input
        .lines
        .remove(TrainLines::ACKNOWLEDGE | TrainLines::HCR);
    bench.run(0.2);
    bench.input.lines.insert(TrainLines::ACKNOWLEDGE);
    bench.run(0.2);
    bench.input.lines.insert(TrainLines::HCR);
    bench.run(0.5);
    assert!(bench.braking(), "pressed in a cab that was not active");
    bench.input.lines.remove(TrainLines::ACKNOWLEDGE);
    bench.run(0.2);
    bench.acknowledge();
    assert!(!bench.braking());
    bench.input.lines.remove(TrainLines::HCR);
    bench.run(0.2);
    assert!(bench.braking() && bench.status.eb_cause == EbCause::NotReleased);
    bench.input.lines.insert(TrainLines::HCR);
    bench.run(0.2);
    assert!(!bench.braking(), "by itself");
}

/// 55 km/h are 1528 cm/s, 63 are 1750.
#[test]
fn what_brought_the_emergency_brake_is_logged_with_its_size() {
    let mut bench = Bench::under("55", 63.0);
    assert!(bench.until(1.0, Bench::braking).is_some());
    let excess_cms = bench.parameters("overspeed_eb")[0];
    assert!((170..=222).contains(&excess_cms), "{excess_cms} cm/s");

    let mut bench = Bench::under("55", 60.0);
    while !bench.braking() {
        bench.speeds = bench.speeds.map(|speed| speed - 0.001);
        bench.run(0.01);
    }
    bench.run(0.1);
    assert_eq!(bench.status.eb_cause, EbCause::ServiceBrakeIneffective);
    let decel_mms2 = bench.parameters("service_brake_ineffective")[0];
    assert!((90..=110).contains(&decel_mms2), "{decel_mms2} mm/s²");
}

#[test]
fn the_service_brake_releases_by_itself_under_the_limit() {
    let mut bench = Bench::under("45", 49.0);
    bench.run(0.5);
    assert!(bench.has(Outputs::FSB));
    bench.speed_kmh(44.0);
    bench.run(0.2);
    assert!(!bench.has(Outputs::FSB) && !bench.has(Outputs::ALARM) && !bench.braking());
}

#[test]
fn a_step_down_of_the_limit_gets_its_grace() {
    let mut bench = Bench::under("55", 50.0);
    bench.run(0.5);
    bench.code("35");
    bench.run(1.5);
    assert!(bench.has(Outputs::FSB), "over the new limit at once");
    assert!(!bench.braking(), "the service brake gets its chance");
    let step = 0.9 / 100.0;
    while bench.speeds[0] * 3.6 > 34.0 {
        bench.speeds = bench.speeds.map(|speed| speed - step);
        bench.scan();
        assert!(!bench.braking());
    }
}

#[test]
fn code_0_stops_a_train_by_the_service_brake_alone() {
    let mut bench = Bench::under("75", 70.0);
    bench.code("0");
    assert!(bench.until(2.0, |b| b.has(Outputs::FSB)).is_some());
    let step = 0.97 / 100.0;
    while bench.speeds[0] > 0.0 {
        bench.speeds = bench.speeds.map(|speed| (speed - step).max(0.0));
        bench.scan();
        assert!(!bench.braking(), "at {} cm/s", bench.output.speed_cms);
    }
    bench.run(3.0);
    assert!(bench.has(Outputs::STANDSTILL) && !bench.braking());
}

/// Goal: a pulse too many does not hide that the service brake works. Method: a train that slows by 0.9 m/s²
/// and once a second a pulse of 27 mm more in one tachometer, which for 100 ms is 0.27 m/s.
#[test]
fn a_spurious_pulse_while_the_service_brake_works_is_no_emergency() {
    let mut bench = Bench::under("75", 70.0);
    bench.code("0");
    assert!(bench.until(2.0, |b| b.has(Outputs::FSB)).is_some());
    let mut speed = bench.speeds[0];
    for scan in 1.. {
        speed -= 0.9 / 100.0;
        if speed < 1.0 {
            break;
        }
        let spurious = if scan % 100 == 0 { 2.7 } else { 0.0 };
        bench.speeds = [speed, speed + spurious];
        bench.scan();
        assert!(!bench.braking(), "scan {scan}, {:?}", bench.status.eb_cause);
    }
}

/// Goal: a pulse too many does not feign that the service brake works. Method: a train that keeps its speed,
/// and such a pulse about three times a second, each of which seems to be a deceleration half a second later.
#[test]
fn spurious_pulses_do_not_delay_the_emergency_brake_of_a_train_that_does_not_slow() {
    for period in [30, 33, 40, 60] {
        let mut bench = Bench::under("55", 60.0);
        assert!(bench.until(2.0, |b| b.has(Outputs::FSB)).is_some());
        let speed = bench.speeds[0];
        let scans = (1..400).find(|scan| {
            let spurious = if scan % period == 0 { 2.7 } else { 0.0 };
            bench.speeds = [speed, speed + spurious];
            bench.scan();
            bench.braking()
        });
        let scans = scans.expect("the emergency brake");
        assert!(
            (290..=310).contains(&scans),
            "every {period} scans: {scans}"
        );
        bench.run(0.1);
        assert_eq!(bench.status.eb_cause, EbCause::ServiceBrakeIneffective);
    }
}

#[test]
fn one_dead_tachometer_brakes_and_is_named() {
    let mut bench = Bench::under("55", 40.0);
    bench.speeds[1] = 0.0;
    assert!(bench.until(2.0, Bench::braking).is_some());
    assert_eq!(bench.status.eb_cause, EbCause::Tachometer);
    assert!(bench.events().contains(&"tacho2_dead"));
}

#[test]
fn rolling_back_brakes_within_half_a_metre() {
    let mut bench = Bench::under("25", 0.0);
    bench.speeds = [-0.5; 2];
    let ms = bench.until(3.0, Bench::braking).expect("brake");
    assert!((1000..1100).contains(&ms), "0.5 m at 0.5 m/s took {ms} ms");
}

#[test]
fn doors_open_on_a_moving_train_brake() {
    let mut bench = Bench::under("25", 0.0);
    bench.input.lines.remove(TrainLines::DOORS_CLOSED);
    bench.run(0.5);
    assert!(
        !bench.braking() && bench.has(Outputs::POWER_CUT),
        "standing: departure inhibited"
    );
    bench.input.lines.insert(TrainLines::DOORS_CLOSED);
    bench.speed_kmh(10.0);
    bench.input.lines.remove(TrainLines::DOORS_CLOSED);
    assert!(bench.until(0.5, Bench::braking).is_some());
    assert!(
        bench
            .until(0.2, |b| b.status.eb_cause == EbCause::DoorOpen)
            .is_some()
    );
}

#[test]
fn silence_of_the_harness_brakes_within_a_quarter_second() {
    let mut bench = Bench::new(&[]);
    bench.io = false;
    let ms = bench.until(1.0, Bench::braking).expect("brake");
    assert!(ms <= 250, "{ms} ms");
}

#[test]
fn a_welded_eb_relay_is_noticed() {
    let mut bench = Bench::new(&[fault(Place::EbRelay, Effect::StuckOn)]);
    bench.run(1.0);
    assert!(bench.events().contains(&"eb_relay_welded"));
    assert!(!bench.has(Outputs::HEALTHY));
}

#[test]
fn automatic_run_needs_every_precondition_and_says_which_is_missing() {
    let mut bench = Bench::new(&[]);
    bench.input.mode_switch = ModeSwitch::Automatic;
    bench.run(0.5);
    assert_eq!(bench.status.mode, Mode::Manual);
    assert!(bench.status.refusals.contains(Refusals::NO_CODE));
    bench.code("55");
    bench.run(1.0);
    assert_eq!(bench.status.mode, Mode::Automatic);
    assert_eq!(bench.status.refusals, Refusals::NO_DEPARTURE);
    if let Some(station) = &mut bench.station {
        station.departure = 1;
    }
    bench.run(0.5);
    bench.input.lines.insert(TrainLines::START);
    bench.run(0.5);
    assert_eq!(bench.status.mode, Mode::AutomaticRun);
    // The effort rises with the jerk limit: 3.0 km/h/s at 0.8 m/s³ takes 1.05 s.
    let begun = bench.status.effort;
    assert!((1..600).contains(&begun), "effort {begun} after 0.4 s");
    bench.run(2.0);
    assert!(bench.status.effort > 300, "power from standstill");
    assert!(f64::from(bench.status.target_cms) <= 50.0 / 0.036 + 1.0);
}

#[test]
fn doors_are_enabled_only_aligned_on_the_right_side() {
    let mut bench = Bench::new(&[]);
    let section = crate::common::line().sections[0].clone();
    bench.code("75");
    bench.run(1.0);
    bench.speed_kmh(70.0);
    for (i, place) in section.markers_m.iter().enumerate() {
        // A status is a cycle old: what the train runs in it, so that the marker pulses at its place.
        let cycle_cm = if i < 2 { 97.0 } else { 7.0 };
        let reached = place * 100.0 - cycle_cm;
        assert!(
            bench
                .until(90.0, |b| f64::from(b.status.position_cm) >= reached)
                .is_some()
        );
        if i == 1 {
            bench.speed_kmh(5.0);
        }
        bench.marker(i as u8 + 1);
    }
    let mps = 5.0 / 3.6;
    let remaining = section.stop_m - section.markers_m[3] - mps * 0.1 - mps * mps / (2.0 * 3.0);
    bench.run(remaining / mps);
    bench.stop();
    bench.station = Some(protocol::message::TwcWayside {
        station: section.to_station,
        next_station: section.to_station + 1,
        loop_id: section.to_loop,
        door_side: protocol::message::DoorSide::Right,
        ..crate::common::departure(&section)
    });
    bench.run(2.0);
    assert!(
        bench.has(Outputs::DOOR_ENABLE_RIGHT),
        "position {} cm",
        bench.status.position_cm
    );
    assert!(!bench.has(Outputs::DOOR_ENABLE_LEFT));
}

/// Found by the hazard search: a train that creeps back, its first tachometer dead.
#[test]
fn a_dead_tachometer_hides_no_rollback() {
    for speeds in [[0.0, -0.2], [-0.2, 0.0], [-0.2, -0.2]] {
        let mut bench = Bench::hearing("25", &[]);
        bench.rest();
        assert!(!bench.braking(), "{speeds:?}");
        bench.speeds = speeds;
        let took = bench.until(6.0, |bench| bench.braking());
        let way_m = took.expect("braked") as f64 / 1000.0 * 0.2;
        assert!((0.45..0.6).contains(&way_m), "{speeds:?}: {way_m} m");
        bench.run(0.1);
        assert_eq!(bench.status.eb_cause, EbCause::Rollback);
    }
}
