//! The emergency brake: applied by any cause, latched until standstill and acknowledgement, and
//! watched through the train line it opens.

use protocol::event::Event;
use protocol::message::{EbCause, TrainLines};
use protocol::{Duration, Instant};

use super::Overspeed;
use crate::kernel::EventLog;
use crate::timer::{Edge, OnDelay};

/// What the brake looks at in one scan.
#[derive(Clone, Copy, Debug)]
pub struct BrakeInputs {
    /// A cause that holds now, `None` = none.
    pub cause: EbCause,
    pub overspeed: Overspeed,
    /// Unit started, cab active, mode chosen, inputs alive.
    pub may_release: bool,
    pub standstill: bool,
    pub lines: TrainLines,
    pub alive: bool,
}

#[derive(Clone, Debug)]
pub struct EmergencyBrake {
    cause: EbCause,
    acknowledge: Edge,
    welded: OnDelay,
    open: OnDelay,
    relay_sound: bool,
    feedback: Duration,
}

impl EmergencyBrake {
    /// Applied since power-up; the brake line must follow the relay within `feedback`.
    pub fn new(feedback: Duration) -> Self {
        Self {
            cause: EbCause::NotReleased,
            acknowledge: Edge::default(),
            welded: OnDelay::default(),
            open: OnDelay::default(),
            relay_sound: true,
            feedback,
        }
    }

    pub fn step(&mut self, now: Instant, inputs: BrakeInputs, log: &mut EventLog) {
        let acknowledged = self
            .acknowledge
            .rises(inputs.lines.contains(TrainLines::ACKNOWLEDGE));
        if inputs.cause != EbCause::None {
            self.apply(now, &inputs, log);
        } else if !inputs.may_release {
            if self.cause == EbCause::None {
                self.cause = EbCause::NotReleased;
            }
        } else if inputs.standstill
            && (self.cause == EbCause::NotReleased || (self.cause != EbCause::None && acknowledged))
        {
            self.cause = EbCause::None;
            log.push(now, Event::EbReleased, 0);
        }
        self.watch_line(now, inputs, log);
    }

    fn apply(&mut self, now: Instant, inputs: &BrakeInputs, log: &mut EventLog) {
        if !matches!(self.cause, EbCause::None | EbCause::NotReleased) {
            return;
        }
        self.cause = inputs.cause;
        let (event, parameter) = match self.cause {
            EbCause::Overspeed => (Event::OverspeedEb, inputs.overspeed.excess_cms),
            EbCause::ServiceBrakeIneffective => {
                let decel_mms2 = inputs.overspeed.decel_mms2;
                (Event::ServiceBrakeIneffective, decel_mms2)
            }
            _ => return,
        };
        log.push(now, event, parameter);
    }

    /// The line must die with the relay, and live with it as long as it is fed: a button, the master
    /// controller, low air or a cab nobody is in opens it before the relay.
    fn watch_line(&mut self, now: Instant, inputs: BrakeInputs, log: &mut EventLog) {
        let energised = inputs.lines.contains(TrainLines::EB_LOOP);
        let welded = inputs.alive && self.applied() && energised;
        let fed = inputs.lines.contains(TrainLines::EB_LOOP_FED);
        let open = inputs.alive && !self.applied() && fed && !energised;
        let welded = self.welded.update(now, welded, self.feedback);
        let open = self.open.update(now, open, self.feedback);
        if (welded || open) && self.relay_sound {
            self.relay_sound = false;
            let event = if welded {
                Event::EbRelayWelded
            } else {
                Event::EbRelayOpen
            };
            log.push(now, event, 0);
        }
    }

    pub fn applied(&self) -> bool {
        self.cause != EbCause::None
    }

    pub fn cause(&self) -> EbCause {
        self.cause
    }

    /// The relay has followed ever since power-up; one failure is not forgotten before the next.
    pub fn relay_sound(&self) -> bool {
        self.relay_sound
    }
}
