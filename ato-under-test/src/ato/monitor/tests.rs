//! Findings of ATO's monitor in a run, and events that it passes over.

use alloc::vec::Vec;

use protocol::message::{Mode, RunningMode};

use super::*;
use crate::ato::{Checks, TrainReport};
use crate::for_tests::{line8, sg100};

/// A cycle of a run at 10 m/s in section 61, and the monitor's own inputs.
fn run() -> (AtoInputs<'static>, MonitorInputs) {
    let inputs = AtoInputs {
        mode: Mode::AutomaticRun,
        limit: Speed::from_mps(18.0),
        codes: &[],
        heard_within_s: 1.0,
        fixed_speed: None,
        running_mode: RunningMode::Normal,
        section: line8().section(61),
        position_m: 100.0,
        ahead_m: 0.0,
        aligned_m: 0.3,
        last_marker: false,
        jogs: true,
        speed: Speed::from_mps(10.0),
        standstill: false,
        power_cut: false,
        train: TrainReport::default(),
        load_kg: 0.0,
        checks: Checks::Passed,
    };
    let on = MonitorInputs {
        state: AtoState::Run,
        asked_mps2: 0.0,
        may_go: true,
        stands: false,
        arrived: false,
    };
    (inputs, on)
}

/// Time after which a speed that stays the same is found absurd, within 30 s.
fn frozen_after_s(asked_mps2: f64) -> Option<f64> {
    let (inputs, on) = run();
    let on = MonitorInputs { asked_mps2, ..on };
    let mut monitor = Monitor::default();
    let found = (1..=600).find(|_| {
        let findings = monitor.step(&inputs, on, &sg100().ato);
        assert_eq!(findings.not_following_mps, None);
        findings.absurd == AbsurdInputs::FROZEN_SPEED
    });
    found.map(|step| f64::from(step) * CYCLE.as_secs())
}

/// Absurd inputs found in a train that inches at 0.3 m/s and then has these speeds, m/s, cycle by
/// cycle.
fn found_inching(speeds_mps: &[f64]) -> AbsurdInputs {
    let (inputs, on) = run();
    let (mut monitor, mut absurd) = (Monitor::default(), AbsurdInputs::empty());
    for &speed_mps in [0.3, 0.3].iter().chain(speeds_mps) {
        let speed = Speed::from_mps(speed_mps);
        let findings = monitor.step(&AtoInputs { speed, ..inputs }, on, &sg100().ato);
        assert_eq!(findings.not_following_mps, None);
        absurd |= findings.absurd;
    }
    absurd
}

/// Two edges 12 ms apart are 2.3 m/s until the wheel has been silent for another 27 ms.
#[test]
fn a_speed_that_a_lone_pulse_makes_is_passed_over_and_one_that_stays_is_absurd() {
    let none = AbsurdInputs::empty();
    assert_eq!(found_inching(&[2.3, 0.5, 0.3]), none);
    assert_eq!(found_inching(&[2.3, 2.0]), AbsurdInputs::SPEED_JUMP);
    assert_eq!(found_inching(&[9.0, 9.0]), AbsurdInputs::SPEED_JUMP);
    let again = [2.3, 0.3, 0.3, 2.3];
    assert_eq!(found_inching(&again), AbsurdInputs::SPEED_JUMP);
}

/// Overruns reported in a run that stands at each of these distances past the stop point, m.
fn overruns_m(past_m: &[f64]) -> Vec<f64> {
    let (inputs, on) = run();
    let on = MonitorInputs { stands: true, ..on };
    let stop_m = inputs.section.unwrap().stop_m;
    let mut monitor = Monitor::default();
    let told = past_m.iter().filter_map(|past_m| {
        let inputs = AtoInputs {
            position_m: stop_m + past_m,
            speed: Speed::ZERO,
            standstill: true,
            ..inputs
        };
        monitor.step(&inputs, on, &sg100().ato).overrun_m
    });
    told.map(libm::round).collect()
}

#[test]
fn an_overrun_is_told_of_the_run_that_passed_the_stop_point_alone() {
    assert_eq!(overruns_m(&[-1.0, 2.0, 2.0]), [2.0]);
    assert_eq!(overruns_m(&[2.0, 2.0, 1.5]), [0.0; 0], "to jog back");
}

#[test]
fn a_frozen_tachometer_is_found_and_a_grade_nobody_knows_of_is_none() {
    // 35 ‰ are 0.34 m/s²: what the effort asks beyond the known costs of the track just holds it.
    assert_eq!(frozen_after_s(0.34), None);
    assert_eq!(frozen_after_s(-0.34), None);
    for asked_mps2 in [0.7, -0.8] {
        let after_s = frozen_after_s(asked_mps2);
        assert!(after_s.is_some_and(|s| s < 4.1), "{after_s:?}");
    }
}
