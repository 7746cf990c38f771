//! Promises of the unit while a tester is armed: the train stands and stays braked, whatever test signals say, and
//! no test signal is left afterwards.

use crate::common::{Bench, all, confirm, departure, fault, line, signal_of, test_station};
use crate::maintenance::{CODE_75, SESSION, arm, test_speed};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use protocol::injection::{Effect, FaultMode, Place};
use protocol::message::{
    ArmRefusal, ArmRequest, ArmState, AtcToTcmsBits, Disarm, DoorSide, EbCause, Message, Mode,
    ModeSwitch, Outputs, Status, StatusBits, Subscribe, TestCode, TestMarker, TestRelease,
    TestSignals, TestSpeed, TestTwc, TrainLines, TrainState, TwcWayside,
};

const DOORS: Outputs = Outputs::DOOR_ENABLE_LEFT.union(Outputs::DOOR_ENABLE_RIGHT);

/// A train that stands under no code, its service brake on, with the key turned.
fn keyed(faults: &[FaultMode]) -> Bench {
    let mut bench = Bench::new(faults);
    bench.tcms_obeys = true;
    bench.input.lines.insert(TrainLines::MAINTENANCE_KEY);
    bench.run(0.3);
    bench
}

fn armed(faults: &[FaultMode]) -> Bench {
    let mut bench = keyed(faults);
    assert_eq!(arm(&mut bench), None);
    bench
}

fn test_code(name: &str) -> TestCode {
    let (carrier_hz, code_rate_chz) = signal_of(name);
    TestCode {
        carrier_hz,
        code_rate_chz,
        ..CODE_75
    }
}

fn test_departure() -> TestTwc {
    let data = TwcWayside {
        door_side: DoorSide::Right,
        departure: 1,
        ..departure(&line().sections[0])
    };
    test_station(SESSION, data)
}

/// Armed in automatic mode, with a test code and a test departure, the start button just pressed.
fn departing(faults: &[FaultMode]) -> Bench {
    let mut bench = keyed(faults);
    bench.input.mode_switch = ModeSwitch::Automatic;
    bench.run(0.5);
    assert_eq!(arm(&mut bench), None);
    bench.send(test_code("75"));
    bench.send(test_departure());
    bench.run(2.0);
    bench.input.lines.insert(TrainLines::START);
    bench
}

/// Invariants in every scan while a tester is armed.
fn held(bench: &Bench) -> Result<(), String> {
    let outputs = bench.output.outputs;
    let to_tcms = &bench.to_tcms;
    let broken = [
        (
            !outputs.contains(Outputs::FSB),
            "full service brake released",
        ),
        (!outputs.contains(Outputs::POWER_CUT), "power not cut"),
        (outputs.intersects(DOORS), "doors enabled"),
        (to_tcms.effort > 0, "effort for traction"),
        (to_tcms.bits.contains(AtcToTcmsBits::POWER), "power ordered"),
        (to_tcms.mode == Mode::AutomaticRun, "the train is driven"),
    ];
    match broken.iter().find(|(broken, _)| *broken) {
        Some((_, what)) => Err(format!("{what}: {outputs:?} {to_tcms:?}")),
        None => Ok(()),
    }
}

#[test]
fn arming_is_refused_with_its_reason() {
    let mut rolling = keyed(&[]);
    rolling.speed_kmh(2.0);
    assert_eq!(arm(&mut rolling), Some(ArmRefusal::Moving));

    let mut open = keyed(&[]);
    open.input.lines.remove(TrainLines::DOORS_CLOSED);
    open.run(0.1);
    assert_eq!(arm(&mut open), Some(ArmRefusal::DoorsOpen));

    // A relay that is welded, and a train whose TCMS does not order the service brake.
    let mut released = keyed(&[fault(Place::EbRelay, Effect::StuckOn)]);
    released.tcms_obeys = false;
    released.run(0.3);
    released.welded = true;
    assert_eq!(arm(&mut released), Some(ArmRefusal::BrakesReleased));
}

/// An open line proves nothing on a train whose emergency brake is cut out, and TCMS that is there says so.
#[test]
fn a_train_whose_brakes_are_cut_out_is_not_armed_and_does_not_stay_armed() {
    let mut cut_out = keyed(&[]);
    cut_out.tcms_obeys = false;
    cut_out.eb_cut_out = true;
    cut_out.run(0.3);
    assert_eq!(arm(&mut cut_out), Some(ArmRefusal::BrakesReleased));

    let cut_out_later = |faults: &[FaultMode]| {
        let mut bench = armed(faults);
        bench.tcms_obeys = false;
        bench.eb_cut_out = true;
        bench.run(1.5);
        bench
    };
    let bench = cut_out_later(&[]);
    assert!(!bench.armed && bench.braking());
    assert_eq!(bench.status.eb_cause, EbCause::TestMode);
    assert!(cut_out_later(&[fault(Place::ArmBrakes, Effect::Dead)]).armed);
}

/// Without a TCMS that says it brakes, the emergency brake proves it, and is held.
#[test]
fn a_train_without_tcms_is_armed_under_the_emergency_brake() {
    let mut bench = keyed(&[]);
    bench.tcms = None;
    bench.run(1.0);
    assert!(!bench.braking(), "only the service brake so far");
    assert_eq!(arm(&mut bench), None);
    bench.run(1.0);
    assert!(bench.braking());
    assert_eq!(bench.status.eb_cause, EbCause::TestMode);
}

#[test]
fn code_station_data_and_start_do_not_drive_the_train() {
    let mut bench = armed(&[]);
    bench.send(test_code("75"));
    bench.send(test_departure());
    for _ in 0..500 {
        bench.scan();
        held(&bench).unwrap();
    }
    assert_eq!(
        bench.output.limit_cms, 2083,
        "the functions under test see the code"
    );
    assert!(bench.status.bits.contains(StatusBits::STATION_VALID));
}

#[test]
fn the_train_in_automatic_mode_is_not_driven_by_a_test_departure() {
    let mut bench = departing(&[]);
    let mut would = false;
    for _ in 0..1000 {
        bench.scan();
        held(&bench).unwrap();
        would |= bench.status.mode == Mode::AutomaticRun && bench.status.effort > 0;
    }
    assert!(
        would,
        "the functions under test would drive: {:?}",
        bench.status.refusals
    );
}

/// Each thing that ends test mode: armed until then, then disarmed, braked and logged within 100 ms.
#[test]
fn motion_code_mode_and_key_end_it_with_the_emergency_brake() {
    type Change = fn(&mut Bench);
    let changes: [(ArmRefusal, Change); 5] = [
        (ArmRefusal::TrainMoved, |bench| bench.speeds = [1.0; 2]),
        (ArmRefusal::TrainMoved, |bench| bench.speeds = [0.0, -0.3]),
        (ArmRefusal::CodeChanged, |bench| bench.code("35")),
        (ArmRefusal::ModeChanged, |bench| {
            bench.input.mode_switch = ModeSwitch::Yard
        }),
        (ArmRefusal::KeyOff, |bench| {
            bench.input.lines.remove(TrainLines::MAINTENANCE_KEY)
        }),
    ];
    for (refusal, change) in changes {
        let mut bench = armed(&[]);
        bench.send(test_speed(0));
        bench.run(1.0);
        assert!(bench.armed && !bench.braking(), "{refusal:?}");
        change(&mut bench);
        let moving = refusal == ArmRefusal::TrainMoved;
        // A pulse is 27 mm: the second one tells the speed.
        let allowed_ms = if moving { 100 + 190 } else { 100 };
        let took = bench.until(1.0, |bench| bench.braking());
        assert!(
            took.is_some_and(|ms| ms <= allowed_ms),
            "{refusal:?}: {took:?}"
        );
        assert!(!bench.armed);
        bench.speeds = [0.0; 2];
        bench.run(0.1);
        assert_eq!(bench.status.eb_cause, EbCause::TestMode, "{refusal:?}");
        let lapsed: ArmState = bench.last().expect("the notice");
        assert_eq!(lapsed.refusal, refusal);
        assert!(bench.events().contains(&"test_mode_broken"), "{refusal:?}");
        bench.run(1.0);
        assert!(bench.braking(), "until it is acknowledged");
    }
}

#[test]
fn slow_motion_ends_it_after_thirty_centimetres() {
    let mut bench = armed(&[]);
    bench.speeds = [0.1; 2];
    let took = bench.until(5.0, |bench| bench.braking());
    let way_m = took.unwrap() as f64 / 1000.0 * 0.1;
    assert!((0.29..0.34).contains(&way_m), "{way_m} m");
}

#[test]
fn a_disarmed_unit_knows_what_it_knew_before() {
    let mut bench = armed(&[]);
    let known = |bench: &Bench| Status {
        bits: bench.status.bits.difference(StatusBits::ARMED),
        events: 0,
        rejected_frames: 0,
        twc_received: 0,
        fsb_cause: bench.status.fsb_cause,
        ..bench.status
    };
    bench.send(Disarm { session: SESSION });
    bench.run(0.5);
    let (before, limit) = (known(&bench), bench.output.limit_cms);
    assert_eq!(arm(&mut bench), None);
    bench.send(test_code("75"));
    bench.send(TestTwc {
        section: line().sections[1].section,
        ..test_departure()
    });
    bench.send(test_speed(2000));
    bench.run(8.0);
    bench.send(TestMarker {
        session: SESSION,
        marker: 3,
    });
    bench.run(3.0);
    assert_ne!((known(&bench), bench.output.limit_cms), (before, limit));
    bench.send(Disarm { session: SESSION });
    bench.run(0.02);
    assert_eq!(bench.output.limit_cms, limit);
    bench.run(1.0);
    assert_eq!(known(&bench), before);
}

/// Something a tester, a cab or a shunter does.
#[derive(Clone, Debug)]
enum Act {
    Ask(Message),
    Line(u8),
    Switch(u8),
    Lever(i8),
    Wheels(f64, f64),
    RailCode(usize),
    Tcms(bool),
    Silence(bool),
    Wait(u8),
}

fn ask(message: impl Into<Message>) -> Act {
    Act::Ask(message.into())
}

fn code_name(index: usize) -> String {
    crate::common::config().codes[index].name.clone()
}

fn any_code((carrier_hz, code_rate_chz, level_mv): (u16, u16, u16)) -> Act {
    ask(TestCode {
        session: SESSION,
        carrier_hz,
        code_rate_chz,
        level_mv,
    })
}

fn any_speed((channels, backward, speed_cms): (u8, u8, u16)) -> Act {
    ask(TestSpeed {
        channels,
        backward,
        ..test_speed(speed_cms)
    })
}

fn any_station((station, loop_id, side, departure): (u16, u16, u8, u8)) -> Act {
    ask(TestTwc {
        station,
        loop_id,
        door_side: DoorSide::from_code(side),
        departure,
        ..test_departure()
    })
}

fn act() -> impl Strategy<Value = Act> {
    let session = SESSION;
    let release = move |bits| {
        let signals = TestSignals::from_bits_retain(bits);
        ask(TestRelease { session, signals })
    };
    prop_oneof![
        1 => (any::<u16>(), any::<u16>(), any::<u16>()).prop_map(any_code),
        3 => (0usize..7).prop_map(|index| ask(test_code(&code_name(index)))),
        3 => (0u8..5, 0u8..3, 0u16..3200).prop_map(any_speed),
        3 => (820u16..826, 8230u16..8242, 0u8..5, 0u8..3).prop_map(any_station),
        1 => (0u8..6).prop_map(move |marker| ask(TestMarker { session, marker })),
        1 => (0u16..16).prop_map(release),
        2 => (0u8..9).prop_map(Act::Line),
        1 => (0u8..7).prop_map(Act::Switch),
        1 => (-8i8..5).prop_map(Act::Lever),
        1 => (-3.0f64..3.0, -3.0f64..3.0).prop_map(|(a, b)| Act::Wheels(a, b)),
        1 => (0usize..7).prop_map(Act::RailCode),
        1 => any::<bool>().prop_map(Act::Tcms),
        2 => Just(ask(ArmRequest { session })),
        1 => Just(ask(Disarm { session })),
        1 => any::<bool>().prop_map(Act::Silence),
        4 => (1u8..40).prop_map(Act::Wait),
    ]
}

fn perform(bench: &mut Bench, act: &Act) {
    match *act {
        Act::Ask(message) => bench.send(message),
        Act::Line(bit) => bench
            .input
            .lines
            .toggle(TrainLines::from_bits_retain(1 << bit)),
        Act::Switch(code) => bench.input.mode_switch = ModeSwitch::from_code(code),
        Act::Lever(notch) => bench.input.controller = notch,
        Act::Wheels(one, two) => bench.speeds = [one, two],
        Act::RailCode(index) => bench.code(&code_name(index)),
        Act::Tcms(obeys) => bench.tcms_obeys = obeys,
        Act::Silence(on) => bench.keep_alive = !on,
        Act::Wait(_) => {}
    }
}

/// Plays acts to a unit that is armed; what test mode promises is looked at in every scan.
fn stays_held(bench: &mut Bench, acts: &[Act]) -> Result<(), String> {
    for act in acts {
        perform(bench, act);
        let scans = match act {
            Act::Wait(scans) => *scans,
            _ => 1,
        };
        for _ in 0..scans {
            bench.scan();
            for asked in all(&std::mem::take(&mut bench.answers)) {
                bench.send(confirm(asked, SESSION));
            }
            if bench.armed {
                held(bench).map_err(|what| format!("{what} after {act:?}"))?;
            }
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, max_shrink_iters: 2_000, ..ProptestConfig::default() })]

    /// Goal: while armed never a tractive effort, a released brake, a door enable to the train. Method: random test
    /// signals, real motions and orders on an armed unit, each scan looked at.
    #[test]
    fn no_sequence_of_stimuli_releases_an_armed_train(
        automatic in any::<bool>(),
        acts in prop::collection::vec(act(), 1..25),
    ) {
        let outcome = stays_held(&mut ready(automatic), &acts);
        prop_assert!(outcome.is_ok(), "{}", outcome.unwrap_err());
    }
}

/// A unit that is armed, its mode switch at manual or automatic.
fn ready(automatic: bool) -> Bench {
    let mut bench = keyed(&[]);
    if automatic {
        bench.input.mode_switch = ModeSwitch::Automatic;
        bench.run(0.1);
    }
    assert_eq!(arm(&mut bench), None);
    bench
}

/// No sequence of acts releases an armed train, by numbers: as many sequences as the promise is made for, a hundred
/// on each unit, which is brought back to rest and armed where it is not.
#[test]
#[ignore = "minutes: cargo test --release -p ato-under-test --test all -- --ignored sequences"]
fn a_million_sequences_release_no_armed_train() {
    let mut runner = TestRunner::deterministic();
    let sequence = prop::collection::vec(act(), 1..25);
    let mut armed_at_start = 0;
    for round in 0..10_000 {
        let mut bench = ready(round % 2 == 1);
        for _ in 0..100 {
            if !bench.armed {
                bench.rest();
                let _ = arm(&mut bench);
            }
            armed_at_start += u32::from(bench.armed);
            let acts = sequence.new_tree(&mut runner).unwrap().current();
            stays_held(&mut bench, &acts).unwrap_or_else(|what| panic!("{what}: {acts:?}"));
        }
    }
    assert!(
        armed_at_start > 900_000,
        "{armed_at_start} of 1 000 000 began armed"
    );
}

/// Each guard that fails is seen from outside.
#[test]
fn a_guard_that_fails_shows() {
    for place in [
        Place::MotionGuard,
        Place::CodeGuard,
        Place::ModeGuard,
        Place::KeyGuard,
    ] {
        let mut bench = armed(&[fault(place, Effect::Dead)]);
        match place {
            Place::MotionGuard => bench.speeds = [1.0; 2],
            Place::CodeGuard => bench.code("35"),
            Place::ModeGuard => bench.input.mode_switch = ModeSwitch::Yard,
            _ => bench.input.lines.remove(TrainLines::MAINTENANCE_KEY),
        }
        bench.run(0.4);
        assert!(bench.armed, "{place:?}");
    }
    let mut unheld = keyed(&[fault(Place::BrakeHold, Effect::Dead)]);
    unheld.input.mode_switch = ModeSwitch::Yard;
    unheld.run(0.5);
    assert_eq!(arm(&mut unheld), Some(ArmRefusal::BrakesReleased));
    for place in [Place::TractionBar, Place::StartBar] {
        let mut bench = departing(&[fault(place, Effect::Dead)]);
        let shows = (0..1000).any(|_| {
            bench.scan();
            held(&bench).is_err()
        });
        assert!(shows, "{place:?}");
    }
}

/// Test speed and test markers bring the functions under test to the stop point, where the doors would be enabled.
fn arrive(bench: &mut Bench) {
    let section = line().sections[0].clone();
    bench.send(test_code("75"));
    bench.send(test_departure());
    bench.run(2.0);
    bench.send(test_speed(500));
    for (marker, place_m) in (1..).zip(section.markers_m) {
        reach(bench, place_m);
        let session = SESSION;
        bench.send(TestMarker { session, marker });
        if marker == 3 {
            bench.send(test_speed(50));
        }
    }
    reach(bench, section.stop_m - 0.05);
    bench.send(test_speed(0));
    bench.send(TestTwc {
        station: section.to_station,
        next_station: line().sections[1].to_station,
        loop_id: section.to_loop,
        ..test_departure()
    });
    bench.run(3.0);
}

fn reach(bench: &mut Bench, place_m: f64) {
    let there = |bench: &Bench| f64::from(bench.status.position_cm) / 100.0 >= place_m;
    assert!(bench.until(600.0, there).is_some(), "{place_m} m");
}

#[test]
fn doors_are_enabled_for_the_tester_and_not_for_the_train() {
    for (faults, for_train) in [
        (vec![], false),
        (vec![fault(Place::DoorBar, Effect::Dead)], true),
    ] {
        let mut bench = armed(&faults);
        arrive(&mut bench);
        bench.send(Subscribe { changes: 0 });
        bench.run(0.1);
        assert!(bench.status.bits.contains(StatusBits::ALIGNED));
        let state: TrainState = bench.last().expect("TrainState");
        assert!(state.asked.contains(Outputs::DOOR_ENABLE_RIGHT));
        assert_eq!(bench.output.outputs.intersects(DOORS), for_train);
    }
}
