//! Automatic operation from station to station through the wire: position by markers and wheels,
//! what ATO does with inputs it cannot believe, and the record of the run.

use crate::common::{Bench, all, fault, fault_from};
use crate::journey::Journey;
use crate::maintenance::stays_within_its_bytes;
use protocol::SCAN;
use protocol::injection::{Effect, Place};
use protocol::message::{
    AtoFailure, AtoState, Mode, ModeSwitch, Outputs, ReadRun, Refusals, RunEnd, RunRow, StatusBits,
};

/// Distance of one tachometer pulse, m: at rest no position is known better.
const PULSE_M: f64 = std::f64::consts::PI * 0.86 / 100.0;

#[test]
fn a_good_run_ends_at_the_stop_point_and_says_nothing() {
    let mut journey = Journey::new(&[]).run();
    journey.stops_within(0.3);
    journey.knows_its_place_within(PULSE_M);
    assert_eq!(journey.bench.status.ato_state, AtoState::Stop);
    assert!(journey.bench.status.bits.contains(StatusBits::ALIGNED));
    assert!(journey.bench.has(Outputs::DOOR_ENABLE_RIGHT));
    assert_eq!(journey.faults(), [""; 0]);
}

/// Each marker corrects to a centimetre at the speed at which the train passes it.
#[test]
fn a_marker_gives_the_position_to_a_centimetre() {
    let mut journey = Journey::new(&[]);
    journey.wheels_tell = 1.004;
    let mut speeds_kmh = Vec::new();
    for place_m in journey.section.markers_m {
        journey = journey.until_position(place_m);
        // Far enough for a status after the marker, too near for the wheels to matter.
        let beyond_m = 0.06 * journey.v_mps + 0.2;
        journey = journey.until_position(place_m + beyond_m);
        speeds_kmh.push(journey.v_mps * 3.6);
        let error = journey.position_error_m;
        assert!(error.abs() < 0.012, "PSM at {place_m}: {error}");
    }
    assert!(speeds_kmh[0] > 50.0, "{speeds_kmh:?}");
}

/// Wheels worn by 2 % beyond what the unit is set to: found between PSM1 and PSM2, then corrected.
#[test]
fn worn_wheels_are_calibrated_between_markers() {
    let worn = Journey::new(&[]).with(|journey| journey.wheels_tell = 1.0 / 0.98);
    let journey = worn.until_position(828.0);
    let correction = f64::from(journey.bench.status.wheel_correction_10ppm) / 1e5;
    assert!((correction + 0.02).abs() < 5e-4, "{correction}");
    journey.knows_its_place_within(0.1);
    let mut journey = journey.run();
    journey.knows_its_place_within(0.015);
    journey.stops_within(0.3);
    assert_eq!(journey.faults(), [""; 0]);
}

/// No sensor is named: both tell the same, and it is the diameter set in the unit that is wrong.
#[test]
fn wheels_that_no_service_wears_are_told_once() {
    let wide = Journey::new(&[]).with(|journey| journey.wheels_tell = 1.04);
    let mut journey = wide.run();
    assert_eq!(journey.faults(), ["wheel_diameter"]);
    let found = journey.bench.parameters("wheel_diameter")[0];
    assert!(
        (-395..=-375).contains(&found),
        "1/1.04 is -385 in 0.01 %: {found}"
    );
    journey.stops_within(0.3);
}

/// Wheels so far from the configured ones that PSM1 is not believed: known to be further on when it came
/// early, and PSM1 and PSM2 together tell the wheel.
#[test]
fn wheels_of_quite_another_size_do_not_run_past_the_platform() {
    for rolls in [0.92, 1.08] {
        let other = Journey::new(&[]).with(|journey| journey.wheels_tell = 1.0 / rolls);
        let mut journey = other.run();
        let error_m = journey.stop_error_m();
        assert!(error_m.abs() < 0.3, "{rolls}: {error_m}");
        let faults = journey.faults();
        assert!(faults.contains(&"marker_position"), "{rolls}: {faults:?}");
        assert!(faults.contains(&"wheel_diameter"), "{rolls}: {faults:?}");
    }
}

#[test]
fn a_missing_marker_costs_no_centimetre_once_the_next_has_come() {
    let mut journey = Journey::new(&[]);
    journey.wheels_tell = 0.995;
    journey.markers.remove(1);
    let mut journey = journey.run();
    journey.knows_its_place_within(0.025);
    journey.stops_within(0.3);
    assert_eq!(journey.faults(), ["position_unsure", "marker_missing"]);
    assert_eq!(journey.bench.parameters("position_unsure"), [2]);
    assert_eq!(journey.bench.parameters("marker_missing"), [2]);
}

/// A pulse of another coil between two places: reported, and neither position nor order follow it.
#[test]
fn an_extra_marker_is_reported_and_ignored() {
    for (extra, at_m, event) in [
        (3, 500.0, "marker_position"),
        (1, 600.0, "marker_position"),
        (2, 765.0, "marker_position"),
        (4, 836.5, "marker_position"),
    ] {
        let with_extra = Journey::new(&[]).with(|journey| journey.markers.push((extra, at_m)));
        let mut journey = with_extra.run();
        let error_m = journey.stop_error_m();
        assert!(error_m.abs() < 0.3, "PSM{extra} at {at_m}: {error_m}");
        assert_eq!(journey.faults(), [event], "PSM{extra} at {at_m}");
    }
}

/// The contact of TRA closes again: within the debounce time the same edge, later TRA's fault. The position is that of
/// the first edge, and the order of the markers is not blamed.
#[test]
fn a_marker_that_bounces_counts_once_and_leaves_the_position_right() {
    for (marker, again_m, faults) in [
        (1, &[0.3, 0.7][..], &[][..]),
        (2, &[0.4], &[]),
        (1, &[3.0], &["tra_bounces"]),
        (2, &[2.5, 4.0, 6.0], &["tra_bounces"]),
        (3, &[1.5, 2.0], &["tra_bounces"]),
    ] {
        let mut journey = Journey::new(&[]);
        let place_m = journey.section.markers_m[usize::from(marker) - 1];
        for beyond_m in again_m {
            journey.markers.push((marker, place_m + beyond_m));
        }
        let journey = journey.until_position(place_m + 8.0);
        let error_m = journey.position_error_m;
        assert!(error_m.abs() < 0.03, "PSM{marker} {again_m:?}: {error_m}");
        assert_eq!(journey.bench.output.marker_count, marker, "{again_m:?}");
        let mut journey = journey.run();
        let error_m = journey.stop_error_m();
        assert!(error_m.abs() < 0.3, "PSM{marker} {again_m:?}: {error_m}");
        assert_eq!(journey.faults(), faults, "PSM{marker} {again_m:?}");
    }
}

/// PSM4 a second late, as from a hanging relay: the train has passed its place, or stands.
#[test]
fn a_late_psm4_is_not_believed() {
    let late = Journey::new(&[]).with(|journey| journey.markers[3].1 += 2.5);
    let mut journey = late.run();
    journey.stops_within(0.3);
    let faults = journey.faults();
    assert!(faults.contains(&"marker_position"), "{faults:?}");
    assert!(!journey.bench.status.bits.contains(StatusBits::ALIGNED));
}

#[test]
fn swapped_markers_are_out_of_order_and_correct_nothing() {
    let mut journey = Journey::new(&[]);
    (journey.markers[1].0, journey.markers[2].0) = (3, 2);
    let mut journey = journey.run();
    let error_m = journey.stop_error_m();
    assert!((-20.0..0.3).contains(&error_m), "{error_m}");
    let faults = journey.faults();
    let expected = [
        "marker_order",
        "position_unsure",
        "marker_position",
        "stop_short",
        "door_enable_refused",
    ];
    assert_eq!(faults, expected);
}

/// Without markers and with wheels that make it run further than it seems, the train stops short.
#[test]
fn with_a_dead_tra_the_train_stops_short_of_the_platforms_end() {
    for wheels_tell in [0.985, 1.0] {
        let dead = fault_from(Place::Tra, Effect::Dead, 10.0);
        let mut journey = Journey::new(&[dead])
            .with(|journey| journey.wheels_tell = wheels_tell)
            .run();
        let error_m = journey.stop_error_m();
        assert!((-30.0..0.5).contains(&error_m), "{error_m}");
        let faults = journey.faults();
        for event in ["tra_failed", "position_unsure", "stop_short"] {
            assert!(faults.contains(&event), "{event} in {faults:?}");
        }
        assert!(!journey.bench.has(Outputs::DOOR_ENABLE_RIGHT));
    }
}

#[test]
fn a_train_that_does_not_answer_its_brake_is_noticed_and_atp_brakes() {
    let running = Journey::new(&[]).until_position(400.0);
    let mut journey = running.with(|journey| journey.follows = 0.1).run();
    let faults = journey.faults();
    assert!(faults.contains(&"ato_not_following"), "{faults:?}");
    assert_eq!(
        journey.bench.parameters("ato_failed"),
        [i32::from(AtoFailure::NotFollowing.code())]
    );
}

#[test]
fn full_power_that_does_not_end_is_noticed() {
    let stuck = fault_from(Place::AtoCpu, Effect::StuckOn, 20.0);
    let mut journey = Journey::new(&[stuck]).run();
    let faults = journey.faults();
    assert!(faults.contains(&"ato_not_following"), "{faults:?}");
    assert!(faults.contains(&"ato_failed"), "{faults:?}");
    assert!(journey.stop_error_m() < 0.0, "{}", journey.stop_error_m());
}

/// Outputs of a stopped processor stay as they were until the watchdog bites; then ATP brakes and
/// ATO says why.
#[test]
fn a_processor_that_stops_on_the_way_is_noticed_by_the_watchdog() {
    let dead = fault_from(Place::AtoCpu, Effect::Dead, 20.0);
    let mut journey = Journey::new(&[dead]);
    while journey.bench.now.as_us() < 20_000_000 {
        journey.step();
    }
    assert!(journey.v_mps > 5.0, "{}", journey.v_mps);
    (0..30).for_each(|_| journey.step());
    let status = journey.bench.status;
    assert!(!status.bits.contains(StatusBits::ATO_READY));
    assert_eq!((status.effort, status.ato_state), (0, AtoState::Inspection));
    assert!(journey.bench.has(Outputs::FSB));
    let mut journey = journey.run();
    let processor = i32::from(AtoFailure::Processor.code());
    assert_eq!(journey.bench.parameters("ato_failed"), [processor]);
}

/// Tachometers that both keep their value while ATO powers are frozen.
#[test]
fn a_frozen_speed_stops_the_train() {
    let mut journey = Journey::new(&[]).until_position(60.0);
    let frozen = journey.v_mps;
    let mut seconds = 0.0;
    while journey.bench.status.bits.contains(StatusBits::ATO_READY) {
        journey.follows = 0.0;
        journey.step();
        (journey.v_mps, journey.accel_mps2) = (frozen, 0.0);
        seconds += SCAN.as_secs();
        assert!(seconds < 10.0);
    }
    journey.follows = 1.0;
    (0..10).for_each(|_| journey.step());
    assert!(journey.bench.status.effort == -1024 && journey.bench.has(Outputs::FSB));
    assert_eq!(
        journey.bench.status.mode,
        Mode::AutomaticRun,
        "until it stands"
    );
    let mut journey = journey.run();
    let kept = (Mode::Manual, Refusals::ATO_NOT_READY);
    let status = journey.bench.status;
    assert_eq!((status.mode, status.refusals & kept.1), kept);
    journey.bench.acknowledge();
    assert_eq!(
        journey.bench.status.mode,
        Mode::Automatic,
        "inspected again"
    );
    let expected = ["ato_input_absurd", "ato_failed", "door_enable_refused"];
    assert_eq!(journey.faults(), expected);
    assert_eq!(journey.bench.parameters("ato_input_absurd"), [1 << 2]);
}

#[test]
fn the_run_can_be_read_back() {
    let mut journey = Journey::new(&[]).run();
    journey.bench.send(ReadRun { from_index: 0 });
    stays_within_its_bytes(&mut journey.bench);
    journey.bench.answers.clear();
    journey.bench.send(ReadRun { from_index: 0 });
    journey.bench.run(60.0);
    let rows: Vec<RunRow> = all(&journey.bench.answers);
    let end: RunEnd = journey.bench.last().expect("an end");
    assert_eq!((end.oldest_index, end.next_index as usize), (0, rows.len()));
    assert!(
        (1200..2400).contains(&rows.len()),
        "{} rows of 50 ms",
        rows.len()
    );
    assert!(
        rows.windows(2)
            .all(|w| w[1].index == w[0].index + 1 && w[1].at_ms > w[0].at_ms)
    );
    assert!(rows.iter().all(|row| row.run == 1));
    let markers: Vec<u8> = rows
        .iter()
        .map(|row| row.marker)
        .filter(|&m| m != 0)
        .collect();
    assert_eq!(markers, [1, 2, 3, 4]);
    let last = rows[rows.len() - 1];
    assert!((last.position_cm - 85_003).abs() < 50, "{last:?}");
    let top = rows.iter().map(|row| row.speed_cms).max();
    assert!(top > Some(1500), "{top:?}");
    assert!(
        rows.iter()
            .any(|row| row.ato_state == AtoState::Run && row.effort < 0)
    );
}

#[test]
fn a_failed_start_up_check_keeps_ato_in_inspection() {
    for place in [
        Place::Tra,
        Place::FskReceiver,
        Place::FskTransmitter,
        Place::AtoCpu,
    ] {
        let mut bench = Bench::new(&[fault(place, Effect::Dead)]);
        bench.code("65");
        bench.input.mode_switch = ModeSwitch::Automatic;
        bench.run(2.0);
        assert_eq!(bench.status.ato_state, AtoState::Inspection, "{place:?}");
        assert!(bench.status.refusals.contains(Refusals::ATO_NOT_READY));
        assert_eq!(bench.status.mode, Mode::Manual, "{place:?}");
    }
    let bench = Bench::new(&[]);
    assert_eq!(bench.status.ato_state, AtoState::Stop);
}
