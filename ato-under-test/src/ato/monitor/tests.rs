//! What ATO's watch finds in a run, and what it passes over.

use protocol::line::Line;
use protocol::message::{Mode, RunningMode};

use super::*;
use crate::ato::{Checks, tests::config};

/// Time after which a speed that stays the same is found absurd, within 30 s.
fn frozen_after_s(asked_mps2: f64) -> Option<f64> {
    let line = include_str!("../../../../scripts/lines/line8.toml");
    let line = Line::from_toml(line).unwrap();
    let inputs = AtoInputs {
        mode: Mode::AutomaticRun,
        limit: Speed::from_mps(18.0),
        codes: &[],
        heard_within_s: 1.0,
        fixed_speed: None,
        running_mode: RunningMode::Normal,
        section: line.section(61),
        position_m: 100.0,
        ahead_m: 0.0,
        aligned_m: 0.3,
        last_marker: false,
        jog_dead: false,
        speed: Speed::from_mps(10.0),
        standstill: false,
        power_cut: false,
        train: TrainReport::default(),
        load_kg: 0.0,
        checks: Checks::Passed,
    };
    let on = MonitorInputs {
        state: AtoState::Run,
        asked_mps2,
        may_go: true,
        stands: false,
        arrived: false,
    };
    let mut monitor = Monitor::default();
    let mut steps = 1..=600;
    let found = steps.find(|_| {
        let findings = monitor.step(&inputs, on, &config());
        assert_eq!(findings.not_following_mps, None);
        findings.absurd == AbsurdInputs::FROZEN_SPEED
    });
    found.map(|step| f64::from(step) * CYCLE.as_secs())
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
