//! The limit in force, and what asks for the brakes: all causes of the emergency brake, and of the full service brake.

use protocol::config::UnitConfig;
use protocol::event::Event;
use protocol::message::{EbCause, FsbCause, Mode};
use protocol::{Instant, Speed};

use super::{Atp, Code, Found, ScanContext};
use crate::kernel::EventLog;
use crate::signals::Inputs;

impl Atp {
    /// The mode is one in which the speed code counts.
    pub(super) fn by_code(&self) -> bool {
        match self.sequence.mode() {
            Mode::Manual | Mode::Automatic | Mode::AutomaticRun => true,
            Mode::Yard => self.yard.ended,
            Mode::Off | Mode::Emergency | Mode::Unknown(_) => false,
        }
    }

    /// The limit by mode: by code under cab signal, fixed in yard and emergency mode. Where the yard has ended, or a driver
    /// proceeds without a code, both hold.
    pub(super) fn limit_in_force(&self, config: &UnitConfig) -> Speed {
        let by_code = || {
            self.proceeds
                .limit()
                .unwrap_or_else(|| self.decoder.limit(&config.codes))
        };
        let yard = || Speed::from_kmh(config.overspeed.yard_kmh);
        match self.sequence.mode() {
            Mode::Yard if self.yard.ended => Speed::min(yard(), by_code()),
            Mode::Yard => yard(),
            Mode::Emergency => Speed::from_kmh(config.overspeed.emergency_kmh),
            Mode::Manual | Mode::Automatic | Mode::AutomaticRun => by_code(),
            Mode::Off | Mode::Unknown(_) => Speed::ZERO,
        }
    }

    /// No motion is permitted: by the code, without a code, or in mode off, where a welded emergency brake relay must
    /// not leave the train without any brake.
    pub(super) fn must_stand(&self) -> bool {
        (self.by_code() || self.sequence.mode() == Mode::Off) && self.limit == Speed::ZERO
    }

    /// The first cause for the emergency brake that holds now. One that is over stays in force until it is acknowledged.
    pub(super) fn emergency_cause(
        &mut self,
        now: Instant,
        inputs: &Inputs,
        context: ScanContext,
        found: Found,
        log: &mut EventLog,
    ) -> EbCause {
        let lost = context.ever_alive && !inputs.alive;
        match self.inputs_lost.changes(lost) {
            Some(true) => log.push(now, Event::InputsLost, 0),
            Some(false) => log.push(now, Event::InputsRestored, 0),
            None => {}
        }
        let broken = self.broken_invariant();
        if self.broken.rises(broken.is_some()) {
            log.push(now, Event::InternalError, broken.unwrap_or_default());
        }
        let causes = [
            (broken.is_some(), EbCause::Internal),
            (context.started && !context.vital_passed, EbCause::SelfTest),
            (lost, EbCause::InputsLost),
            (self.tachometers.faulty(), EbCause::Tachometer),
            (found.rollback, EbCause::Rollback),
            (found.wrong_way, EbCause::Jog),
            (found.door_open, EbCause::DoorOpen),
            (found.beyond, EbCause::Overspeed),
            (found.ineffective, EbCause::ServiceBrakeIneffective),
            (found.line_opened, EbCause::LineOpened),
            // As at power-up; not a fault, and released without an acknowledgement.
            (
                !context.vital_passed || self.sequence.mode() == Mode::Off,
                EbCause::NotReleased,
            ),
        ];
        causes
            .iter()
            .find(|(holds, _)| *holds)
            .map_or(EbCause::None, |(_, cause)| *cause)
    }

    /// Test mode was broken: a cause that is over at once, and is acknowledged all the same.
    pub fn brake_for_test_mode(&mut self) {
        self.brake.latch(EbCause::TestMode);
    }

    /// Number of the first invariant that does not hold. Invariants hold whatever came in: a
    /// processor that breaks one has failed, and nothing it says can be trusted.
    fn broken_invariant(&self) -> Option<i32> {
        let speed = self.tachometers.speed();
        let holds = [
            speed.mps().is_finite() && speed >= Speed::ZERO,
            self.limit.mps().is_finite() && self.limit >= Speed::ZERO,
            self.tachometers.moved_m().is_finite(),
            self.doors.enable().is_empty() || self.tachometers.standstill(),
        ];
        holds
            .iter()
            .position(|holds| !holds)
            .map(|number| number as i32)
    }

    pub(super) fn service_cause(&self, context: ScanContext, stop: bool) -> FsbCause {
        let running = self.sequence.mode() == Mode::AutomaticRun;
        let code = self.decoder.code;
        let over = self.overspeed.service_brake;
        let causes = [
            (self.path.failed(), FsbCause::EbFailed),
            (
                self.by_code() && code == Code::None && self.proceeds.limit().is_none(),
                FsbCause::NoCode,
            ),
            (
                stop && (over || self.by_code() && code == Code::AbsoluteStop),
                FsbCause::StopCode,
            ),
            (over, FsbCause::Overspeed),
            (self.doors.hold(), FsbCause::DoorOpen),
            (self.jog.brakes, FsbCause::Jog),
            (running && !context.twc_up, FsbCause::TwcLost),
            (running && !context.tcms_up, FsbCause::TcmsLost),
            (running && !context.ato_ready, FsbCause::AtoFailed),
            (running && self.sequence.forbidden(), FsbCause::NotPermitted),
            (self.sequence.stops(), FsbCause::NotPermitted),
        ];
        causes
            .iter()
            .find(|(holds, _)| *holds)
            .map_or(FsbCause::None, |(_, cause)| *cause)
    }
}

/// The cause that a tester is shown: of the functions under test, else of the train's own, else test mode itself, which
/// may hold the relay open.
pub fn shown_cause(tested: &Atp, train: &Atp, held: bool) -> EbCause {
    let held = if held {
        EbCause::TestMode
    } else {
        EbCause::None
    };
    let causes = [tested.brake.cause(), train.brake.cause(), held];
    let shown = causes.into_iter().find(|cause| *cause != EbCause::None);
    shown.unwrap_or(EbCause::None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::sg100;

    /// No input leads to such values: a processor that holds them has failed, and ATP must notice.
    #[test]
    fn a_limit_that_no_processor_may_hold_breaks_an_invariant() {
        let mut atp = Atp::new(&sg100());
        assert_eq!(atp.broken_invariant(), None);
        for mps in [f64::NAN, f64::INFINITY, -1.0] {
            atp.limit = Speed::from_mps(mps);
            assert_eq!(atp.broken_invariant(), Some(1), "{mps}");
        }
    }
}
