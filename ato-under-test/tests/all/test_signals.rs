//! Signals that leave the TEST board, and answers to its TEST modem through the TWC antenna.

use crate::common::{Bench, departure, fault, line, test_station};
use crate::maintenance::{CODE_75, SESSION, answer_to, armed_with, test_speed};
use protocol::injection::{Effect, FaultMode, Place};
use protocol::message::{
    Answer, Subscribe, TestMarker, TestRelease, TestSignals, TestTwc, TrainState,
};

/// Armed, with these faults, the loop silent, subscribed to `TrainState`.
fn bench(faults: &[FaultMode]) -> Bench {
    let mut bench = armed_with(faults);
    bench.station = None;
    bench.run(1.5);
    bench
}

fn train_state(bench: &mut Bench) -> TrainState {
    bench.answers.clear();
    bench.send(Subscribe { changes: 0 });
    bench.run(0.1);
    bench.last().expect("a state in 100 ms")
}

fn station() -> TestTwc {
    test_station(SESSION, departure(&line().sections[0]))
}

/// Frames the unit accepted and answers the TEST modem heard, of 12 that it sends in 3 s.
fn exchanged(faults: &[FaultMode]) -> [u16; 2] {
    let mut bench = bench(faults);
    let (before, state) = (bench.status.twc_received, train_state(&mut bench));
    assert_eq!(answer_to(&mut bench, station()), Answer::Accepted);
    bench.run(2.8);
    let after = train_state(&mut bench);
    assert_eq!(after.twc_answers, state.twc_answers, "none to the wayside");
    if after.test_answers != state.test_answers {
        let answered = (after.test_answer_station, after.test_answer_train);
        assert_eq!(answered, (station().station, station().train_number));
    }
    [
        bench.status.twc_received - before,
        after.test_answers - state.test_answers,
    ]
}

#[test]
fn station_data_of_the_test_modem_pass_antenna_receiver_and_transmitter() {
    assert_eq!(exchanged(&[]), [12, 12]);
    let dead = |place| exchanged(&[fault(place, Effect::Dead)]);
    assert_eq!(dead(Place::TwcAntenna), [0, 0]);
    assert_eq!(dead(Place::FskReceiver), [0, 0]);
    assert_eq!(dead(Place::FskTransmitter), [12, 0]);
    assert_eq!(dead(Place::TwcCpu), [0, 0]);
    let errors = |place| exchanged(&[fault(place, Effect::BitErrors { rate: 0.5 })]);
    let [received, answered] = errors(Place::FskTransmitter);
    assert!(received == 12 && (1..12).contains(&answered), "{answered}");
    let [received, answered] = errors(Place::TwcAntenna);
    assert!(
        answered < received && received < 12,
        "{answered} of {received}"
    );
    let slow = exchanged(&[fault(Place::TwcCpu, Effect::Delay { ms: 900 })]);
    assert!(slow[0] < 10 && slow[1] == slow[0], "{slow:?}");
}

#[test]
fn a_late_frame_of_a_test_that_is_over_is_dropped() {
    let mut bench = bench(&[fault(Place::TwcCpu, Effect::Delay { ms: 900 })]);
    let before = bench.status.twc_received;
    answer_to(&mut bench, station());
    let release = TestRelease {
        session: SESSION,
        signals: TestSignals::TWC,
    };
    answer_to(&mut bench, release);
    bench.run(2.0);
    assert_eq!(bench.status.twc_received, before);
}

#[test]
fn carrier_rate_and_level_are_measured_where_they_leave() {
    let cases = [
        (None, (3000, 1000, 500)),
        (
            Some((Place::TestCode, Effect::Gain { factor: 0.1 })),
            (3000, 1000, 50),
        ),
        (
            Some((Place::TestCarrier, Effect::Offset { by: -20.0 })),
            (2980, 1000, 500),
        ),
        (
            Some((Place::TestRate, Effect::Offset { by: 0.3 })),
            (3000, 1030, 500),
        ),
    ];
    for (wrong, measured) in cases {
        let faults: Vec<_> = wrong
            .map(|(place, effect)| fault(place, effect))
            .into_iter()
            .collect();
        let mut bench = bench(&faults);
        assert_eq!(answer_to(&mut bench, CODE_75), Answer::Accepted);
        let seen = &bench.status;
        let seen = (
            seen.test_carrier_hz,
            seen.test_code_rate_chz,
            seen.test_level_mv,
        );
        assert_eq!(seen, measured);
    }
}

#[test]
fn speed_is_that_of_the_pulses_which_leave() {
    for (factor, cms) in [(1.0, 1000), (1.05, 1050), (0.5, 500)] {
        let mut bench = bench(&[fault(Place::TestSpeed, Effect::Gain { factor })]);
        answer_to(&mut bench, test_speed(1000));
        bench.run(4.0);
        assert!(
            bench.status.test_speed_cms.abs_diff(cms) <= 1,
            "{}",
            bench.status.test_speed_cms
        );
        let before = train_state(&mut bench).test_pulses;
        bench.run(0.9);
        let made = train_state(&mut bench).test_pulses - before;
        let expected = f64::from(cms) / 100.0 / (std::f64::consts::PI * 0.0086);
        assert!(
            (f64::from(made) - expected).abs() < 2.0,
            "{made} in 1 s, not {expected}"
        );
    }
}

#[test]
fn only_marker_pulses_that_leave_are_counted() {
    for (faults, made) in [
        (vec![], 1),
        (vec![fault(Place::TestMarker, Effect::Dead)], 0),
        (vec![fault(Place::MarkerAntenna, Effect::Dead)], 1),
    ] {
        let mut bench = bench(&faults);
        let marker = TestMarker {
            session: SESSION,
            marker: 2,
        };
        answer_to(&mut bench, marker);
        assert_eq!(train_state(&mut bench).test_markers, made);
    }
}
