//! The emergency brake: applied by any cause, latched until standstill and acknowledgement.
//!
//! An acknowledgement releases it only when nothing of its cause is left: no cause holds, no wheel makes a pulse, the
//! doors that opened on the way are closed, somebody is in the cab. Otherwise it is refused, and what holds is logged.

use protocol::Instant;
use protocol::event::Event;
use protocol::message::EbCause;

use super::BrakeState;
use crate::kernel::EventLog;
use crate::timer::Edge;

/// Inputs of the emergency brake in one scan.
#[derive(Clone, Copy, Debug)]
pub struct BrakeInputs {
    /// A cause that holds now, `None` = none.
    pub cause: EbCause,
    /// Speed above the limit, cm/s.
    pub excess_cms: i32,
    pub proof: BrakeState,
    pub standstill: bool,
    /// Standstill, and no pulse, or a lone one, for the time of standstill.
    pub still: bool,
    pub doors_closed: bool,
    pub acknowledge: bool,
    /// An acknowledgement is compared with the cause.
    pub compares_cause: bool,
}

#[derive(Clone, Debug)]
pub struct EmergencyBrake {
    cause: EbCause,
    acknowledge: Edge,
    /// Acknowledged at standstill, too soon after the last pulse: the acknowledgement counts as long as it is given.
    awaits_stillness: bool,
}

impl EmergencyBrake {
    pub fn cause(&self) -> EbCause {
        self.cause
    }

    /// Applied since power-up.
    pub fn new() -> Self {
        Self {
            cause: EbCause::NotReleased,
            acknowledge: Edge::default(),
            awaits_stillness: false,
        }
    }

    pub fn step(&mut self, now: Instant, inputs: BrakeInputs, log: &mut EventLog) {
        let acknowledged = self.acknowledge.rises(inputs.acknowledge);
        if inputs.cause != EbCause::None {
            self.apply(now, &inputs, log);
        }
        if self.cause == EbCause::None {
            self.awaits_stillness = false;
            return;
        }
        let given_up = self.awaits_stillness && !inputs.acknowledge;
        let acknowledged = acknowledged || self.awaits_stillness;
        let holds = match inputs.compares_cause || !acknowledged {
            true => self.holds(&inputs),
            false => None,
        };
        match holds {
            None if acknowledged || self.cause == EbCause::NotReleased => {
                self.cause = EbCause::None;
                log.push(now, Event::EbReleased, 0);
            }
            Some(EbCause::None) if acknowledged && inputs.standstill && !given_up => {
                self.awaits_stillness = true;
            }
            Some(cause) if acknowledged => {
                self.awaits_stillness = false;
                log.push(now, Event::EbReleaseRefused, i32::from(cause.code()));
            }
            _ => {}
        }
    }

    /// Cause that keeps the brake applied although it is acknowledged; [`EbCause::None`] = the train
    /// moves.
    fn holds(&self, inputs: &BrakeInputs) -> Option<EbCause> {
        let open = self.cause == EbCause::DoorOpen && !inputs.doors_closed;
        [
            (inputs.cause != EbCause::None, inputs.cause),
            (open, EbCause::DoorOpen),
            (!inputs.still, EbCause::None),
        ]
        .into_iter()
        .find_map(|(holds, cause)| holds.then_some(cause))
    }

    /// Applies the brake for a cause that is over at once, and is acknowledged all the same.
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
            EbCause::LineOpened => (Event::LineOpened, 0),
            _ => return,
        };
        log.push(now, event, parameter);
    }

    pub fn applied(&self) -> bool {
        self.cause != EbCause::None
    }
}
