//! Jogging with a train that is a mass, and conditions in which it must not begin or must end.

use protocol::Random;

use super::*;
use crate::for_tests::{sg100, with};

const MASS_KG: f64 = 300e3;
/// A train that stands 1 m past its stop point and may go back.
const PAST: JogInputs = JogInputs {
    drives: true,
    stands: true,
    may_go: true,
    to_stop_m: Some(-1.0),
    aligned_m: 0.3,
    last_marker: true,
    jogs: true,
};

/// A train whose effort follows with a lag, brakes that give more or less, and a gradient that ATO does not know.
struct Train {
    jog: Jog,
    config: JogConfig,
    to_stop_m: f64,
    speed_mps: f64,
    accel_mps2: f64,
    gain: f64,
    downhill_mps2: f64,
    may_go: bool,
    stood_s: f64,
    tries: u32,
    fastest_mps: f64,
}

impl Train {
    fn new(to_stop_m: f64) -> Self {
        Self {
            jog: Jog::default(),
            config: sg100().ato.jog,
            to_stop_m,
            speed_mps: 0.0,
            accel_mps2: 0.0,
            gain: 1.0,
            downhill_mps2: 0.0,
            may_go: true,
            stood_s: 1.0,
            tries: 0,
            fastest_mps: 0.0,
        }
    }

    fn cycle(&mut self) -> JogOutcome {
        let dt = CYCLE.as_secs();
        let outcome = self.jog.step(
            &JogInputs {
                stands: self.stood_s >= 0.5,
                may_go: self.may_go,
                to_stop_m: Some(self.to_stop_m),
                ..PAST
            },
            &self.config,
        );
        self.tries += u32::from(outcome.begun_m.is_some());
        let toward = if self.jog.backward() { -1.0 } else { 1.0 };
        let left_m = toward * self.to_stop_m - 0.3 * self.speed_mps;
        let demand = self
            .jog
            .demand(left_m, self.speed_mps, MASS_KG, 0.8, &self.config);
        let asked = self.gain * demand.force_n / MASS_KG;
        let asked = asked.max(self.jog.least_mps2().unwrap_or(f64::MIN));
        let goes = self.may_go && self.jog.direction().is_some();
        // As ATO does, which holds a train that is about to stand.
        let held = !goes || asked < 0.0 && self.speed_mps < 0.05;
        let asked = if held { -0.9 } else { asked.clamp(-0.9, 0.3) };
        self.accel_mps2 += (asked - self.accel_mps2) * dt / 0.3;
        let moves = self.speed_mps > 0.0 || self.accel_mps2 > 0.0;
        let hill_mps2 = if moves { self.downhill_mps2 } else { 0.0 };
        self.speed_mps = (self.speed_mps + (self.accel_mps2 + hill_mps2) * dt).max(0.0);
        self.to_stop_m -= toward * self.speed_mps * dt;
        self.fastest_mps = self.fastest_mps.max(self.speed_mps);
        self.stood_s = if self.speed_mps > 0.0 {
            0.0
        } else {
            self.stood_s + dt
        };
        outcome
    }

    /// Runs until jogging is over; within a minute and a half, or the test fails.
    fn run(&mut self) -> JogOutcome {
        let mut cycles = (0..1_800).map(|_| self.cycle());
        let outcome = cycles.find(|outcome| outcome.ended);
        outcome.expect("it ends")
    }
}

#[test]
fn a_missed_stop_point_is_reached_from_either_side() {
    for from_m in [0.35, 1.0, 4.9, -0.35, -1.0, -4.9] {
        let mut train = Train::new(from_m);
        let outcome = train.run();
        assert_eq!(outcome.failed_m, None, "{from_m}");
        assert!(
            train.to_stop_m.abs() <= 0.3,
            "{from_m}: {}",
            train.to_stop_m
        );
        assert_eq!(train.tries, 1, "{from_m}");
        assert!(!train.jog.gave_up);
    }
}

/// Whatever the train makes of it: three tries at most, never above 5 km/h, and an end.
#[test]
fn it_always_ends_and_is_never_fast() {
    let mut random = Random::new(1);
    for case in 0..2_000 {
        let mut train = Train::new(10.0 * (random.unit() - 0.5));
        train.gain = 0.3 + 2.0 * random.unit();
        train.downhill_mps2 = 0.2 * (random.unit() - 0.5);
        let interrupted = random.chance(0.3);
        let mut ended = None;
        for cycle in 0..4_000 {
            train.may_go = cycle > 3_000 || !interrupted || random.chance(0.97);
            let outcome = train.cycle();
            if outcome.ended {
                ended = Some(outcome);
                break;
            }
        }
        let outcome = ended.unwrap_or_else(|| panic!("{case}: no end, {:?}", train.jog));
        let aligned = train.to_stop_m.abs() <= 0.3;
        assert!(aligned || outcome.failed_m.is_some(), "{case}");
        assert!(train.tries <= 3, "{case}: {}", train.tries);
        assert!(
            train.fastest_mps < 5.0 / 3.6,
            "{case}: {}",
            train.fastest_mps
        );
    }
}

#[test]
fn it_waits_until_the_train_may_go() {
    let mut train = Train::new(1.0);
    train.may_go = false;
    for _ in 0..1_000 {
        assert_eq!(train.cycle(), JogOutcome::default());
    }
    assert_eq!(train.to_stop_m, 1.0);
    train.may_go = true;
    assert_eq!(train.run().failed_m, None);
}

#[test]
fn what_it_cannot_reach_it_gives_up_at_once() {
    let far = with(PAST, |it| it.to_stop_m = Some(-5.1));
    let unproved = with(PAST, |it| it.last_marker = false);
    let dead = with(PAST, |it| it.jogs = false);
    for (inputs, failed_m) in [(far, Some(-5.1)), (unproved, None), (dead, Some(-1.0))] {
        let mut jog = Jog::default();
        let outcome = jog.step(&inputs, &sg100().ato.jog);
        assert_eq!(outcome.failed_m, failed_m, "{inputs:?}");
        assert!(outcome.ended && jog.gave_up);
    }
    // Before the stop point an ordinary run leads on.
    let short = with(PAST, |it| it.to_stop_m = Some(5.1));
    let mut jog = Jog::default();
    assert_eq!(jog.step(&short, &sg100().ato.jog), JogOutcome::default());
    assert!(!jog.acts());
}
