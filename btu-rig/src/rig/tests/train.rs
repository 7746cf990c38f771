//! The train model in the rig: what the tachometers, markers and antenna make of its motion, and
//! what the rig says is true.

use protocol::line::{CodeFrom, Gradient, Line};
use protocol::message::{AtcToTcmsBits, ModeSwitch};
use protocol::signal::Signal;

use super::{FakeUnit, config, line, order};
use crate::conditions::Conditions;
use crate::rig::{Bench, Rig, TrueMotion};
use crate::stimulus::{CutOut, Stimulus};
use crate::train::TrainData;

/// Full effort the fake unit's commands stand for.
const FULL: f64 = 1023.0;

fn section_61() -> Line {
    let mut line = line();
    line.sections.retain(|s| s.section == 61);
    line
}

/// A train at the start of section 61 of this line, under these conditions.
fn at_departure(line: &Line, conditions: Conditions) -> Bench<FakeUnit> {
    let mut bench = Bench::new(Rig::new(&config(), line, 1), FakeUnit::default());
    bench.rig.set_conditions(conditions);
    bench.apply(Stimulus::MarkersAlong { section: Some(61) });
    bench.apply(Stimulus::TrainDriven { on: true });
    bench.apply(Stimulus::ModeSwitch(ModeSwitch::Automatic));
    bench
}

/// Lets the unit ask for a share of full effort.
fn ask(bench: &mut Bench<FakeUnit>, share: f64) {
    let bits = if share < 0.0 {
        AtcToTcmsBits::BRAKE
    } else {
        AtcToTcmsBits::POWER
    };
    bench.link.to_tcms = order(bits, (share * FULL) as i16);
}

/// Pulses of channel 1 so far; runs in these tests stay below one turn of the counter.
fn pulses(bench: &Bench<FakeUnit>) -> f64 {
    f64::from(bench.rig.tachos[0].count)
}

#[test]
fn true_values_are_the_trains_and_the_distance_to_its_stop() {
    let mut bench = at_departure(&section_61(), Conditions::default());
    bench.run_ms(100);
    assert_eq!(bench.rig.truth().to_stop_m, Some(850.03));
    ask(&mut bench, 1.0);
    bench.run_ms(15_000);
    let TrueMotion {
        speed_mps,
        accel_mps2,
        position_m,
        to_stop_m,
        tractive_power_w,
        traction_n,
        ..
    } = bench.rig.truth();
    assert!((position_m + to_stop_m.unwrap() - 850.03).abs() < 1e-9);
    assert!((bench.value(Signal::TrainSpeed) / 3.6 - speed_mps).abs() < 1e-9);
    assert!((bench.value(Signal::ToStop) - to_stop_m.unwrap()).abs() < 1e-9);
    assert!((bench.value(Signal::TrainAccel) - accel_mps2).abs() < 0.02);
    assert!((tractive_power_w / (traction_n * speed_mps) - 1.0).abs() < 1e-3);
    ask(&mut bench, -1.0);
    bench.run_ms(5_000);
    let braking = bench.rig.truth();
    assert!(braking.electric_brake_n > braking.air_brake_n && braking.traction_n == 0.0);
    assert!((-1.1..-0.9).contains(&bench.value(Signal::TrainAccel)));
    assert!(bench.value(Signal::TrainJerk).abs() < 0.1, "steady");
}

/// A wheel 2 % larger makes 2 % fewer pulses for the distance; markers pulse where they really lie.
#[test]
fn wheels_and_markers_are_what_they_are_not_what_is_configured() {
    let conditions = Conditions {
        wheel_factor: 1.02,
        marker_offsets_m: [1.5, 0.0, 0.0, 0.0],
        ..Conditions::default()
    };
    let mut bench = at_departure(&section_61(), conditions);
    ask(&mut bench, 1.0);
    while bench.rig.markers.edges == 0 {
        bench.run_ms(10);
        assert!(bench.now().as_secs() < 60.0);
    }
    let rig = &bench.rig;
    let since_s = f64::from(rig.markers.age_us()) / 1e6;
    let marker_m = rig.truth().position_m - since_s * rig.truth().speed_mps;
    assert!((marker_m - (304.03 + 1.5)).abs() < 2e-3, "{marker_m}");
    let distance_m = pulses(&bench) * config().metres_per_pulse() * 1.02;
    assert!(
        (distance_m - rig.truth().position_m).abs() < 0.06,
        "{distance_m}"
    );
}

/// Braking on leaves the tachometers lose distance the train rolls, and TrainPosition does not.
#[test]
fn a_slide_shows_in_the_tachometers_only() {
    let leaves = Conditions {
        adhesion: 0.05,
        ..Conditions::default()
    };
    let mut bench = at_departure(&section_61(), leaves);
    ask(&mut bench, 0.4);
    bench.run_ms(25_000);
    let pulse_m = config().metres_per_pulse();
    let lost_m = |b: &Bench<FakeUnit>| b.rig.truth().position_m - pulses(b) * pulse_m;
    assert!(lost_m(&bench).abs() < 0.06, "{}", lost_m(&bench));
    ask(&mut bench, -1.0);
    bench.run_ms(3_000);
    assert!(bench.rig.truth().sliding);
    bench.run_ms(40_000);
    assert_eq!(bench.rig.truth().speed_mps, 0.0);
    assert!(lost_m(&bench) > 2.0, "{}", lost_m(&bench));
    // Both move together again: back on good rails the difference stays.
    let (lost, at) = (lost_m(&bench), bench.rig.truth().position_m);
    bench.rig.set_conditions(Conditions::default());
    ask(&mut bench, 0.5);
    bench.run_ms(10_000);
    assert!(bench.rig.truth().position_m > at + 3.0);
    assert!((lost_m(&bench) - lost).abs() < 0.03);
}

/// Goal: forces, masses and the gradient under each car fit together. Method: work of the forces
/// the rig reports against kinetic energy and the height of each car, which is worked out here from
/// the section's gradients, over a hill shorter than the train is long.
#[test]
fn energy_is_kept_over_a_hill() {
    let mut line = section_61();
    let gradient = |at_m, permille| Gradient { at_m, permille };
    line.sections[0].gradients = vec![
        gradient(100.0, 30.0),
        gradient(220.0, -35.0),
        gradient(280.0, 12.0),
        gradient(700.0, 0.0),
    ];
    let slopes = line.sections[0].gradients.clone();
    let height_m = |at: f64| -> f64 {
        let ends = slopes.iter().skip(1).map(|g| g.at_m).chain([f64::MAX]);
        let parts = slopes.iter().zip(ends);
        parts
            .map(|(g, end)| (at.min(end) - g.at_m).max(0.0) * g.permille / 1000.0)
            .sum()
    };
    let cars = TrainData::line6().cars(60_000.0);
    let potential_j = |head_m: f64| -> f64 {
        let mut front_m = head_m;
        cars.iter()
            .map(|&(length_m, kg)| {
                front_m -= length_m;
                let fine =
                    (0..400).map(|i| height_m(front_m + (f64::from(i) + 0.5) * length_m / 400.0));
                kg * 9.80665 * fine.sum::<f64>() / 400.0
            })
            .sum()
    };
    let inertia_kg = 296_368.0 + 60_000.0;
    let energy_j =
        |t: &TrueMotion| 0.5 * inertia_kg * t.speed_mps.powi(2) + potential_j(t.position_m);

    let mut bench = at_departure(&line, Conditions::default());
    bench.apply(Stimulus::Load {
        passengers_kg: 60_000.0,
    });
    let (mut work_j, mut traction_j) = (0.0, 0.0);
    for share in [1.0, 0.3, -0.4, 0.8] {
        ask(&mut bench, share);
        for _ in 0..1100 {
            let before_m = bench.rig.truth().position_m;
            bench.run_ms(10);
            let state = bench.rig.train_state;
            let distance_m = bench.rig.truth().position_m - before_m;
            let brake_n = state.electric_brake_n + state.air_brake_n;
            work_j += (state.traction_n - brake_n - state.resistance_n) * distance_m;
            traction_j += state.traction_n * distance_m;
        }
    }
    let end = bench.rig.truth();
    assert!(end.position_m > 300.0 && traction_j > 2e7, "{end:?}");
    let missing_j = energy_j(&end) - work_j;
    assert!(
        missing_j.abs() < 1e-3 * traction_j,
        "{missing_j} J of {traction_j} J"
    );
}

#[test]
fn the_antenna_follows_the_codes_along_the_section() {
    let mut line = section_61();
    let code = |at_m, code: &str| CodeFrom {
        at_m,
        code: code.to_owned(),
    };
    line.sections[0].speed_codes = vec![code(0.0, "65"), code(100.0, "45")];
    let mut bench = at_departure(&line, Conditions::default());
    let rate = |b: &Bench<FakeUnit>| b.value(Signal::CodeRateHz);
    bench.run_ms(100);
    assert_eq!(rate(&bench), 0.0, "nothing follows unless asked");
    bench.apply(Stimulus::CodesAlong { on: true });
    bench.run_ms(100);
    assert_eq!((rate(&bench), bench.value(Signal::LevelMv)), (12.0, 500.0));
    ask(&mut bench, 1.0);
    while rate(&bench) == 12.0 {
        bench.run_ms(10);
    }
    let place_m = bench.rig.truth().position_m;
    assert_eq!(rate(&bench), 16.5);
    assert!((100.0..100.2).contains(&place_m), "{place_m}");
    bench.apply(Stimulus::CodeOff);
    bench.run_ms(1_000);
    assert_eq!(rate(&bench), 0.0, "what a script takes away stays away");
}

#[test]
fn codes_that_cannot_be_sent_are_refused() {
    let along = Stimulus::CodesAlong { on: true };
    for (codes, words) in [
        (vec![], "section 61 has no speed codes"),
        (vec!["85"], "code 85 at 0 m, which the unit does not have"),
    ] {
        let mut line = section_61();
        let sent = |code: &str| CodeFrom {
            at_m: 0.0,
            code: code.to_owned(),
        };
        line.sections[0].speed_codes = codes.into_iter().map(sent).collect();
        let mut bench = at_departure(&line, Conditions::default());
        let refusal = bench.refusal(along);
        assert!(refusal.contains(words), "{refusal}");
        // In the other order it is the section that is refused.
        bench.apply(Stimulus::MarkersAlong { section: None });
        bench.apply(along);
        bench.refusal(Stimulus::MarkersAlong { section: Some(61) });
    }
}

/// Another train goes on at the speed of the one before.
#[test]
fn a_train_can_be_exchanged() {
    let mut bench = at_departure(&section_61(), Conditions::default());
    ask(&mut bench, 1.0);
    bench.run_ms(10_000);
    let before = bench.rig.truth().speed_mps;
    bench.rig.set_train(TrainData::ideal());
    ask(&mut bench, 0.0);
    bench.run_ms(1_000);
    let after = bench.rig.truth().speed_mps;
    // The train coasts by r·v alone, after the two cycles in which the order for power still
    // stands.
    assert!((after - before).abs() < 0.2, "{before} {after}");
    assert!(bench.rig.truth().accel_mps2 > -0.02);
    let cut_out = Stimulus::CutOut {
        what: CutOut::Brake,
        car: 1,
        on: true,
    };
    let refusal = bench.refusal(cut_out);
    assert!(refusal.contains("point mass"), "{refusal}");
}
