//! Release of the emergency brake: no person as long as its cause holds, and an attempt is answered with what holds.

use crate::common::{Bench, fault};
use protocol::injection::{Effect, Place};
use protocol::message::{EbCause, Outputs, TrainLines};

/// Parameters of the refusals logged so far.
fn refusals(bench: &mut Bench) -> Vec<i32> {
    bench.parameters("eb_release_refused")
}

fn overspeed() -> Bench {
    Bench::under("25", 33.0)
}

fn door_open() -> Bench {
    let mut bench = Bench::under("25", 20.0);
    bench.input.lines.remove(TrainLines::DOORS_CLOSED);
    bench
}

/// At this speed, and then the wheels turn so, m/s.
fn turning(kmh: f64, turn: impl FnOnce(&mut [f64; 2])) -> Bench {
    let mut bench = Bench::under("25", kmh);
    turn(&mut bench.speeds);
    bench
}

fn failed_self_test() -> Bench {
    Bench::hearing("25", &[fault(Place::Memory, Effect::StuckOn)])
}

/// Cause, how it is brought about, and whether it is over once the train stands.
type Case = (EbCause, fn() -> Bench, bool);

const CAUSES: [Case; 6] = [
    (EbCause::Overspeed, overspeed, true),
    (
        EbCause::ServiceBrakeIneffective,
        || Bench::under("25", 30.0),
        true,
    ),
    (
        EbCause::Tachometer,
        || turning(20.0, |speeds| speeds[1] = 0.0),
        true,
    ),
    (
        EbCause::Rollback,
        || turning(0.0, |speeds| *speeds = [-0.5; 2]),
        true,
    ),
    (EbCause::DoorOpen, door_open, false),
    (EbCause::SelfTest, failed_self_test, false),
];

#[test]
fn an_acknowledgement_while_the_cause_holds_is_refused_with_it_under_every_cause() {
    for (cause, bring, over_at_rest) in CAUSES {
        let mut bench = bring();
        assert!(bench.until(5.0, Bench::braking).is_some(), "{cause:?}");
        bench.run(0.1);
        assert_eq!(bench.status.eb_cause, cause);
        bench.acknowledge();
        assert!(bench.braking(), "{cause:?}: released while it holds");
        let holds = i32::from(cause.code());
        assert_eq!(refusals(&mut bench), [holds], "{cause:?}");
        bench.stop();
        bench.run(2.0);
        assert!(bench.braking(), "{cause:?}: released by itself");
        bench.acknowledge();
        assert_eq!(!bench.braking(), over_at_rest, "{cause:?} at rest");
    }
}

#[test]
fn a_train_that_still_rolls_is_not_released() {
    let mut bench = overspeed();
    assert!(bench.until(5.0, Bench::braking).is_some());
    // Under the limit again, and moving.
    bench.speed_kmh(4.0);
    bench.run(1.0);
    bench.acknowledge();
    assert!(bench.braking());
    assert_eq!(refusals(&mut bench), [i32::from(EbCause::None.code())]);
}

/// Goal: the brake is released at standstill, which is no pulse for a while, not a speed that is low enough for one.
/// Method: wheels that turn at 0.9 km/h, below the 1.08 of standstill; then they stop while the button is pressed.
#[test]
fn a_train_that_creeps_is_not_released_and_one_that_comes_to_rest_is() {
    let mut bench = overspeed();
    assert!(bench.until(5.0, Bench::braking).is_some());
    bench.speed_kmh(0.9);
    bench.run(2.0);
    assert!(bench.has(Outputs::STANDSTILL));
    bench.acknowledge();
    assert!(bench.braking());
    assert_eq!(refusals(&mut bench), [i32::from(EbCause::None.code())]);
    bench.input.lines.insert(TrainLines::ACKNOWLEDGE);
    bench.stop();
    bench.run(0.2);
    assert!(bench.braking());
    bench.run(0.5);
    assert!(!bench.braking());
}

#[test]
fn doors_that_opened_on_the_way_are_closed_first() {
    let mut bench = door_open();
    assert!(bench.until(1.0, Bench::braking).is_some());
    bench.speed_kmh(0.0);
    bench.run(2.0);
    bench.acknowledge();
    assert!(bench.braking());
    assert_eq!(refusals(&mut bench), [i32::from(EbCause::DoorOpen.code())]);
    bench.input.lines.insert(TrainLines::DOORS_CLOSED);
    bench.run(1.0);
    assert!(bench.braking(), "by itself");
    bench.acknowledge();
    assert!(!bench.braking());
}

/// Slower than what counts as moving, and yet it rolls: the brake comes after half a metre, and stays.
#[test]
fn a_slow_roll_back_is_braked_and_not_released_before_it_ends() {
    let mut bench = turning(0.0, |speeds| *speeds = [-0.2; 2]);
    let ms = bench.until(5.0, Bench::braking).expect("the brake");
    assert!(
        (2_400..2_800).contains(&ms),
        "0.5 m at 0.2 m/s took {ms} ms"
    );
    bench.acknowledge();
    assert!(bench.braking());
    assert_eq!(refusals(&mut bench), [i32::from(EbCause::Rollback.code())]);
    bench.speeds = [0.0; 2];
    bench.run(1.0);
    bench.acknowledge();
    assert!(!bench.braking());
}

#[test]
fn a_dead_guard_releases_with_the_doors_open() {
    let mut bench = Bench::hearing("25", &[fault(Place::ReleaseGuard, Effect::Dead)]);
    bench.speed_kmh(5.0);
    bench.input.lines.remove(TrainLines::DOORS_CLOSED);
    assert!(bench.until(1.0, Bench::braking).is_some());
    bench.speeds = [0.0; 2];
    bench.run(2.0);
    bench.acknowledge();
    assert!(!bench.braking());
}
