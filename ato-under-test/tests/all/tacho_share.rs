//! Tachometers that differ by a share of the way: reported long before they differ by a speed, with the one that is
//! wrong named by the markers; a wheel that spins or slides is neither.

use crate::common::Bench;
use crate::journey::Journey;
use protocol::message::Outputs;

const SHARES: [&str; 3] = ["tacho_ratio", "tacho1_share", "tacho2_share"];

fn shares(events: &[&'static str]) -> Vec<&'static str> {
    let shares = events.iter().filter(|event| SHARES.contains(event));
    shares.copied().collect()
}

/// A running train whose tachometer 2 tells `factor` times the speed.
fn unlike(kmh: f64, factor: f64) -> Bench {
    let mut bench = Bench::under("75", kmh);
    let sound_mps = bench.speeds[0];
    for scan in 1..=200 {
        bench.speeds[1] = sound_mps * (1.0 + (factor - 1.0) * f64::from(scan) / 200.0);
        bench.scan();
    }
    bench
}

/// 6.2 % are 4.6 km/h at 74: less than the difference that brakes.
#[test]
fn a_share_between_the_channels_is_told_within_20_s_and_brakes_nobody() {
    for (kmh, factor) in [(74.0, 0.938), (69.0, 1.0 / 0.938), (74.0, 0.96)] {
        let mut bench = unlike(kmh, factor);
        bench.run(20.0);
        assert!(!bench.braking() && !bench.has(Outputs::FSB), "{factor}");
        let events = bench.events();
        assert_eq!(shares(&events), ["tacho_ratio"], "{factor}: {events:?}");
        let share = f64::from(bench.parameters("tacho_ratio")[0]) / 1e4;
        assert!(
            (share - (1.0 / factor - 1.0)).abs() < 2e-3,
            "{factor}: {share}"
        );
    }
}

#[test]
fn wheels_as_unlike_as_service_makes_them_are_no_finding() {
    for factor in [1.0, 0.98, 1.02] {
        let mut bench = unlike(70.0, factor);
        bench.run(30.0);
        let events = bench.events();
        assert!(shares(&events).is_empty(), "{factor}: {events:?}");
        assert!(!events.contains(&"wheel_slip"), "{factor}: {events:?}");
    }
}

/// The way between PSM1 and PSM2 says which of two is wrong, also where it is the one that counts the distance.
#[test]
fn the_one_that_counts_another_way_between_markers_is_named() {
    for (channels_tell, named) in [
        ([1.0, 0.94], "tacho2_share"),
        ([1.0, 1.064], "tacho2_share"),
        ([0.94, 1.0], "tacho1_share"),
        ([1.064, 1.0], "tacho1_share"),
    ] {
        let unlike = Journey::new(&[]).with(|journey| journey.channels_tell = channels_tell);
        let mut journey = unlike.run();
        let events = journey.faults();
        let told = shares(&events);
        assert!(
            told.contains(&"tacho_ratio"),
            "{channels_tell:?}: {events:?}"
        );
        let names: Vec<_> = told.iter().filter(|e| **e != "tacho_ratio").collect();
        assert_eq!(names, [&named], "{channels_tell:?}: {events:?}");
    }
}

/// One wheel turns by a share slower or faster for some seconds, which it comes to with more than 8 m/s².
#[test]
fn a_wheel_that_slides_or_spins_is_told_from_a_worn_one() {
    for factor in [0.8, 0.93, 1.15] {
        let mut bench = Bench::under("75", 60.0);
        let train_mps = bench.speeds[0];
        for _ in 0..6 {
            for (share, seconds) in [(factor, 1.5), (1.0, 4.0)] {
                let goal = train_mps * share;
                while (bench.speeds[1] - goal).abs() > 0.09 {
                    bench.speeds[1] += 0.09 * (goal - bench.speeds[1]).signum();
                    bench.scan();
                }
                bench.speeds[1] = goal;
                // Longer than half a second, and more than 5 km/h apart, the tachometers would be at fault.
                bench.run(if factor == 0.93 { seconds } else { 0.1 });
            }
        }
        let events = bench.events();
        assert!(shares(&events).is_empty(), "{factor}: {events:?}");
        assert!(events.contains(&"wheel_slip"), "{factor}: {events:?}");
    }
}
