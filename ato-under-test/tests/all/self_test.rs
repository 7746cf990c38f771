//! The self-test that an armed tester asks for.

use crate::common::{Bench, all, fault, fault_from};
use crate::maintenance::{CODE_75, SESSION, answer_to, armed_with};
use protocol::Instant;
use protocol::injection::{Effect, FaultMode, Occurrence, Place};
use protocol::message::{
    Answer, ArmRefusal, ArmState, Disarm, Outputs, RunSelfTest, SelfTest, SelfTestEnd, SelfTestItem,
};

const REQUEST: RunSelfTest = RunSelfTest { session: SESSION };

/// Armed, on a train whose TCMS holds the full service brake, so that the emergency brake is released.
fn held(faults: &[FaultMode]) -> Bench {
    let mut bench = armed_with(faults);
    bench.tcms_obeys = true;
    bench.run(0.5);
    assert!(bench.has(Outputs::EB_RELAY), "{:?}", bench.status.eb_cause);
    bench
}

/// Asks for a self-test and waits for its end.
fn tested(bench: &mut Bench) -> (Vec<SelfTestItem>, SelfTestEnd) {
    assert_eq!(answer_to(bench, REQUEST), Answer::Accepted);
    let ended = |bench: &Bench| bench.last::<SelfTestEnd>().is_some();
    bench.until(2.0, ended).expect("an end");
    let items: Vec<SelfTestItem> = all(&bench.answers);
    let end: SelfTestEnd = bench.last().expect("its end");
    let failed = items.iter().filter(|item| item.passed == 0);
    let failed = failed.fold(SelfTest::empty(), |all, item| all | item.item);
    assert_eq!(failed, end.failed);
    (items, end)
}

/// A fault that sets in when the tester is armed.
fn later(place: Place, effect: Effect) -> FaultMode {
    fault_from(place, effect, 4.0)
}

#[test]
fn a_sound_unit_passes_each_item_by_name_with_its_value_as_often_as_asked() {
    let mut bench = held(&[]);
    answer_to(&mut bench, CODE_75);
    bench.run(1.0);
    let events = bench.events();
    for _ in 0..5 {
        let (items, end) = tested(&mut bench);
        let items: Vec<_> = items
            .iter()
            .map(|item| {
                let names = SelfTest::SPEC.entries.iter();
                let name = names.filter(|(bit, ..)| item.item.bits() == 1 << bit);
                let name = name.map(|(_, name, _)| *name).next().unwrap();
                (name, item.value, (item.low, item.high), item.unit.label())
            })
            .collect();
        let expected = [
            ("MEMORY", 0, (0, 0), "bytes"),
            ("CONFIGURATION", 0, (0, 0), "errors"),
            ("TRACK_DATABASE", 0, (0, 0), "errors"),
            ("EB_RELAY", 10, (1, 190), "ms"),
            ("ATP_RECEIVER", 410, (0, 500), "ms"),
            ("TRA", 10, (10, 10), "answers"),
            ("TWC_MODEM", 10, (10, 10), "frames"),
            ("TEST_BOARD", 10, (10, 10), "answers"),
            ("TWC_CPU", 10, (10, 10), "frames"),
            ("TCMS_LINK", 10, (10, 10), "frames"),
        ];
        assert_eq!(items, expected);
        assert_eq!((end.failed, end.took_ms), (SelfTest::empty(), 600));
        assert_eq!(bench.output.limit_cms, 2083, "the code stays in force");
        assert!(bench.has(Outputs::EB_RELAY), "the brake is released again");
    }
    assert_eq!(bench.events(), events, "nothing is logged");
}

#[test]
fn each_part_that_fails_later_fails_its_item_and_the_log_names_it() {
    let cases = [
        (Place::Memory, Effect::StuckOn, SelfTest::MEMORY, 4),
        (Place::EbRelay, Effect::StuckOn, SelfTest::EB_RELAY, 460),
        // The relay drops, as nothing energises it.
        (Place::EbRelay, Effect::StuckOff, SelfTest::EB_RELAY, 0),
        (
            Place::EbRelay,
            Effect::Delay { ms: 300 },
            SelfTest::EB_RELAY,
            310,
        ),
        (
            Place::AtpReceiver,
            Effect::Dead,
            SelfTest::ATP_RECEIVER,
            601,
        ),
        (
            Place::AtpReceiver,
            Effect::Gain { factor: 0.7 },
            SelfTest::ATP_RECEIVER,
            601,
        ),
        (
            Place::AtpReceiver,
            Effect::Limit { to: 15.0 },
            SelfTest::ATP_RECEIVER,
            601,
        ),
        (Place::Tra, Effect::Dead, SelfTest::TRA, 0),
        (Place::FskReceiver, Effect::Dead, SelfTest::TWC_MODEM, 0),
        (Place::FskTransmitter, Effect::Dead, SelfTest::TWC_MODEM, 0),
        (Place::TwcCpu, Effect::Dead, SelfTest::TWC_CPU, 0),
        (
            Place::TwcCpu,
            Effect::Delay { ms: 900 },
            SelfTest::TWC_CPU,
            0,
        ),
        (
            Place::TwcCpu,
            Effect::Offset { by: 1.0 },
            SelfTest::TWC_CPU,
            0,
        ),
        (Place::TcmsReceiver, Effect::Dead, SelfTest::TCMS_LINK, 0),
        (Place::TcmsTransmitter, Effect::Dead, SelfTest::TCMS_LINK, 0),
    ];
    for (place, effect, item, value) in cases {
        let mut bench = held(&[later(place, effect)]);
        bench.until(5.0, |bench| bench.now >= Instant::from_ms(4_500));
        let (items, end) = tested(&mut bench);
        assert_eq!(end.failed, item, "{place:?} {effect:?}");
        let found = items.iter().find(|one| one.item == item).unwrap();
        assert!(
            found.value.abs_diff(value) <= 20,
            "{place:?} {effect:?}: {}",
            found.value
        );
        let entries = bench.events();
        assert!(entries.contains(&"self_test_failed"), "{entries:?}");
        assert_eq!(
            bench.status.self_test,
            SelfTest::empty(),
            "start-up had passed"
        );
        let open = (place, effect) == (Place::EbRelay, Effect::StuckOff);
        assert_eq!(entries.contains(&"eb_relay_open"), open, "{entries:?}");
    }
}

/// Start-up is content with one answer: a part that works at times does not keep the train from running.
#[test]
fn on_request_each_test_must_be_answered() {
    let half = |place| fault(place, Effect::BitErrors { rate: 0.5 });
    let mut bench = armed_with(&[half(Place::Tra), half(Place::FskReceiver)]);
    assert_eq!(bench.status.self_test, SelfTest::empty());
    let (items, end) = tested(&mut bench);
    assert_eq!(end.failed, SelfTest::TRA | SelfTest::TWC_MODEM);
    for item in items.iter().filter(|item| item.passed == 0) {
        assert!((1..10).contains(&item.value), "{item:?}");
    }
}

#[test]
fn a_part_that_comes_and_goes_is_found_by_one_of_several_tests() {
    let fades = FaultMode {
        occurs: Occurrence::AtTimes {
            on_s: 1.5,
            off_s: 6.0,
        },
        ..fault(Place::FskReceiver, Effect::BitErrors { rate: 1.0 })
    };
    let mut bench = armed_with(&[fades]);
    let found = (0..10).filter(|_| {
        bench.run(3.0);
        !tested(&mut bench).1.failed.is_empty()
    });
    assert!((1..10).contains(&found.count()));
}

#[test]
fn it_needs_an_armed_session_and_ends_with_it() {
    let mut bench = Bench::new(&[]);
    assert_eq!(answer_to(&mut bench, REQUEST), Answer::NotArmed);
    let mut bench = held(&[]);
    assert_eq!(answer_to(&mut bench, REQUEST), Answer::Accepted);
    bench.send(Disarm { session: SESSION });
    bench.run(2.0);
    let lapsed: ArmState = bench.last().expect("the notice");
    assert_eq!(lapsed.refusal, ArmRefusal::Disarmed);
    assert_eq!(bench.last::<SelfTestItem>(), None, "{:?}", bench.answers);
    assert!(bench.has(Outputs::EB_RELAY), "the relay is not kept off");
}
