//! The rig on a unit of which only the maintenance port is connected.

use std::sync::Arc;

use protocol::message::{
    ArmRefusal, ArmState, Channel, Identity, Message, ModeSwitch, Outputs, TrainLines, TrainState,
};
use protocol::signal::Signal;

use super::fake_unit::FakeUnit;
use super::{Bench, config, line, rig};
use crate::procedure::plan::Connection;
use crate::procedure::{Finding, Procedure, Scripts};
use crate::rig::Harness;
use crate::stimulus::Stimulus;
use crate::train::TrainData;

fn reached(asked: Harness, unit: FakeUnit) -> Bench<FakeUnit> {
    let mut rig = rig(1);
    rig.set_harness(asked);
    let mut bench = Bench::new(rig, unit);
    bench.run_ms(4000);
    bench
}

fn aboard() -> FakeUnit {
    FakeUnit::with(|it| it.harness = false)
}

/// A procedure of one step that looks at these.
fn procedure(needs: &str, expect: &str) -> Arc<Procedure> {
    let text =
        format!("procedure(title = \"T\", needs = \"{needs}\")\nstep(\"s\", expect = {expect})\n");
    let scripts = Scripts::from([("p.star".to_owned(), text)]);
    let loaded = crate::procedure::loader::load(&scripts, &config(), &line(), &TrainData::line6());
    assert!(loaded.errors.is_empty(), "{:?}", loaded.errors);
    loaded.procedures[0].clone()
}

/// Goal: nothing but the tester's frames goes to a unit on a train. Method: one that sends `Status` and no
/// `IoOutput`.
#[test]
fn without_a_harness_only_the_tester_speaks() {
    let mut bench = reached(Harness::Auto, aboard());
    assert_eq!(bench.rig.connection(), Some(Connection::Ptu));
    assert_eq!(bench.rig.link_error(), None);
    let counters = &bench.link.link.counters();
    for channel in [Channel::Io, Channel::Tcms, Channel::Twc] {
        assert_eq!(counters.accepted(channel), 0, "{channel:?}");
    }
    assert!(counters.accepted(Channel::Ptu) > 0);
    let why = bench.refusal(Stimulus::Hcr { on: false });
    assert!(
        why.contains("only the maintenance port is connected"),
        "{why}"
    );
    assert_eq!(bench.settle(Stimulus::PtuArm), Ok(()));
    assert!(bench.rig.sample().get(Signal::CarrierHz).is_none());
    assert!(bench.rig.sample().get(Signal::TrainSpeed).is_none());
}

#[test]
fn what_a_harness_would_show_is_as_the_unit_tells_it() {
    let train_state = TrainState {
        outputs: Outputs::FSB,
        asked: Outputs::EB_RELAY,
        limit_cms: 1528,
        lines: TrainLines::DOORS_CLOSED | TrainLines::MAINTENANCE_KEY,
        mode_switch: ModeSwitch::Manual,
        effort: -500,
        marker: 3,
        ..TrainState::default()
    };
    let unit = FakeUnit {
        train_state,
        ..aboard()
    };
    let mut bench = reached(Harness::Auto, unit);
    let sample = bench.rig.sample();
    for (signal, value) in [
        (Signal::Eb, 1.0),
        (Signal::AskedEb, 0.0),
        (Signal::Fsb, 1.0),
        (Signal::Doors, 1.0),
        (Signal::MaintenanceKey, 1.0),
        (Signal::EbLoop, 1.0),
        (Signal::ModeSwitch, 2.0),
        (Signal::Effort, -500.0),
        (Signal::Marker, 3.0),
    ] {
        assert_eq!(sample.get(signal), Some(value), "{}", signal.name());
    }
    bench.link.subscribed = false;
    bench.link.tells_train_state = false;
    bench.run_ms(1000);
    let sample = bench.rig.sample();
    for signal in [Signal::Eb, Signal::Doors, Signal::AskedEb, Signal::Effort] {
        assert!(sample.get(signal).is_none(), "{}", signal.name());
    }
}

#[test]
fn a_unit_that_sends_its_contacts_is_on_a_bench() {
    let bench = reached(Harness::Auto, FakeUnit::default());
    assert_eq!(bench.rig.connection(), Some(Connection::Btu));
    assert_eq!(bench.rig.link_error(), None);
    assert!(bench.rig.sample().get(Signal::CarrierHz).is_some());
}

/// Goal: an older unit is asked a few times and works on; what it cannot tell is said, by its software.
#[test]
fn an_older_unit_says_less_and_is_not_asked_for_ever() {
    let identity = Identity {
        software: [0, 1, 0],
        ..Identity::default()
    };
    for (unit, untold) in [(aboard(), "limit"), (FakeUnit::default(), "")] {
        let unit = FakeUnit {
            tells_train_state: false,
            identity,
            ..unit
        };
        let mut bench = reached(Harness::Auto, unit);
        bench.run_ms(5000);
        let asked = bench.link.heard.iter();
        let asked = asked.filter(|message| matches!(message, Message::Subscribe(_)));
        assert_eq!(asked.count(), 4);
        assert!(bench.rig.knows_what_is_told());
        let limit = procedure("ptu", "becomes(limit, kmh(0))");
        let why = bench.rig.cannot_run(&limit);
        let why = why.map(|why| why.to_string()).unwrap_or_default();
        assert_eq!(why.is_empty(), untold.is_empty(), "{why}");
        assert!(why.ends_with(untold), "{why}");
        if !why.is_empty() {
            assert_eq!(why, "this unit, software 0.1.0, does not tell limit");
        }
        let status = procedure("ptu", "becomes(started, True)");
        assert_eq!(bench.rig.cannot_run(&status), None);
    }
}

#[test]
fn a_procedure_of_a_bench_is_not_run_on_a_train() {
    let bench = reached(Harness::None, aboard());
    let why = bench
        .rig
        .cannot_run(&procedure("harness", "becomes(eb, \"released\")"));
    assert_eq!(why, Some(Finding::NeedsHarness));
    let bench = reached(Harness::Bench, FakeUnit::default());
    for needs in ["harness", "ptu"] {
        let procedure = procedure(needs, "becomes(eb, \"released\")");
        assert_eq!(bench.rig.cannot_run(&procedure), None, "{needs}");
    }
}

/// Act of others on the unit, as the runner tells it.
fn intervention(bench: &mut Bench<FakeUnit>) -> Option<String> {
    let what = bench.rig.take_intervention();
    what.map(|what| what.to_string())
}

/// Goal: what people do to a unit on a train while it is tested is reported, once, and is not taken for what a bench
/// did. Method: the unit ends the session, also while a request waits for its answer; then it is powered off and on.
#[test]
fn what_others_do_to_the_unit_is_told() {
    let mut bench = reached(Harness::Auto, aboard());
    for asks in [false, true] {
        assert_eq!(bench.settle(Stimulus::PtuArm), Ok(()));
        assert_eq!(bench.rig.take_intervention(), None);
        if asks {
            bench.link.dead = vec![Channel::Ptu];
            bench.apply(Stimulus::PtuRelease);
            bench.run_ms(100);
            bench.link.dead.clear();
        }
        let session = bench.link.session.expect("armed");
        bench.link.session = None;
        let notice = ArmState {
            session,
            armed: 0,
            refusal: ArmRefusal::KeyOff,
        };
        let now = bench.now();
        let mut frame = Vec::new();
        bench.link.link.send(now, &notice.into(), &mut frame);
        bench.rig.receive(now, &frame);
        assert_eq!(
            intervention(&mut bench).as_deref(),
            Some("the unit ended test mode by itself: the maintenance key was turned off")
        );
        assert_eq!(bench.rig.take_intervention(), None);
    }
    bench.link.restart();
    bench.link.harness = false;
    bench.run_ms(4000);
    assert_eq!(
        intervention(&mut bench).as_deref(),
        Some("the unit was started again: its supply was interrupted")
    );
    assert_eq!(bench.rig.take_intervention(), None);
}
