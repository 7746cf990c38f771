//! Put-away and wake-up.
//!
//! A train that is put away is in mode off with its emergency brake applied; speed codes and departures are not acted
//! on, TWC is answered. It wakes by the wayside's order, or by somebody at the cab, who turns the mode switch away from
//! driverless. Then the unit tests itself as at power-up, and only a test that is passed lets the brake be released.
//! After one in which any item failed the train stays put away, for nobody is there who could judge it, until it is woken
//! again or somebody at the cab takes it. A departure that was given before counts no more.
//!
//! A train that is put away stays so over a power-up: the stored event log says it.

use protocol::Instant;
use protocol::event::Event;
use protocol::message::{OrderState, SelfTest};

use crate::kernel::EventLog;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Stage {
    #[default]
    Awake,
    PutAway,
    Waking,
    Ready,
    Failed,
}

/// Inputs of put-away and wake-up in a cycle.
#[derive(Clone, Copy, Debug)]
pub struct StablingInputs {
    /// The mode switch is at driverless; `None` = the inputs are lost.
    pub driverless: Option<bool>,
    /// Result of the last self-test: what failed of it; `None` until it is over.
    pub tested: Option<SelfTest>,
    pub departure: bool,
    /// An automatic run is under way.
    pub running: bool,
}

/// Whether the train is put away.
#[derive(Clone, Debug, Default)]
pub struct Stabling {
    stage: Stage,
    /// The self-test is to begin.
    wants_test: bool,
}

impl Stabling {
    /// State after a power-up of a train that was put away, or was not.
    pub fn at_power_up(put_away: bool) -> Self {
        Self {
            stage: match put_away {
                true => Stage::PutAway,
                false => Stage::Awake,
            },
            wants_test: false,
        }
    }

    pub fn put_away(&mut self, now: Instant, log: &mut EventLog) {
        self.stage = Stage::PutAway;
        log.push(now, Event::PutAway, 0);
    }

    pub fn wake_up(&mut self) {
        self.stage = Stage::Waking;
        self.wants_test = true;
    }

    /// A self-test is to begin; said once.
    pub fn takes_test(&mut self) -> bool {
        core::mem::take(&mut self.wants_test)
    }

    pub fn step(&mut self, now: Instant, inputs: StablingInputs, log: &mut EventLog) {
        let taken = inputs.driverless == Some(false);
        match self.stage {
            Stage::PutAway if taken => self.wake_up(),
            Stage::Waking if !self.wants_test => {
                let Some(failed) = inputs.tested else { return };
                // A departure given before the wake-up may still stand: the woken train waits until it is withdrawn.
                if failed.is_empty() && inputs.departure && !taken {
                    return;
                }
                log.push(now, Event::WokenUp, i32::from(failed.bits()));
                self.stage = match failed.is_empty() {
                    true => Stage::Ready,
                    false => Stage::Failed,
                };
            }
            Stage::Ready if taken || inputs.running => self.stage = Stage::Awake,
            Stage::Failed if taken => self.stage = Stage::Awake,
            _ => {}
        }
    }

    /// The train is put away or not awake yet: mode off, brake applied.
    pub fn asleep(&self) -> bool {
        matches!(self.stage, Stage::PutAway | Stage::Waking)
    }

    /// The unit is put away, or was woken with a self-test that failed: it stays put away until
    /// proved sound, and no run may begin.
    pub fn sleeps(&self) -> bool {
        self.asleep() || self.stage == Stage::Failed
    }

    /// The train is in a state in which a wake-up has an effect.
    pub fn can_wake(&self) -> bool {
        matches!(self.stage, Stage::PutAway | Stage::Failed)
    }

    /// State of the order; `None` = the train is awake, and neither put-away nor wake-up concerns it.
    pub fn state(&self) -> Option<OrderState> {
        match self.stage {
            Stage::Awake => None,
            Stage::PutAway => Some(OrderState::PutAway),
            Stage::Waking => Some(OrderState::Waking),
            Stage::Ready => Some(OrderState::Ready),
            Stage::Failed => Some(OrderState::Failed),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::with;

    const ASLEEP: StablingInputs = StablingInputs {
        driverless: Some(true),
        tested: Some(SelfTest::empty()),
        departure: false,
        running: false,
    };

    fn stage(stage: Stage) -> Stabling {
        Stabling {
            stage,
            wants_test: false,
        }
    }

    #[test]
    fn putting_away_and_waking_up_is_this_table() {
        let taken = with(ASLEEP, |it| it.driverless = Some(false));
        let lost = with(ASLEEP, |it| it.driverless = None);
        let testing = with(ASLEEP, |it| it.tested = None);
        let failed = StablingInputs {
            tested: Some(SelfTest::TRA),
            departure: true,
            ..ASLEEP
        };
        let departs = with(ASLEEP, |it| it.departure = true);
        let runs = with(ASLEEP, |it| it.running = true);
        for (from, inputs, to) in [
            (Stage::Awake, taken, Stage::Awake),
            (Stage::PutAway, ASLEEP, Stage::PutAway),
            (Stage::PutAway, departs, Stage::PutAway),
            (Stage::PutAway, lost, Stage::PutAway),
            (Stage::PutAway, taken, Stage::Waking),
            (Stage::Waking, testing, Stage::Waking),
            (Stage::Waking, failed, Stage::Failed),
            (Stage::Waking, departs, Stage::Waking),
            (Stage::Waking, ASLEEP, Stage::Ready),
            (
                Stage::Waking,
                with(taken, |it| it.departure = true),
                Stage::Ready,
            ),
            (Stage::Ready, ASLEEP, Stage::Ready),
            (Stage::Ready, runs, Stage::Awake),
            (Stage::Ready, taken, Stage::Awake),
            (Stage::Failed, ASLEEP, Stage::Failed),
            (Stage::Failed, taken, Stage::Awake),
        ] {
            let mut stabling = stage(from);
            stabling.step(Instant::ZERO, inputs, &mut EventLog::default());
            assert_eq!(stabling.stage, to, "{from:?} {inputs:?}");
        }
    }

    /// A result of an earlier self-test wakes no train.
    #[test]
    fn the_self_test_that_counts_is_one_that_began_with_waking_up() {
        let mut stabling = stage(Stage::PutAway);
        let mut log = EventLog::default();
        stabling.wake_up();
        stabling.step(Instant::ZERO, ASLEEP, &mut log);
        assert_eq!(stabling.state(), Some(OrderState::Waking));
        assert!(stabling.takes_test() && !stabling.takes_test());
        stabling.step(Instant::ZERO, ASLEEP, &mut log);
        assert_eq!(stabling.state(), Some(OrderState::Ready));
    }
}
