//! Promises of the unit to a tester: arming, stimuli, the event log.

use crate::common::{Bench, confirm};
use protocol::injection::FaultMode;
use protocol::message::{
    Answer, ArmRefusal, ArmRequest, ArmState, CATALOGUE, Channel, ClearLog, Disarm, Message,
    Outputs, ReadLog, Subscribe, TestCode, TestSpeed, TrainLines,
};

pub const SESSION: u32 = 0xBEEF;

/// Reason for which the unit refuses to arm; `None` = it is armed.
pub fn arm(bench: &mut Bench) -> Option<ArmRefusal> {
    bench.answers.clear();
    bench.send(ArmRequest { session: SESSION });
    bench.run(0.05);
    if let Some(challenge) = bench.last() {
        bench.send(confirm(challenge, SESSION));
        bench.session = SESSION;
        // Longer than a train may take to prove that it brakes.
        bench.run(0.4);
    }
    let state: ArmState = bench.last().expect("an outcome of arming");
    (state.armed == 0).then_some(state.refusal)
}

fn armed() -> Bench {
    armed_with(&[])
}

pub fn armed_with(faults: &[FaultMode]) -> Bench {
    let mut bench = Bench::new(faults);
    bench.input.lines.insert(TrainLines::MAINTENANCE_KEY);
    bench.run(0.1);
    assert_eq!(arm(&mut bench), None);
    bench
}

pub const CODE_75: TestCode = TestCode {
    session: SESSION,
    carrier_hz: 3000,
    code_rate_chz: 1000,
    level_mv: 500,
};

/// A test speed forward, cm/s, in place of both tachometers.
pub fn test_speed(speed_cms: u16) -> TestSpeed {
    TestSpeed {
        session: SESSION,
        channels: 3,
        backward: 0,
        speed_cms,
        accel_mms2: 0,
    }
}

pub fn answer_to(bench: &mut Bench, request: impl Into<Message>) -> Answer {
    answer_within(0.1, bench, request)
}

/// The answer to a request, the only one within this time, s.
pub fn answer_within(time_s: f64, bench: &mut Bench, request: impl Into<Message>) -> Answer {
    let request = request.into();
    bench.answers.clear();
    bench.send(request);
    bench.run(time_s);
    bench
        .answers
        .retain(|answer| !matches!(answer, Message::TrainState(_)));
    match bench.answers[..] {
        [Message::StimulusAnswer(answer)] => answer.answer,
        ref other => panic!("{request:?}: {other:?}"),
    }
}

#[test]
fn arming_needs_the_key() {
    let mut bench = Bench::new(&[]);
    assert_eq!(arm(&mut bench), Some(ArmRefusal::KeyOff));
    assert_eq!(answer_to(&mut bench, CODE_75), Answer::NotArmed);
    bench.run(1.0);
    assert_eq!(
        bench.output.limit_cms, 0,
        "a stimulus on an unarmed unit does nothing"
    );
}

#[test]
fn a_test_code_sets_the_limit_until_the_tester_falls_silent() {
    let mut bench = armed();
    assert_eq!(answer_to(&mut bench, CODE_75), Answer::Accepted);
    bench.run(1.0);
    assert_eq!(bench.output.limit_cms, 2083);
    assert_eq!(bench.status.test_code_rate_chz, 1000, "read back");
    bench.keep_alive = false;
    bench.run(1.2);
    bench.keep_alive = true;
    bench.run(0.3);
    assert!(
        bench.status.test_signals.is_empty(),
        "taken away within a second"
    );
    bench.run(1.0);
    assert_eq!(bench.output.limit_cms, 0);
    assert!(bench.events().contains(&"arming_lapsed"));
}

#[test]
fn test_speed_replaces_the_tachometers_and_goes_without_a_fault() {
    let mut bench = armed();
    answer_to(&mut bench, CODE_75);
    assert_eq!(answer_to(&mut bench, test_speed(1500)), Answer::Accepted);
    bench.run(6.0);
    assert!(
        bench.output.speed_cms.abs_diff(1500) <= 2,
        "{}",
        bench.output.speed_cms
    );
    let session = SESSION;
    bench.send(Disarm { session });
    bench.run(1.0);
    assert_eq!(bench.output.speed_cms, 0);
    assert!(
        bench.has(Outputs::EB_RELAY),
        "no brake, no noise: {:?}",
        bench.events()
    );
}

#[test]
fn the_log_is_read_and_cleared() {
    let mut bench = armed();
    assert_eq!(
        bench.events(),
        ["power_up", "mode_changed", "eb_released", "armed"]
    );
    assert_eq!(
        answer_to(&mut bench, ClearLog { session: SESSION }),
        Answer::Accepted
    );
    assert_eq!(bench.events(), ["log_cleared"]);
    assert_eq!(bench.log[0].index, 4, "indices go on");
}

/// What the unit sends stays below 400 bytes in each 50 ms, for 5 s.
pub fn stays_within_its_bytes(bench: &mut Bench) {
    for _ in 0..100 {
        let scan = |_| {
            bench.scan();
            bench.sent.len()
        };
        let bytes: usize = (0..5).map(scan).sum();
        assert!(bytes < 400, "{bytes} bytes in 50 ms");
    }
}

#[test]
fn a_cycle_stays_within_its_bytes() {
    let mut bench = armed();
    bench.send(ReadLog { from_index: 0 });
    stays_within_its_bytes(&mut bench);
}

#[test]
fn train_state_comes_only_to_a_tester_that_subscribed() {
    let mut bench = Bench::new(&[]);
    bench.run(1.0);
    assert!(bench.answers.is_empty(), "{:?}", bench.answers);
    bench.send(Subscribe { changes: 0 });
    bench.run(1.0);
    let count = bench.answers.len();
    assert!((19..=21).contains(&count), "{count} in a second");
    bench.run(1.0);
    assert_eq!(bench.answers.len(), count, "lapses after a second");
}

#[test]
fn a_change_is_told_in_its_scan() {
    let mut bench = armed();
    bench.station = None;
    bench.run(1.5);
    bench.send(CODE_75);
    bench.send(Subscribe { changes: 1 });
    bench.run(0.1);
    bench.answers.clear();
    bench.until(1.0, |bench| bench.output.limit_cms == 2083);
    match bench.answers.last() {
        Some(Message::TrainState(state)) => {
            assert_eq!((state.limit_cms, state.held), (2083, 0));
            assert_eq!(state.outputs, bench.output.outputs);
        }
        other => panic!("{other:?}"),
    }
}

/// Goal: without a harness the line from the unit stays below 400 bytes in any 50 ms while all changes all the time and
/// the log is read, and below 230, 40 % of what the line carries, while nothing changes.
#[test]
fn a_tester_without_harness_gets_all_within_its_bytes() {
    for (changing, most) in [(false, 230), (true, 400)] {
        let mut bench = armed();
        let mut scans = Vec::new();
        for i in 0..500 {
            if i % 20 == 0 {
                bench.send(Subscribe { changes: 1 });
                bench.send(ReadLog { from_index: 0 });
            }
            bench.station = bench.station.filter(|_| changing);
            if changing {
                bench.input.lines.toggle(TrainLines::DOORS_CLOSED);
                bench.input.lines.toggle(TrainLines::BACKWARD);
            }
            bench.scan();
            scans.push(bench.ptu_bytes());
        }
        // The loss of the station data is a change.
        for window in scans[150..].windows(5) {
            let sum: usize = window.iter().sum();
            assert!(sum <= most, "{sum} bytes in 50 ms: {window:?}");
        }
    }
}

/// Goal: no bytes and no message make the unit panic or hang, in whatever state it is. Method: on a unit that is
/// fresh, one in service and an armed one, damaged bytes come as they are and, where they are a message, in a frame
/// that is sound; a scan follows each.
#[test]
fn bytes_and_messages_may_be_anything() {
    let payloads = CATALOGUE.iter().map(|spec| {
        let fields = (1..spec.payload_len()).map(|place| place as u8);
        let head = [spec.channel.code(), spec.code];
        head.into_iter().chain(fields).collect::<Vec<u8>>()
    });
    let payloads: Vec<_> = payloads.collect();
    type State = (&'static str, fn() -> Bench);
    let states: [State; 3] = [
        ("unit-fresh", || Bench::unfed(&[])),
        ("unit-in-service", || {
            let mut bench = Bench::new(&[]);
            bench.run(3.0);
            bench
        }),
        ("unit-armed", armed),
    ];
    for (name, state) in states {
        let mut bench = state();
        let mut fed = 0;
        let fuzz = fuzzing::Fuzz::new(name, env!("CARGO_MANIFEST_DIR"), payloads.iter().cloned());
        fuzz.run(20_000, |bytes| {
            fed += 1;
            // Most of what is refused ends what it was about.
            if fed % 500 == 0 {
                bench = state();
            }
            let (channel, payload) = bytes.split_first().unwrap_or((&0, &[]));
            let channel = Channel::from_code(*channel);
            match channel.and_then(|channel| Message::decode(channel, payload).ok()) {
                Some(message) => bench.send(message),
                None => bench.unit.receive(bytes),
            }
            bench.scan();
            bench.answers.clear();
            bench.log.clear();
        });
    }
}
