//! The tester's session: identity, arming, stimuli and log, over a good line and a bad one.

use protocol::Speed;
use protocol::message::{Answer, ArmRefusal, Channel, Message};
use protocol::signal::Signal;

use super::{FakeUnit, bench, link_error};
use crate::procedure::EventSource;
use crate::procedure::Refusal;
use crate::rig::session::MAX_EVENTS;
use crate::stimulus::Stimulus;

const TEST_SPEED: Stimulus = Stimulus::PtuSpeed {
    channels: 3,
    backward: false,
    to: Speed::from_mps(5.0),
    accel_mps2: 1.0,
};

fn refusal(text: &str) -> Result<(), Refusal> {
    Err(Refusal(text.to_owned()))
}

#[test]
fn a_unit_is_identified_and_its_signals_become_known() {
    let mut bench = bench(FakeUnit::default());
    assert!(bench.rig.sample().get(Signal::Eb).is_none());
    bench.run_ms(4000);
    let sample = bench.rig.sample();
    let unknown: Vec<_> = Signal::ALL
        .iter()
        .filter(|&&s| sample.get(s).is_none())
        .map(|s| s.name())
        .collect();
    // No section lies along the way, and no orders are given.
    let of_orders = [
        "orders_answered",
        "own_train",
        "number_state",
        "destination",
        "order_state",
        "twc_heard",
        "twc_refused",
        "twc_others",
    ];
    assert_eq!(unknown, [&["to_stop"], &of_orders[..]].concat());
    assert_eq!(sample.get(Signal::Eb), Some(0.0));
    assert_eq!(sample.get(Signal::EbLoop), Some(0.0));
    assert!(bench.rig.identity().is_some());
    assert_eq!(bench.rig.link_error(), None);
    assert!(bench.rig.safe());
}

#[test]
fn arming_and_a_stimulus_go_through_and_making_safe_ends_them() {
    let mut bench = bench(FakeUnit::default());
    assert_eq!(bench.settle(Stimulus::PtuArm), Ok(()));
    assert_eq!(bench.settle(TEST_SPEED), Ok(()));
    bench.run_ms(2000);
    assert!(bench.link.armed());
    let alive = bench.link.heard.iter().rev().find_map(|m| match m {
        Message::KeepAlive(alive) => Some(alive.session),
        _ => None,
    });
    assert_ne!(
        alive,
        Some(0),
        "an armed session is kept alive under its number"
    );
    bench.make_safe();
    assert!(!bench.rig.safe());
    bench.run_ms(500);
    assert!(bench.rig.safe() && !bench.link.armed());
    assert!(
        bench
            .link
            .heard
            .iter()
            .any(|m| matches!(m, Message::TestRelease(_)))
    );
}

#[test]
fn refusals_name_the_request_and_the_reason() {
    let mut bench = bench(FakeUnit::default());
    assert_eq!(
        bench.settle(TEST_SPEED),
        refusal("unit refused the test speed: not_armed")
    );
    bench.link.refusal = ArmRefusal::KeyOff;
    assert_eq!(
        bench.settle(Stimulus::PtuArm),
        refusal("the unit refused to arm: key_off")
    );
    bench.link.refusal = ArmRefusal::None;
    assert_eq!(bench.settle(Stimulus::PtuArm), Ok(()));
    bench.link.answer = Answer::OutOfRange;
    let marker = Stimulus::PtuMarker { psm: 9 };
    assert_eq!(
        bench.settle(marker),
        refusal("unit refused the test marker: out_of_range")
    );
    // The next stimulus ends the matter.
    bench.apply(Stimulus::CodeOff);
    assert_eq!(bench.rig.settled(), Ok(true));
}

#[test]
fn a_starting_unit_is_waited_for() {
    let mut bench = bench(FakeUnit::with(|it| it.refusal = ArmRefusal::StartingUp));
    bench.apply(Stimulus::PtuArm);
    bench.run_ms(1500);
    assert_eq!(bench.rig.settled(), Ok(false));
    bench.link.refusal = ArmRefusal::None;
    bench.run_ms(500);
    assert_eq!(bench.rig.settled(), Ok(true));
    assert!(bench.link.armed());
}

#[test]
fn a_unit_that_never_answers_is_given_up_and_a_bench_still_becomes_safe() {
    let mut bench = bench(FakeUnit::default());
    assert_eq!(bench.settle(Stimulus::PtuArm), Ok(()));
    bench.link.dead = vec![Channel::Ptu];
    let text = "the unit did not answer the test speed within 900 ms";
    assert_eq!(bench.settle(TEST_SPEED), refusal(text));
    bench.make_safe();
    bench.run_ms(3000);
    assert!(bench.rig.safe());
    let error = link_error(&bench);
    assert!(
        error.starts_with("unit silent for 3.") && error.ends_with("PTU channel"),
        "{error}"
    );
}

/// Frames lost each way: requests are repeated, the log arrives whole and in order.
#[test]
fn a_bad_line_loses_nothing() {
    let mut bench = bench(FakeUnit::with(|it| it.loss = 0.1));
    let mut armed = 0;
    for _ in 0..10 {
        armed += u32::from(bench.settle(Stimulus::PtuArm).is_ok());
        let _ = bench.settle(Stimulus::PtuDisarm);
    }
    assert!(armed >= 8, "{armed} of 10");
    bench.link.loss = 0.3;
    (0..150).for_each(|i| bench.link.log_event(i));
    let mut events = Vec::new();
    for _ in 0..600 {
        bench.run_ms(100);
        events.extend(bench.rig.take_events());
    }
    // TCMS misses the unit's frames, too, and says so in a log of its own.
    events.retain(|event| event.source == EventSource::Unit);
    assert!(bench.rig.log_up_to_date());
    assert_eq!(
        events.iter().map(|e| e.index).collect::<Vec<_>>(),
        (0..150).collect::<Vec<_>>()
    );
}

#[test]
fn log_entries_come_once_each_and_overwritten_ones_are_counted() {
    let mut unit = FakeUnit::with(|it| it.oldest = 40);
    (0..5).for_each(|_| unit.log_event(7));
    let mut bench = bench(unit);
    bench.run_ms(2000);
    assert_eq!(bench.rig.events_at_contact(), Some(45));
    bench.link.log_event(8);
    bench.run_ms(500);
    let indices: Vec<_> = bench.rig.take_events().iter().map(|e| e.index).collect();
    assert_eq!(indices, [40, 41, 42, 43, 44, 45]);
    assert_eq!(bench.rig.events_overwritten(), 40);
    bench.run_ms(500);
    assert!(bench.rig.take_events().is_empty());
}

/// Nobody takes the events: reading stops at the bound and goes on when they are taken.
#[test]
fn events_wait_in_the_unit_when_nobody_takes_them() {
    let mut unit = FakeUnit::default();
    (0..700).for_each(|_| unit.log_event(1));
    let mut bench = bench(unit);
    bench.run_ms(30_000);
    assert_eq!(bench.rig.take_events().len(), MAX_EVENTS);
    bench.run_ms(30_000);
    assert_eq!(bench.rig.take_events().len(), 700 - MAX_EVENTS);
}

#[test]
fn a_restart_is_noticed_and_the_new_log_read_from_its_beginning() {
    let mut unit = FakeUnit::default();
    (0..9).for_each(|_| unit.log_event(1));
    let mut bench = bench(unit);
    assert_eq!(bench.settle(Stimulus::PtuArm), Ok(()));
    bench.run_ms(3000);
    assert_eq!(bench.rig.take_events().len(), 9);
    bench.link.restart();
    bench.link.log_event(100);
    bench.link.log_event(101);
    bench.run_ms(4000);
    let codes: Vec<_> = bench
        .rig
        .take_events()
        .iter()
        .filter(|e| e.source == EventSource::Unit)
        .map(|e| (e.index, e.code))
        .collect();
    assert_eq!(codes, [(0, 100), (1, 101)]);
    assert_eq!(
        (bench.rig.unit_restarts(), bench.rig.events_at_contact()),
        (1, Some(0))
    );
    assert!(bench.rig.safe(), "no longer armed");
}

/// The count of events does not fall, but the uptime does.
#[test]
fn a_restart_with_a_full_log_is_noticed_by_the_uptime() {
    let mut bench = bench(FakeUnit::default());
    bench.run_ms(3000);
    bench.link.restart();
    bench.run_ms(4000);
    assert_eq!(bench.rig.unit_restarts(), 1);
}

#[test]
fn a_silent_tester_sends_nothing_and_takes_no_request() {
    let mut bench = bench(FakeUnit::default());
    bench.run_ms(1000);
    bench.apply(Stimulus::PtuSilent { on: true });
    let ptu = |bench: &crate::rig::Bench<FakeUnit>| {
        bench
            .link
            .heard
            .iter()
            .filter(|m| m.channel() == Channel::Ptu)
            .count()
    };
    let before = ptu(&bench);
    bench.run_ms(5000);
    assert_eq!(ptu(&bench), before);
    assert!(!bench.rig.safe());
    bench.refusal(Stimulus::PtuArm);
    bench.apply(Stimulus::PtuSilent { on: false });
    bench.run_ms(500);
    assert!(ptu(&bench) > before && bench.rig.safe());
}
