//! The emergency brake: applied by any cause, latched until standstill and acknowledgement.

use protocol::Instant;
use protocol::event::Event;
use protocol::message::{EbCause, TrainLines};

use super::Overspeed;
use crate::kernel::EventLog;
use crate::timer::Edge;

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
}

#[derive(Clone, Debug)]
pub struct EmergencyBrake {
    cause: EbCause,
    acknowledge: Edge,
}

impl EmergencyBrake {
    /// Applied since power-up.
    pub fn new() -> Self {
        Self {
            cause: EbCause::NotReleased,
            acknowledge: Edge::default(),
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
    }

    /// Applies it for a cause that is over at once, and is acknowledged all the same.
    pub fn latch(&mut self, cause: EbCause) {
        if matches!(self.cause, EbCause::None | EbCause::NotReleased) {
            self.cause = cause;
        }
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

    pub fn applied(&self) -> bool {
        self.cause != EbCause::None
    }

    pub fn cause(&self) -> EbCause {
        self.cause
    }
}
