//! Motion under a stop (code 0, absolute stop, no code), and what follows a service brake that does not slow the
//! train, whatever asks for it.

use crate::common::{Bench, fault, fault_from};
use crate::journey::Journey;
use proptest::prelude::*;
use protocol::injection::{Effect, FaultMode, Place};
use protocol::message::{EbCause, FsbCause, ModeSwitch, Outputs, TcmsToAtcBits};

/// Signal that demands a stop.
#[derive(Clone, Copy, Debug)]
enum Stop {
    Code0,
    Unmodulated,
    NoCode,
}

const STOPS: [(Stop, FsbCause); 3] = [
    (Stop::Code0, FsbCause::StopCode),
    (Stop::Unmodulated, FsbCause::StopCode),
    (Stop::NoCode, FsbCause::NoCode),
];

fn say(bench: &mut Bench, stop: Stop) {
    match stop {
        Stop::Code0 => bench.code("0"),
        Stop::Unmodulated => bench.unmodulated(),
        Stop::NoCode => bench.input.level_mv = 0,
    }
}

/// Standing under a stop that a code has given way to.
fn standing_under(stop: Stop, faults: &[FaultMode]) -> Bench {
    let mut bench = Bench::hearing("55", faults);
    say(&mut bench, stop);
    bench.run(1.5);
    bench
}

/// 2.9 km/h are less than the service brake's margin over a limit: under a stop there is none.
#[test]
fn a_creep_under_a_stop_is_braked_and_then_braked_by_the_emergency_brake() {
    for (stop, cause) in STOPS {
        let mut bench = standing_under(stop, &[]);
        let code_0 = matches!(stop, Stop::Code0);
        assert_eq!(!bench.has(Outputs::FSB), code_0, "{stop:?}: it stands");
        assert!(bench.has(Outputs::POWER_CUT) && !bench.has(Outputs::ALARM));
        bench.speed_kmh(2.9);
        let ms = bench.until(1.0, |b| b.has(Outputs::FSB) && b.has(Outputs::ALARM));
        assert!(ms.is_some_and(|ms| ms <= 450), "{stop:?}: {ms:?}");
        bench.run(0.1);
        assert_eq!(bench.status.fsb_cause, cause, "{stop:?}");
        assert!(
            !bench.braking(),
            "{stop:?}: the service brake gets its chance"
        );
        let ms = bench.until(4.0, Bench::braking);
        assert!(ms.is_some_and(|ms| ms <= 3_300), "{stop:?}: {ms:?}");
        bench.run(0.1);
        assert_eq!(bench.status.eb_cause, EbCause::ServiceBrakeIneffective);
        let events = bench.events();
        assert!(events.contains(&"moved_at_stop"), "{stop:?}: {events:?}");
    }
}

/// A standing train may be pushed: slower than 0.3 m/s, and less than half a metre on end.
#[test]
fn a_roll_below_the_tolerance_of_standstill_is_not_braked_and_one_that_does_not_end_is() {
    let mut bench = standing_under(Stop::Code0, &[]);
    for _ in 0..5 {
        bench.speeds = [0.25; 2];
        bench.run(1.8);
        bench.speeds = [0.0; 2];
        bench.run(1.5);
        assert!(!bench.has(Outputs::FSB), "rolled 0.45 m");
    }
    bench.speeds = [0.25; 2];
    let ms = bench
        .until(5.0, |b| b.has(Outputs::FSB))
        .expect("the brake");
    assert!(
        (1_900..2_600).contains(&ms),
        "0.5 m at 0.25 m/s took {ms} ms"
    );
    let ms = bench.until(6.0, Bench::braking).expect("emergency brake");
    assert!(ms <= 3_300, "{ms} ms");
}

#[test]
fn who_has_moved_under_a_stop_is_held_until_a_code_lets_it_run() {
    let mut bench = standing_under(Stop::Code0, &[]);
    bench.speed_kmh(2.0);
    assert!(bench.until(1.0, |b| b.has(Outputs::FSB)).is_some());
    bench.speed_kmh(0.0);
    bench.run(20.0);
    assert!(bench.has(Outputs::FSB) && !bench.braking() && !bench.has(Outputs::ALARM));
    bench.code("25");
    bench.run(0.6);
    assert!(!bench.has(Outputs::FSB));
}

/// Yard and emergency mode have a limit of their own, and need no code; in yard mode one that says stop is obeyed.
#[test]
fn a_mode_that_needs_no_code_is_stopped_by_none_and_a_yard_by_a_stop() {
    for switch in [ModeSwitch::Yard, ModeSwitch::Emergency] {
        for (stop, cause) in STOPS {
            let mut bench = standing_under(stop, &[]);
            bench.input.mode_switch = switch;
            bench.run(0.3);
            bench.speed_kmh(12.0);
            bench.run(1.0);
            let stops = switch == ModeSwitch::Yard && cause == FsbCause::StopCode;
            let outputs = bench.output.outputs;
            let braked = [Outputs::FSB, Outputs::POWER_CUT];
            for output in braked {
                assert_eq!(outputs.contains(output), stops, "{switch:?} {stop:?}");
            }
            bench.run(4.0);
            assert_eq!(bench.braking(), stops, "{switch:?} {stop:?}: by proof");
        }
    }
}

#[test]
fn a_dead_guard_lets_a_train_creep() {
    let dead = fault(Place::StopGuard, Effect::Dead);
    let mut bench = standing_under(Stop::Code0, std::slice::from_ref(&dead));
    bench.speed_kmh(2.9);
    bench.run(10.0);
    assert!(!bench.has(Outputs::FSB) && !bench.braking());
    let bench = standing_under(Stop::Unmodulated, &[dead]);
    assert!(!bench.has(Outputs::FSB));
}

/// A run in which the service brake has been asked for.
type Brought = (FsbCause, fn() -> Bench);

fn stopped_by_code_0() -> Bench {
    let mut bench = Bench::under("25", 5.0);
    bench.code("0");
    bench
}

fn code_lost() -> Bench {
    let mut bench = stopped_by_code_0();
    bench.input.level_mv = 0;
    bench
}

/// A bench at 200 m of section 61 with ATO running, after `act`.
fn on_the_way(faults: &[FaultMode], act: impl Fn(&mut Bench)) -> Bench {
    let mut journey = Journey::new(faults).until_position(200.0);
    act(&mut journey.bench);
    journey.bench
}

/// A bench that loses TWC in the loop of its departure.
fn twc_lost() -> Bench {
    let mut bench = Journey::new(&[]).until_position(12.0).bench;
    bench.station = None;
    bench
}

/// TWC is a loop at stations: what is not heard between them is no fault, and station data last.
#[test]
fn silence_between_loops_brakes_nobody_and_in_the_next_loop_it_does() {
    let mut journey = Journey::new(&[]).until_position(200.0);
    journey.bench.station = None;
    let arrival_loop_m = journey.section.stop_m - 170.0;
    while journey.x_m < arrival_loop_m - 5.0 {
        journey.step();
        assert!(!journey.bench.has(Outputs::FSB), "{} m", journey.x_m);
    }
    (0..300).for_each(|_| journey.step());
    assert_eq!(journey.bench.status.fsb_cause, FsbCause::TwcLost);
}

fn not_permitted() -> Bench {
    on_the_way(&[], |bench| {
        let tcms = bench.tcms.as_mut().expect("TCMS speaks");
        tcms.bits.remove(TcmsToAtcBits::ATO_ENABLE);
    })
}

fn ato_failed() -> Bench {
    on_the_way(&[fault_from(Place::AtoCpu, Effect::Dead, 30.0)], |_| {})
}

const CAUSES: [Brought; 7] = [
    (FsbCause::Overspeed, || Bench::under("45", 49.0)),
    (FsbCause::StopCode, stopped_by_code_0),
    (FsbCause::NoCode, code_lost),
    (FsbCause::TwcLost, twc_lost),
    (FsbCause::TcmsLost, || {
        on_the_way(&[], |bench| bench.tcms = None)
    }),
    (FsbCause::AtoFailed, ato_failed),
    (FsbCause::NotPermitted, not_permitted),
];

/// Goal: whatever asks for the service brake, a train that it does not slow gets the emergency brake.
#[test]
fn a_service_brake_without_effect_is_followed_by_the_emergency_brake_under_every_cause() {
    for (cause, bring) in CAUSES {
        let mut bench = bring();
        let asked = bench.until(8.0, |b| b.has(Outputs::FSB));
        assert!(asked.is_some(), "{cause:?}");
        bench.run(0.1);
        assert_eq!(bench.status.fsb_cause, cause);
        assert!(!bench.braking(), "{cause:?}");
        let ms = bench.until(5.0, Bench::braking);
        assert!(
            ms.is_some_and(|ms| (2_800..3_300).contains(&ms)),
            "{cause:?}: {ms:?}"
        );
        bench.run(0.1);
        let ineffective = EbCause::ServiceBrakeIneffective;
        assert_eq!(bench.status.eb_cause, ineffective, "{cause:?}");
    }
}

/// And one that works stops the train alone, also where what asked for it is over its limit to the end.
#[test]
fn a_service_brake_that_works_is_no_emergency_under_any_cause() {
    for (cause, bring) in CAUSES {
        let mut bench = bring();
        let asked = bench.until(8.0, |b| b.has(Outputs::FSB));
        assert!(asked.is_some(), "{cause:?}");
        while bench.speeds[0] > 0.0 {
            bench.speeds = bench.speeds.map(|speed| (speed - 0.0097).max(0.0));
            bench.scan();
            assert!(!bench.braking(), "{cause:?} at {} m/s", bench.speeds[0]);
        }
        bench.run(5.0);
        assert!(
            bench.has(Outputs::STANDSTILL) && !bench.braking(),
            "{cause:?}"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    /// Goal: under a stop no train moves unbraked. Method: any course of speeds from standstill on, each kept for some
    /// time; a model of its own counts for how long, and how far, the train has done what none that stands does.
    #[test]
    fn no_train_moves_unbraked_under_a_stop(
        stop in prop::sample::select(STOPS.map(|(stop, _)| stop).to_vec()),
        course in prop::collection::vec((0.0f64..4.0, 1u32..150), 1..12),
        backward in any::<bool>(),
    ) {
        let mut bench = standing_under(stop, &[]);
        // Speeds as the unit measures them are half a window late, and a scan.
        let late_scans = 25;
        let (mut faster_scans, mut way_m) = (0, 0.0f64);
        for (mps, scans) in course {
            let signed = if backward { -mps } else { mps };
            for _ in 0..scans {
                // No wheel changes its speed faster than 3 m/s².
                let change = (signed - bench.speeds[0]).clamp(-0.03, 0.03);
                bench.speeds = bench.speeds.map(|speed| speed + change);
                bench.scan();
                let speed = bench.speeds[0].abs();
                faster_scans = if speed > 0.32 { faster_scans + 1 } else { 0 };
                way_m = if speed < 0.06 { 0.0 } else { way_m + speed * 0.01 };
                let brakes = bench.has(Outputs::FSB) || bench.braking();
                prop_assert!(faster_scans <= 30 + late_scans || brakes, "{speed} m/s unbraked");
                // What it ran before it was slow belongs to its faster way.
                prop_assert!(way_m < 1.5 || brakes, "{way_m} m unbraked");
                prop_assert!(bench.has(Outputs::POWER_CUT));
            }
        }
    }
}

/// A run that a stop interrupts is braked and held, goes on with the next code, and ends where it should.
#[test]
fn an_automatic_run_goes_on_after_a_stop() {
    for (stop, _) in STOPS {
        let mut journey = Journey::new(&[]).until_position(300.0);
        say(&mut journey.bench, stop);
        (0..4_000).for_each(|_| journey.step());
        assert_eq!(journey.v_mps, 0.0, "{stop:?}");
        assert!(journey.bench.has(Outputs::FSB) && !journey.bench.braking());
        journey.bench.code("65");
        (0..500).for_each(|_| journey.step());
        assert!(journey.v_mps > 1.0, "{stop:?}: it stands");
        let mut journey = journey.run();
        let error_m = journey.stop_error_m();
        assert!(error_m.abs() < 0.3, "{stop:?}: {error_m}");
        let events = journey.faults();
        assert!(!events.contains(&"moved_at_stop"), "{stop:?}: {events:?}");
    }
}
