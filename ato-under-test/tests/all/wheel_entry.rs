//! A wheel diameter keyed in at the cab: taken in range and at standstill alone, and used.

use protocol::injection::{Effect, Place};
use protocol::message::WheelEntry;

use crate::common::{Bench, fault};

/// Keys a diameter in for 250 ms, mm.
fn key_in(bench: &mut Bench, diameter_mm: u16) {
    for _ in 0..5 {
        bench.send(WheelEntry {
            diameter_01mm: 10 * diameter_mm,
        });
        bench.run(0.05);
    }
}

/// Speed on the display of wheels of 860 mm that turn as at 20 km/h.
fn at_20_kmh(bench: &mut Bench) -> f64 {
    bench.speed_kmh(20.0);
    bench.run(4.0);
    f64::from(bench.output.speed_cms) * 0.036
}

#[test]
fn the_same_pulses_are_another_speed_from_a_wheel_of_another_diameter() {
    for (diameter_mm, expected_kmh) in [
        (779, 20.0),
        (780, 20.0 * 780.0 / 860.0),
        (865, 20.0 * 865.0 / 860.0),
        (866, 20.0),
        (0, 20.0),
    ] {
        let mut bench = Bench::hearing("75", &[]);
        key_in(&mut bench, diameter_mm);
        let shown = at_20_kmh(&mut bench);
        assert!(
            (shown - expected_kmh).abs() < 0.15,
            "{diameter_mm}: {shown}"
        );
    }
}

#[test]
fn one_frame_and_one_keyed_in_under_way_change_nothing() {
    let mut bench = Bench::hearing("75", &[]);
    bench.send(WheelEntry {
        diameter_01mm: 8000,
    });
    bench.run(1.0);
    assert!((at_20_kmh(&mut bench) - 20.0).abs() < 0.15);
    key_in(&mut bench, 800);
    bench.run(1.0);
    assert!((f64::from(bench.output.speed_cms) * 0.036 - 20.0).abs() < 0.15);
    let events = bench.events();
    let refused = events.iter().filter(|name| **name == "wheel_refused");
    assert_eq!(refused.count(), 1, "{events:?}");
}

#[test]
fn without_its_guard_a_unit_takes_any() {
    let mut bench = Bench::hearing("75", &[fault(Place::WheelGuard, Effect::Dead)]);
    key_in(&mut bench, 430);
    let shown = at_20_kmh(&mut bench);
    assert!((shown - 10.0).abs() < 0.2, "{shown}");
}
