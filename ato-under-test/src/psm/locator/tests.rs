use super::*;
use crate::for_tests::{line8, sg100};

/// A train that departs into section 61.
fn departed() -> (Locator, &'static Section) {
    let section = line8().section(61).unwrap();
    let mut locator = Locator::new(&sg100());
    locator.keep_place(true);
    let departing = TwcWayside {
        section: section.section,
        loop_id: section.from_loop,
        ..TwcWayside::default()
    };
    locator.locate(&departing, line8(), true);
    (locator, section)
}

/// Position after PSM1 was heard at 0.2 m/s, ATP's standstill, 0.5 m before its place by the wheels.
fn position_after_psm1(driven: bool, edge_age_s: f64) -> (f64, f64) {
    let (mut locator, section) = departed();
    let mut log = EventLog::default();
    let pulse = Some(MarkerPulse {
        marker: 1,
        age_us: 0,
    });
    let movement = Movement {
        moved_m: section.markers_m[0] - section.start_m - 0.5,
        edge_age_s,
        speed_mps: 0.2,
        standstill: true,
        driven,
    };
    locator.step(Instant::ZERO, movement, pulse, &mut log);
    (locator.position_m(), section.markers_m[0])
}

/// A train that stops at section 61's stop point by its last marker: wheels that tell this share of the way, markers
/// displaced by these, m.
fn stopped(wheel: f64, displaced_m: [f64; 4]) -> Locator {
    let (mut locator, section) = departed();
    let mut log = EventLog::default();
    let mut go = |way_m, pulse| {
        let movement = Movement {
            moved_m: wheel * way_m,
            edge_age_s: 0.01,
            speed_mps: 5.0,
            standstill: false,
            driven: true,
        };
        locator.step(Instant::ZERO, movement, pulse, &mut log);
    };
    let mut at_m = section.start_m;
    for (marker, (place_m, displaced_m)) in (1..).zip(section.markers_m.iter().zip(displaced_m)) {
        let to_m = place_m + displaced_m;
        let mut rolled = to_m - at_m;
        while rolled > 0.05 {
            go(0.05, None);
            rolled -= 0.05;
        }
        go(rolled, Some(MarkerPulse { marker, age_us: 0 }));
        at_m = to_m;
    }
    let left_m = section.stop_m - section.markers_m[3];
    go(left_m, None);
    locator
}

/// Whether its doors may be enabled, on wheels as configured.
fn aligned(displaced_m: [f64; 4]) -> bool {
    stopped(1.0, displaced_m).aligned()
}

/// Goal: doors are enabled where markers and way agree alone. Method: one or two of the last markers displaced; the
/// train stops by what they tell, as far from the stop point as they are.
#[test]
fn markers_that_contradict_the_way_open_nothing() {
    assert!(aligned([0.0; 4]));
    assert!(aligned([0.05, -0.05, 0.05, -0.05]));
    for by_m in [0.36, 0.46, -0.46, 3.0] {
        assert!(!aligned([0.0, 0.0, 0.0, by_m]), "PSM4 by {by_m} m");
    }
    for by_m in [6.0, -6.0, 2.5] {
        assert!(!aligned([0.0, 0.0, by_m, by_m]), "both by {by_m} m");
    }
    assert!(aligned([0.0, 0.0, 5.0, 0.0]), "PSM3 alone is not believed");
}

/// Goal: a marker that lies elsewhere does not make the train seem slower. Method: wheels that tell 9 % too little, and PSM3
/// and PSM4 too early.
#[test]
fn a_contradiction_keeps_what_was_proved_of_the_speed() {
    assert_eq!(stopped(1.0, [0.0; 4]).runs_farther(), 0.0);
    let proved = stopped(1.0 / 1.09, [0.0; 4]).runs_farther();
    assert!((proved - 0.09).abs() < 2e-3, "{proved}");
    let kept = stopped(1.0 / 1.09, [0.0, 0.0, -2.5, -2.5]);
    assert!(!kept.aligned());
    assert!(kept.runs_farther() > 0.08, "{}", kept.runs_farther());
}

/// Goal: a train that stands at a stop point takes the data of this end and of the section that begins there alone.
/// Method: data of section 61 at its end and at its begin, of the next section and of another, at the end of section 61.
#[test]
fn data_of_another_place_contradict_the_stop_point() {
    let line = line8();
    let here = line.section(61).unwrap();
    let next = line.after(here).unwrap();
    let far = line.section(64).unwrap();
    let (at_begin, at_end) = (here.from_loop, next.from_loop);
    let mut locator = stopped(1.0, [0.0; 4]);
    for (section, loop_id, contradicts) in [
        (here, at_end, false),
        (here, at_begin, true),
        (next, at_end, false),
        (far, far.from_loop, true),
    ] {
        let data = TwcWayside {
            section: section.section,
            loop_id,
            ..TwcWayside::default()
        };
        let found = locator.contradicts(&data, section, line);
        assert_eq!(found, contradicts, "{} {loop_id}", section.section);
        let begins = locator.clone().locate(&data, line, true);
        assert_eq!(begins, section.section == next.section);
    }
    locator.keep_place(false);
    assert!(!locator.contradicts(&TwcWayside::default(), far, line));
}

#[test]
fn a_marker_passed_slowly_counts_and_a_test_marker_does_not() {
    let (position_m, place_m) = position_after_psm1(true, 0.1);
    assert!(libm::fabs(position_m - place_m) < 0.05, "{position_m}");
    for (driven, edge_age_s) in [(false, 0.1), (true, 0.6)] {
        let (position_m, place_m) = position_after_psm1(driven, edge_age_s);
        assert!(position_m < place_m - 0.45, "{driven} {position_m}");
    }
}
