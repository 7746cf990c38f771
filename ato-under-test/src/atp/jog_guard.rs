//! Supervision of jogging: what ATO may do when it inches to its stop point.
//!
//! Backward it may go only in Automatic Run with the reverser forward, doors closed, under a code that lets a train
//! run, and after an overrun that the section's last marker proves: then rollback allows the way back to the stop
//! point, from where the wheels stood. Whatever its direction, faster than `jog_kmh` the service brake stops the
//! train. A train that moves forward during a jog backward gets the emergency brake.

use protocol::config::UnitConfig;
use protocol::event::Event;
use protocol::{Duration, Instant, Speed};

use crate::kernel::{EventLog, hundredths};
use crate::timer::{Edge, OnDelay, ms};

/// Time after which a permission that ATO no longer asks for is gone: a train that has stopped stands by then.
const TAIL: Duration = Duration::from_ms(1_000);

/// Time for which a refusal lasts until it is reported: a stray pulse of a tachometer leads to no
/// report.
const REFUSAL_LASTS: Duration = Duration::from_ms(600);

/// Inputs of the guard in a scan.
#[derive(Clone, Copy, Debug)]
pub struct JogInputs {
    /// Direction that ATO orders: backward or not; `None` = it does not jog.
    pub backward: Option<bool>,
    /// Automatic Run, reverser forward, doors closed, a code that lets a train run.
    pub permitted: bool,
    /// Distance past the stop point, m, where the last marker proves it.
    pub overrun_m: Option<f64>,
    /// Way by each tachometer in this scan, m, backward negative.
    pub moved_m: [f64; 2],
    pub speed: Speed,
    pub standstill: bool,
    /// No pulse for the time of standstill.
    pub still: bool,
    /// Jogging is supervised.
    pub guarded: bool,
}

#[derive(Clone, Debug, Default)]
pub struct JogGuard {
    /// Way backward that is permitted beside the tolerance of rollback, m.
    back_m: Option<f64>,
    not_asked: OnDelay,
    /// True in the one scan in which the permission to go backward ended: what the train has rolled back until then was
    /// permitted, and rollback is summed up from zero again.
    pub ended: bool,
    /// Way forward since the wheels stood, by each tachometer, m.
    forward_m: [f64; 2],
    too_fast: OnDelay,
    /// The service brake is asked for.
    pub brakes: bool,
    refused: bool,
    refusal_lasts: OnDelay,
    refusal_reported: Edge,
    wrong_way: Edge,
}

impl JogGuard {
    /// One scan; true while the train moves forward although ATO jogs it backward.
    pub fn step(
        &mut self,
        now: Instant,
        inputs: JogInputs,
        config: &UnitConfig,
        log: &mut EventLog,
    ) -> bool {
        let before = self.back_m.is_some();
        if !inputs.guarded {
            let back_m = (inputs.backward == Some(true)).then_some(f64::INFINITY);
            *self = Self {
                back_m,
                ended: before && back_m.is_none(),
                ..Self::default()
            };
            return false;
        }
        self.permit(now, inputs, config, log);
        self.ended = before && self.back_m.is_none();
        self.limit_speed(now, inputs, config, log);
        let backward = inputs.backward == Some(true);
        for (forward_m, moved_m) in self.forward_m.iter_mut().zip(inputs.moved_m) {
            *forward_m = match backward && !inputs.still {
                true => (*forward_m + moved_m).max(0.0),
                false => 0.0,
            };
        }
        let farthest_m = self.forward_m[0].max(self.forward_m[1]);
        let wrong_way = farthest_m > config.tacho.rollback_m;
        if self.wrong_way.rises(wrong_way) {
            log.push(now, Event::JogWrongWay, hundredths(farthest_m));
        }
        wrong_way
    }

    /// Gives and takes the permission to go backward.
    fn permit(&mut self, now: Instant, inputs: JogInputs, config: &UnitConfig, log: &mut EventLog) {
        let overrun_m = inputs
            .overrun_m
            .filter(|m| (0.0..=config.ato.jog.max_m + config.doors.aligned_m).contains(m));
        let asked = inputs.backward == Some(true);
        let wanted = asked && inputs.permitted;
        if self.not_asked.update(now, !wanted, TAIL) {
            self.back_m = None;
        }
        // The permitted way is set while the wheels stand; the rest of an earlier permission is not
        // added.
        if inputs.still {
            self.back_m = overrun_m.filter(|_| wanted);
        }
        self.refused = asked && (!inputs.permitted || self.back_m.is_none());
        let lasts = self.refusal_lasts.update(now, self.refused, REFUSAL_LASTS);
        if self.refusal_reported.rises(lasts) {
            let overrun_cm = hundredths(overrun_m.unwrap_or_default());
            log.push(now, Event::JogRefused, overrun_cm);
        }
    }

    /// Brakes a jog that is too fast, until the train stands.
    fn limit_speed(
        &mut self,
        now: Instant,
        inputs: JogInputs,
        config: &UnitConfig,
        log: &mut EventLog,
    ) {
        let jogs = inputs.backward.is_some() || self.back_m.is_some();
        let over = jogs && inputs.speed.kmh() > config.overspeed.jog_kmh;
        let too_fast = self
            .too_fast
            .update(now, over, ms(config.overspeed.fsb_delay_ms));
        if too_fast && !self.brakes {
            log.push(now, Event::JogOverspeed, i32::from(inputs.speed.to_cms()));
        }
        self.brakes = too_fast || self.brakes && !inputs.standstill;
    }

    /// Way backward that is permitted beside the tolerance of rollback, m.
    pub fn back_m(&self) -> f64 {
        self.back_m.unwrap_or_default()
    }

    /// ATO orders a jog backward that is not permitted.
    pub fn refuses(&self) -> bool {
        self.refused
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::{sg100, with};

    const JOG: JogInputs = JogInputs {
        backward: Some(true),
        permitted: true,
        overrun_m: Some(1.0),
        moved_m: [0.0; 2],
        speed: Speed::ZERO,
        standstill: true,
        still: true,
        guarded: true,
    };

    struct Train {
        guard: JogGuard,
        config: UnitConfig,
        log: EventLog,
        now: Instant,
    }

    impl Train {
        fn new() -> Self {
            Self {
                guard: JogGuard::default(),
                config: sg100(),
                log: EventLog::default(),
                now: Instant::ZERO,
            }
        }

        /// Scans with the same inputs; true once one found the wrong way.
        fn run(&mut self, ms: u64, inputs: JogInputs) -> bool {
            (0..ms / 10).fold(false, |found, _| {
                self.now += protocol::SCAN;
                self.guard
                    .step(self.now, inputs, &self.config, &mut self.log)
                    || found
            })
        }
    }

    fn moving(kmh: f64, overrun_m: f64) -> JogInputs {
        JogInputs {
            overrun_m: Some(overrun_m),
            moved_m: [-kmh / 3.6 * 0.01; 2],
            speed: Speed::from_kmh(kmh),
            standstill: false,
            still: false,
            ..JOG
        }
    }

    #[test]
    fn a_way_back_is_given_at_standstill_and_only_then() {
        let mut train = Train::new();
        train.run(100, JOG);
        assert_eq!((train.guard.back_m(), train.guard.refuses()), (1.0, false));
        train.run(500, moving(3.0, 0.6));
        assert_eq!(
            train.guard.back_m(),
            1.0,
            "what was given, from where it stood"
        );
        let mut train = Train::new();
        train.run(100, moving(3.0, 1.0));
        assert_eq!((train.guard.back_m(), train.guard.refuses()), (0.0, true));
    }

    #[test]
    fn nothing_is_given_without_a_reason() {
        let cases = [
            with(JOG, |it| it.permitted = false),
            with(JOG, |it| it.overrun_m = None),
            with(JOG, |it| it.overrun_m = Some(-0.5)),
            with(JOG, |it| it.overrun_m = Some(5.4)),
            with(JOG, |it| it.overrun_m = Some(f64::NAN)),
        ];
        for inputs in cases {
            let mut train = Train::new();
            train.run(100, inputs);
            assert_eq!(
                (train.guard.back_m(), train.guard.refuses()),
                (0.0, true),
                "{inputs:?}"
            );
        }
        let mut train = Train::new();
        let forward = with(JOG, |it| it.backward = Some(false));
        train.run(100, forward);
        assert_eq!((train.guard.back_m(), train.guard.refuses()), (0.0, false));
    }

    #[test]
    fn a_permission_that_nobody_asks_for_ends() {
        let mut train = Train::new();
        train.run(100, JOG);
        let none = JogInputs {
            backward: None,
            ..moving(2.0, 0.5)
        };
        train.run(900, none);
        assert_eq!(train.guard.back_m(), 1.0);
        assert!(!train.guard.ended);
        while train.guard.back_m() > 0.0 {
            train.run(10, none);
        }
        assert!(train.guard.ended);
        train.run(10, none);
        assert!(!train.guard.ended);
    }

    #[test]
    fn a_jog_that_is_too_fast_is_braked_until_it_stands() {
        for backward in [true, false] {
            let mut train = Train::new();
            let at = |kmh| JogInputs {
                backward: Some(backward),
                ..moving(kmh, 1.0)
            };
            train.run(100, JOG);
            train.run(2_000, at(4.9));
            assert!(!train.guard.brakes);
            train.run(290, at(5.2));
            assert!(!train.guard.brakes);
            train.run(30, at(5.2));
            assert!(train.guard.brakes);
            train.run(500, at(1.5));
            assert!(train.guard.brakes);
            train.run(20, JOG);
            assert!(!train.guard.brakes);
        }
    }

    #[test]
    fn a_train_that_goes_forward_while_it_is_jogged_backward_is_caught() {
        let mut train = Train::new();
        train.run(100, JOG);
        let forward = JogInputs {
            moved_m: [0.01; 2],
            ..moving(3.6, 1.0)
        };
        assert!(!train.run(490, forward));
        assert!(train.run(30, forward));
        // A dead tachometer hides nothing.
        let mut train = Train::new();
        let one = with(forward, |it| it.moved_m = [0.0, 0.01]);
        assert!(train.run(520, one));
    }

    #[test]
    fn a_guard_out_of_action_lets_everything_pass() {
        let mut train = Train::new();
        let fast = JogInputs {
            guarded: false,
            ..moving(30.0, 1.0)
        };
        assert!(!train.run(2_000, fast));
        assert_eq!(train.guard.back_m(), f64::INFINITY);
        assert!(!train.guard.brakes && !train.guard.refuses());
    }
}
