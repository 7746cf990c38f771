//! Which differences between two traces count as deviations.

use super::*;

fn trace(name: &str, kind: ChannelKind, unit: &str, column: &[f64]) -> TraceData {
    TraceData {
        period_us: 50_000,
        trigger_row: Some(2),
        channels: vec![Channel {
            name: name.into(),
            unit: unit.into(),
            kind,
        }],
        columns: vec![column.to_vec()],
        ..TraceData::default()
    }
}

/// Rows in which `came` deviates from `expected`, and the first of them.
fn apart(rule: Rule, name: &str, unit: &str, came: &[f64], expected: &[f64]) -> (usize, usize) {
    let kind = || match unit {
        "bit" => ChannelKind::Bit,
        _ => ChannelKind::Number { lsb: 1.0 },
    };
    let unit = unit.trim_start_matches("bit");
    let came = trace(name, kind(), unit, came);
    let expected = trace(name, kind(), unit, expected);
    let found = compare(&came, &expected, &rule, &[]).expect("compared");
    found.deviations.first().map_or((0, 0), |d| (d.rows, d.row))
}

const STEP: [f64; 8] = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0];
const LATE: [f64; 8] = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
const LATER: [f64; 8] = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0];
const PULSE: [f64; 8] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0];

#[test]
fn two_rows_of_a_clock_are_no_deviation_and_three_are() {
    let clock = Rule::wall_clock();
    assert_eq!(apart(clock, "eb", "bit", &LATE, &STEP), (0, 0));
    assert_eq!(apart(clock, "eb", "bit", &LATER, &STEP), (2, 3));
    assert_eq!(
        apart(clock, "eb", "bit", &[0.0; 8], &PULSE),
        (1, 3),
        "a pulse that did not come"
    );
    assert_eq!(apart(Rule::exact(), "eb", "bit", &LATE, &STEP), (2, 3));
    assert_eq!(
        apart(Rule::after_begin(-18), "eb", "bit", &[0.0; 8], &PULSE),
        (0, 0),
        "before it began"
    );
}

#[test]
fn differing_rows_form_intervals_and_a_shift_moves_the_second_trace() {
    let bit = |column| trace("eb", ChannelKind::Bit, "", column);
    let found = |came, expected, rule: Rule| {
        let found = compare(&bit(came), &bit(expected), &rule, &[]).expect("compared");
        found.deviations.into_iter().next().map(|d| d.stretches)
    };
    let two = [0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0];
    let exact = Rule::exact();
    assert_eq!(found(&two, &[0.0; 8], exact), Some(vec![1..2, 5..7]));
    assert_eq!(found(&LATE, &STEP, exact.shifted(2)), None);
    assert_eq!(found(&STEP, &LATE, exact.shifted(-2)), None);
    assert!(compare(&bit(&STEP), &bit(&LATE), &exact.shifted(99), &[]).is_err());
}

#[test]
fn quantities_have_a_tolerance_and_codes_have_none() {
    let (came, expected) = ([5.0; 8], [6.0; 8]);
    assert_eq!(
        apart(Rule::exact(), "motor_1", "N", &came, &expected).0,
        0,
        "one step"
    );
    assert_eq!(
        apart(Rule::exact(), "motor_1", "N", &[4.0; 8], &expected).0,
        8
    );
    assert_eq!(apart(Rule::exact(), "effort", "", &came, &expected).0, 0);
    assert_eq!(
        apart(Rule::exact(), "refusals", "", &came, &expected).0,
        8,
        "another bit"
    );
    let unknown = [f64::NAN; 8];
    assert_eq!(
        apart(Rule::exact(), "motor_1", "N", &unknown, &expected).0,
        8
    );
    assert_eq!(
        apart(Rule::exact(), "motor_1", "N", &unknown, &unknown).0,
        0
    );
}

#[test]
fn counters_of_a_unit_that_ran_before_count_from_the_begin() {
    let ours: Vec<f64> = STEP.iter().map(|n| n + 40.0).collect();
    let clock = Rule::wall_clock();
    assert_eq!(apart(clock, "marker_count", "", &ours, &STEP).0, 0);
    let more: Vec<f64> = STEP.iter().map(|n| 4.0 * n + 40.0).collect();
    assert_eq!(apart(clock, "marker_count", "", &more, &STEP), (3, 3));
    assert_eq!(apart(clock, "twc_received", "", &more, &STEP).0, 0);
    assert_eq!(apart(Rule::exact(), "marker_count", "", &ours, &STEP).0, 8);
}

#[test]
fn within_one_report_the_order_along_the_signal_path_decides() {
    let two = |first: &str, second: &str, columns: [&[f64]; 2]| {
        let mut both = trace(first, ChannelKind::Bit, "", columns[0]);
        let other = trace(second, ChannelKind::Bit, "", columns[1]);
        both.channels.extend(other.channels);
        both.columns.extend(other.columns);
        both
    };
    let expected = two("eb", "speed1", [&[0.0; 8], &[0.0; 8]]);
    let order = |columns| -> Vec<String> {
        let came = two("eb", "speed1", columns);
        let found = compare(&came, &expected, &Rule::exact(), &[]).expect("compared");
        found.deviations.into_iter().map(|d| d.signal).collect()
    };
    assert_eq!(order([&STEP, &LATE]), ["speed1", "eb"]);
    assert_eq!(order([&STEP, &LATER]), ["eb", "speed1"]);
}

/// Goal: when each end of a link began to send is no evidence of what a unit does. Method: a count of frames that
/// differs, and a brake.
#[test]
fn a_count_of_frames_deviates_and_is_no_evidence() {
    let number = ChannelKind::Number { lsb: 1.0 };
    let sent = |column| trace("twc_sent", number.clone(), "", column);
    let found = compare(&sent(&LATE), &sent(&STEP), &Rule::exact(), &[]).expect("compared");
    assert_eq!((found.deviations.len(), found.evidence()), (1, 0));
    let clock = compare(&sent(&LATER), &sent(&STEP), &Rule::wall_clock(), &[]).expect("compared");
    assert_eq!(clock.deviations, []);
    let brake = |column| trace("eb", ChannelKind::Bit, "", column);
    let found = compare(&brake(&LATE), &brake(&STEP), &Rule::exact(), &[]).expect("compared");
    assert_eq!(found.evidence(), 1);
}
