//! The emergency brake: applied by any cause, latched until standstill and acknowledgement.
//!
//! An acknowledgement releases it only when nothing of its cause is left: no cause holds, the train stands, the
//! doors that opened on the way are closed, somebody is in the cab. Otherwise it is refused, and what holds is logged.

use protocol::Instant;
use protocol::event::Event;
use protocol::message::EbCause;

use super::Proof;
use crate::kernel::EventLog;
use crate::timer::Edge;

/// What the brake looks at in one scan.
#[derive(Clone, Copy, Debug)]
pub struct BrakeInputs {
    /// A cause that holds now, `None` = none.
    pub cause: EbCause,
    /// Speed above the limit, cm/s.
    pub excess_cms: i32,
    pub proof: Proof,
    /// Unit started, cab active, mode chosen, inputs alive.
    pub may_release: bool,
    pub standstill: bool,
    pub doors_closed: bool,
    pub acknowledge: bool,
    /// An acknowledgement is not compared with the cause: an injected fault.
    pub release_guard_dead: bool,
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
        let acknowledged = self.acknowledge.rises(inputs.acknowledge);
        if inputs.cause != EbCause::None {
            self.apply(now, &inputs, log);
        } else if !inputs.may_release && self.cause == EbCause::None {
            self.cause = EbCause::NotReleased;
        }
        if self.cause == EbCause::None {
            return;
        }
        let holds = match inputs.release_guard_dead && acknowledged {
            true => None,
            false => self.holds(&inputs),
        };
        match holds {
            None if acknowledged || self.cause == EbCause::NotReleased => {
                self.cause = EbCause::None;
                log.push(now, Event::EbReleased, 0);
            }
            Some(cause) if acknowledged => {
                log.push(now, Event::EbReleaseRefused, i32::from(cause.code()));
            }
            _ => {}
        }
    }

    /// What keeps the brake applied whoever acknowledges it; [`EbCause::None`] = the train moves.
    fn holds(&self, inputs: &BrakeInputs) -> Option<EbCause> {
        let open = self.cause == EbCause::DoorOpen && !inputs.doors_closed;
        [
            (inputs.cause != EbCause::None, inputs.cause),
            (!inputs.may_release, EbCause::NotReleased),
            (open, EbCause::DoorOpen),
            (!inputs.standstill, EbCause::None),
        ]
        .into_iter()
        .find_map(|(holds, cause)| holds.then_some(cause))
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
            EbCause::Overspeed => (Event::OverspeedEb, inputs.excess_cms),
            EbCause::ServiceBrakeIneffective => {
                (Event::ServiceBrakeIneffective, inputs.proof.decel_mms2)
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
