//! Stop and proceed: without a code the train is stopped, and the driver may then go on slowly.
//!
//! The driver acknowledges the stop at standstill by a brake notch, which is a new act: a notch that has been held
//! since the train ran, or since it had a code, acknowledges nothing. From then on a low limit holds, and a warning
//! sounds again and again, until a code is there, or nobody drives by hand any more. An absolute stop is no lack of a
//! code: nobody proceeds under one.

use protocol::config::StopAndProceedConfig;
use protocol::event::Event;
use protocol::{Instant, Speed};

use crate::kernel::EventLog;
use crate::timer::{Edge, ms};

/// Inputs of stop and proceed in one scan.
#[derive(Clone, Copy, Debug)]
pub struct ProceedInputs {
    /// The mode is one in which the speed code counts, and there is no code.
    pub without_code: bool,
    /// The mode switch leaves driving to the driver.
    pub by_driver: bool,
    pub standstill: bool,
    /// The controller is at a brake notch.
    pub brakes: bool,
}

#[derive(Clone, Debug, Default)]
pub struct StopAndProceed {
    /// Time of the acknowledgement, and the limit since then; `None` = the driver may not proceed.
    proceeds: Option<(Instant, Speed)>,
    brakes: Edge,
    pub warns: bool,
}

impl StopAndProceed {
    pub fn step(
        &mut self,
        now: Instant,
        inputs: ProceedInputs,
        config: Option<&StopAndProceedConfig>,
        log: &mut EventLog,
    ) {
        let acknowledges = self.brakes.rises(inputs.brakes) && inputs.standstill;
        let config = config.filter(|_| inputs.without_code && inputs.by_driver);
        let Some(config) = config else {
            (self.proceeds, self.warns) = (None, false);
            return;
        };
        if self.proceeds.is_none() && acknowledges {
            let limit = Speed::from_kmh(config.limit_kmh);
            self.proceeds = Some((now, limit));
            log.push(now, Event::StopAndProceed, i32::from(limit.to_cms()));
        }
        self.warns = self.proceeds.is_some_and(|(since, _)| {
            let into_us = now.since(since).as_us() % ms(config.warning_ms).as_us();
            into_us < ms(config.sounds_ms).as_us()
        });
    }

    /// Limit after an acknowledged stop.
    pub fn limit(&self) -> Option<Speed> {
        self.proceeds.map(|(_, limit)| limit)
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use protocol::SCAN;

    use super::*;
    use crate::for_tests::with;

    const ACKNOWLEDGED: ProceedInputs = ProceedInputs {
        without_code: true,
        by_driver: true,
        standstill: true,
        brakes: true,
    };

    fn config() -> StopAndProceedConfig {
        StopAndProceedConfig {
            limit_kmh: 15.0,
            warning_ms: 8000,
            sounds_ms: 500,
        }
    }

    /// The rule: both the stop and the brake notch are needed, and only where there is no code.
    #[test]
    fn it_needs_a_stop_and_a_brake_notch_without_a_code() {
        let lacking = [
            with(ACKNOWLEDGED, |it| it.without_code = false),
            with(ACKNOWLEDGED, |it| it.by_driver = false),
            with(ACKNOWLEDGED, |it| it.standstill = false),
            with(ACKNOWLEDGED, |it| it.brakes = false),
        ];
        let mut log = EventLog::default();
        let after = |inputs: ProceedInputs, then: Option<ProceedInputs>, log: &mut EventLog| {
            let mut one = StopAndProceed::default();
            for inputs in core::iter::once(inputs).chain(then) {
                one.step(Instant::from_ms(5000), inputs, Some(&config()), log);
            }
            one.limit()
        };
        for inputs in lacking {
            assert_eq!(after(inputs, None, &mut log), None, "{inputs:?}");
        }
        let limit = Some(Speed::from_kmh(15.0));
        assert_eq!(after(ACKNOWLEDGED, None, &mut log), limit);
        // The permission lasts while the train runs, and ends with a code and with the driver.
        let [coded, automatic, runs, released] = lacking;
        for (then, limit) in [
            (coded, None),
            (automatic, None),
            (runs, limit),
            (released, limit),
        ] {
            assert_eq!(after(ACKNOWLEDGED, Some(then), &mut log), limit, "{then:?}");
        }
        let mut without = StopAndProceed::default();
        without.step(Instant::ZERO, ACKNOWLEDGED, None, &mut log);
        assert_eq!(without.limit(), None, "a unit without the rule");
    }

    /// Goal: a brake notch that has been held since before acknowledges nothing. Method: it is held since the train ran, since
    /// there was a code, and since another position of the switch; then the notch is released, and taken again.
    #[test]
    fn a_brake_notch_that_is_held_acknowledges_nothing() {
        let inputs = |held: [bool; 3], brakes| {
            let [standstill, without_code, by_driver] = held;
            ProceedInputs {
                without_code,
                by_driver,
                standstill,
                brakes,
            }
        };
        let all = [true; 3];
        for before in [
            [false, true, true],
            [true, false, true],
            [true, true, false],
        ] {
            let (mut one, mut log) = (StopAndProceed::default(), EventLog::default());
            let acts = [(before, true), (all, true), (all, false), (all, true)];
            let after = acts.map(|(held, brakes)| {
                one.step(
                    Instant::ZERO,
                    inputs(held, brakes),
                    Some(&config()),
                    &mut log,
                );
                one.limit().is_some()
            });
            assert_eq!(after, [false, false, false, true], "{before:?}");
        }
    }

    /// The rule: the warning comes every eight seconds.
    #[test]
    fn the_warning_sounds_every_eight_seconds() {
        let (mut one, mut log) = (StopAndProceed::default(), EventLog::default());
        let (mut now, mut before, mut begun) = (Instant::from_ms(3000), false, Vec::new());
        let mut sounded = 0;
        while now < Instant::from_ms(30_000) {
            one.step(now, ACKNOWLEDGED, Some(&config()), &mut log);
            if one.warns && !before {
                begun.push(now.since(Instant::from_ms(3000)).as_ms());
            }
            before = one.warns;
            sounded += u64::from(before) * SCAN.as_ms();
            now += SCAN;
        }
        assert_eq!(begun, [0, 8000, 16_000, 24_000]);
        assert_eq!(sounded, 4 * 500);
    }
}
