//! The speed controllers by themselves: S1's comparison, closed loops with a train whose effort comes
//! late, S2's run, and any input whatsoever. How the servo stops stands with the whole unit; everything
//! else is asked of it, too.

#![allow(
    clippy::print_stdout,
    reason = "figures, for whoever asks with --nocapture"
)]

use crate::plant::{KMH, Row, Run, config, drive, rms, s1_errors};
use ato_under_test::ato::controller::{ControllerInput, Fuzzy, Pi, controller};
use proptest::prelude::*;
use protocol::config::{AtoConfig, ControllerKind, GainUnit};

/// The controllers that stop along one braking curve, wherever markers lie.
const FOLLOWERS: [ControllerKind; 3] = [
    ControllerKind::Pi,
    ControllerKind::Fuzzy,
    ControllerKind::Pss,
];

/// The laws as S1 prints them: no feed-forward, a profile that does not wait for the train, a train that follows
/// at once.
fn as_printed(unit: GainUnit) -> AtoConfig {
    let mut config = config();
    config.profile.feed_forward = false;
    config.profile.lead_kmh = 50.0;
    config.train.lag_ms = 0.0;
    config.pi.speed_unit = unit;
    config
}

fn with_controller(controller: ControllerKind) -> AtoConfig {
    AtoConfig {
        controller,
        ..config()
    }
}

fn run(kind: ControllerKind, run: Run, seconds: f64, cruise: impl Fn(f64) -> f64) -> Vec<Row> {
    let config = with_controller(kind);
    drive(&mut *controller(&config), &config, run, seconds, cruise)
}

fn top_mps(rows: &[Row]) -> f64 {
    rows.iter().fold(0.0, |top, row| row.speed_mps.max(top))
}

/// Goal: S1's finding, as a figure. Root mean square of profile less speed over the ramp to 60 km/h and
/// 30 s of cruise, fuzzy over PI. Gains per m/s give S1's picture; gains per km/h are 3.6 times as
/// hard, and then PI is the better one.
#[test]
fn fuzzy_follows_better_than_pi_with_the_printed_gains_per_metre_per_second() {
    for (unit, low, high) in [(GainUnit::Mps, 0.0, 0.7), (GainUnit::Kmh, 1.3, 1.7)] {
        let config = as_printed(unit);
        let pi = rms(s1_errors(&mut Pi::new(&config)));
        let fuzzy = rms(s1_errors(&mut Fuzzy::new(&config)));
        let ratio = fuzzy / pi;
        println!("{unit:?}: PI {pi:.3} m/s, fuzzy {fuzzy:.3} m/s, ratio {ratio:.3}");
        assert!((low..=high).contains(&ratio), "{unit:?}: {ratio}");
    }
}

/// Goal: what was added to the printed laws pays. With feed-forward both follow S1's ramp with little
/// more than what the disturbance itself does within a second, 0.09 m/s.
#[test]
fn feed_forward_leaves_little_but_the_disturbance() {
    let mut config = as_printed(GainUnit::Mps);
    config.profile.feed_forward = true;
    let pi = rms(s1_errors(&mut Pi::new(&config)));
    let fuzzy = rms(s1_errors(&mut Fuzzy::new(&config)));
    println!("feed-forward: PI {pi:.3} m/s, fuzzy {fuzzy:.3} m/s");
    assert!(pi < 0.15 && fuzzy < 0.15, "PI {pi}, fuzzy {fuzzy}");
}

/// Goal: stop where a train should although the effort comes late and with a lag. Empty and
/// full, on the level and on gradients of the track database; distance known to a tachometer pulse and speed
/// to 0.05 m/s in the second half.
#[test]
fn trains_stop_within_five_centimetres() {
    for kind in FOLLOWERS {
        for load_kg in [0.0, 160e3] {
            for known_permille in [0.0, 35.0, -35.0] {
                for speed_noise_mps in [0.0, 0.05] {
                    let conditions = Run {
                        load_kg,
                        known_permille,
                        speed_noise_mps,
                        distance_m: Some(850.0),
                        ..Run::LEVEL
                    };
                    let rows = run(kind, conditions, 110.0, |_| 60.0 * KMH);
                    assert_stopped(&rows, 850.0, 0.05, kind, conditions);
                    let hardest = rows.iter().fold(0.0_f64, |a, row| row.accel_mps2.min(a));
                    assert!(hardest > -0.75, "{kind:?} {conditions:?}: {hardest} m/s²");
                }
            }
        }
    }
}

/// Goal: the stop holds although the brake gives a tenth more or less and the track database is 3 ‰
/// wrong. PI with the printed gains has little to set against that; its figure is here so that a
/// change of it shows.
#[test]
fn a_brake_a_tenth_off_on_a_wrong_gradient_moves_the_stop_little() {
    for (kind, allowed_m) in [
        (ControllerKind::Pss, 0.05),
        (ControllerKind::Fuzzy, 0.08),
        (ControllerKind::Pi, 0.30),
    ] {
        for unknown_permille in [3.0, -3.0] {
            for brake_factor in [0.9, 1.1] {
                let conditions = Run {
                    unknown_permille,
                    brake_factor,
                    speed_noise_mps: 0.05,
                    distance_m: Some(850.0),
                    ..Run::LEVEL
                };
                let rows = run(kind, conditions, 110.0, |_| 60.0 * KMH);
                assert_stopped(&rows, 850.0, allowed_m, kind, conditions);
            }
        }
    }
}

fn assert_stopped(rows: &[Row], distance_m: f64, allowed_m: f64, kind: ControllerKind, run: Run) {
    let Some(last) = rows.last() else {
        panic!("no rows");
    };
    let error = last.position_m - distance_m;
    println!("{kind:?} {run:?}: {:+.1} cm", error * 100.0);
    assert!(last.speed_mps < 0.01, "{kind:?} {run:?}: still moves");
    assert!(error.abs() <= allowed_m, "{kind:?} {run:?}: {error} m");
}

/// Goal: no windup. A full train on 35 ‰ has 0.5 m/s² where the profile has 0.83; a train whose
/// powering is cut for 20 s has none; both then reach the new speed without passing it by 1 km/h, and so
/// they do when the limit falls on the way up; the servo, whose S-curve has run ahead of the train, by
/// 1.5 km/h, of the 5 km/h that the speed is below the limit.
#[test]
fn what_was_withheld_is_not_made_up_for_by_overshoot() {
    for kind in ControllerKind::ALL {
        for (load_kg, known_permille, cut_until_s) in [
            (160e3, 35.0, 0.0),
            (0.0, 0.0, 20.0),
            (160e3, 35.0, 20.0),
            (160e3, -35.0, 0.0),
        ] {
            let conditions = Run {
                load_kg,
                known_permille,
                cut_until_s,
                ..Run::LEVEL
            };
            let rows = run(kind, conditions, 150.0, |_| 60.0 * KMH);
            let top_kmh = top_mps(&rows) / KMH;
            assert!(
                (58.5..61.0).contains(&top_kmh),
                "{kind:?} {conditions:?}: {top_kmh}"
            );
            let falls = |at_m: f64| if at_m < 60.0 { 60.0 * KMH } else { 40.0 * KMH };
            let rows = run(kind, conditions, 150.0, falls);
            let top_kmh = top_mps(&rows) / KMH;
            let most_kmh = match kind {
                ControllerKind::Servo => 41.5,
                _ => 41.0,
            };
            assert!(
                top_kmh < most_kmh,
                "{kind:?} {conditions:?}: {top_kmh} after the fall"
            );
        }
    }
}

/// Goal: no limit cycle. Once the cruising speed is reached, nothing moves, empty or full, up or down.
#[test]
fn cruising_is_quiet() {
    for kind in ControllerKind::ALL {
        for load_kg in [0.0, 160e3] {
            for known_permille in [0.0, 35.0, -35.0] {
                let conditions = Run {
                    load_kg,
                    known_permille,
                    ..Run::LEVEL
                };
                let rows = run(kind, conditions, 150.0, |_| 40.0 * KMH);
                let late = rows.iter().filter(|row| row.at_s > 100.0);
                let most = late.fold(0.0_f64, |a, row| row.accel_mps2.abs().max(a));
                assert!(most < 2e-3, "{kind:?} {conditions:?}: {most} m/s²");
            }
        }
    }
}

/// Goal: S2's run on line 6. 735 m, limit 55 → 45 km/h at 235 m: the target is the limit less 5 km/h until
/// PSS is lower, at 637 m; full powering from standstill, less as the target nears.
#[test]
fn pss_runs_as_on_line_6() {
    let conditions = Run {
        distance_m: Some(735.0),
        ..Run::LEVEL
    };
    let cruise = |at_m: f64| if at_m < 235.0 { 50.0 * KMH } else { 40.0 * KMH };
    let rows = run(ControllerKind::Pss, conditions, 110.0, cruise);
    let full_n = config().accel_kmh_per_s * KMH * 296e3;
    assert!(rows[0].demand.force_n > full_n);
    let near = rows.iter().find(|row| row.speed_mps > 49.5 * KMH);
    assert!(near.is_some_and(|row| row.demand.force_n < 0.3 * full_n));
    for row in rows.iter().filter(|row| row.position_m < 630.0) {
        let expected = cruise(row.position_m);
        assert!((row.demand.target_mps - expected).abs() < 1e-9, "{row:?}");
    }
    let takes_over = rows
        .iter()
        .find(|row| row.demand.target_mps < 40.0 * KMH - 1e-9);
    let at_m = takes_over.map(|row| row.position_m);
    println!("PSS takes over at {at_m:?} m");
    assert!(at_m.is_some_and(|at| (at - 637.0).abs() <= 3.0), "{at_m:?}");
    assert_stopped(&rows, 735.0, 0.05, ControllerKind::Pss, conditions);
}

/// A situation in the middle of a run.
fn sound() -> ControllerInput {
    ControllerInput {
        cruise_mps: 15.0,
        speed_mps: 12.0,
        accel_mps2: 0.3,
        to_stop_m: Some(400.0),
        markers_to_stop_m: [546.0, 108.5, 21.0, 3.5],
        mass_kg: 296e3,
        brake_mps2: 0.97,
        granted_n: 90e3,
    }
}

/// Any number: plausible ones, huge ones, and what is none.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -100.0..1000.0_f64,
        1 => -1e308..1e308_f64,
        1 => prop::sample::select(vec![
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MAX,
            f64::MIN,
            f64::MIN_POSITIVE,
            0.0,
            -0.0,
        ]),
    ]
}

prop_compose! {
    fn any_situation()(
        cruise_mps in number(),
        speed_mps in number(),
        accel_mps2 in number(),
        to_stop_m in prop::option::of(number()),
        markers_to_stop_m in prop::array::uniform4(number()),
        mass_kg in prop_oneof![3 => 200e3..500e3_f64, 1 => number()],
        granted_n in prop_oneof![3 => -4e5..4e5_f64, 1 => number()],
    ) -> ControllerInput {
        ControllerInput {
            cruise_mps,
            speed_mps,
            accel_mps2,
            to_stop_m,
            markers_to_stop_m,
            mass_kg,
            brake_mps2: 0.97,
            granted_n,
        }
    }
}

proptest! {
    /// Whatever comes in, a force comes out that a train can be asked for; a speed, a distance or a mass
    /// that is no number is braked; and a reset forgets it all.
    #[test]
    fn any_input_gives_a_force(situations in prop::collection::vec(any_situation(), 1..40)) {
        for kind in ControllerKind::ALL {
            let config = with_controller(kind);
            let mut tried = controller(&config);
            for input in &situations {
                let demand = tried.step(input);
                prop_assert!(demand.force_n.is_finite(), "{kind:?} {input:?}: {demand:?}");
                prop_assert!(demand.target_mps.is_finite(), "{kind:?} {input:?}: {demand:?}");
                let unknown = [input.speed_mps, input.cruise_mps, input.mass_kg]
                    .iter()
                    .chain(&input.to_stop_m)
                    .any(|x| !x.is_finite());
                if unknown {
                    prop_assert!(demand.force_n < 0.0, "{kind:?} {input:?}: {demand:?}");
                }
            }
            tried.reset();
            prop_assert_eq!(tried.step(&sound()), controller(&config).step(&sound()));
        }
    }

    /// One cycle of nonsense brakes and leaves no trace in the next one.
    #[test]
    fn one_bad_cycle_is_forgotten(bad in any_situation(), field in 0..4_usize) {
        let mut bad = bad;
        match field {
            0 => bad.speed_mps = f64::NAN,
            1 => bad.mass_kg = -1.0,
            2 => bad.to_stop_m = Some(f64::INFINITY),
            _ => bad.cruise_mps = 1e12,
        }
        for kind in ControllerKind::ALL {
            let config = with_controller(kind);
            let (mut with, mut without) = (controller(&config), controller(&config));
            with.step(&sound());
            without.step(&sound());
            prop_assert!(with.step(&bad).force_n < 0.0);
            prop_assert_eq!(with.step(&sound()), without.step(&sound()));
        }
    }
}
