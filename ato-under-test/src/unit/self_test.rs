//! Start-up self-test of the unit: what each part answers is put together and passed to KRN.

use protocol::Instant;
use protocol::event::Event;
use protocol::injection::Place;
use protocol::message::TrainLines;

use super::Unit;
use crate::atp::Code;
use crate::kernel::SelfTestInputs;
use crate::signals::AntennaSignal;

/// Level of the self-test's code over the least that the receiver must decode [default].
const SELF_TEST_LEVEL: f64 = 1.2;

impl Unit {
    pub(super) fn test_self(&mut self, now: Instant) {
        if self.self_tester.finished() {
            return;
        }
        let seen = SelfTestInputs {
            receiver_decoded: matches!(self.functions.atp.decoder().candidate(), Code::Known(_)),
            tra_answered: self.functions.inputs.tra_answers,
            modem_heard: self.loop_back(),
            test_board_answers: self.board.answers(),
            brake_line_energised: self.functions.inputs.lines.contains(TrainLines::EB_LOOP),
        };
        if self.self_tester.step(now, seen) {
            self.functions.atp.forget_code();
            let failed = self.self_tester.failed();
            if !failed.is_empty() {
                self.log
                    .push(now, Event::SelfTestFailed, i32::from(failed.bits()));
            }
        }
    }

    /// The code that start-up feeds into the receiver: the first of the table, little above the least
    /// level it must decode.
    pub(super) fn self_test_code(&self) -> Option<AntennaSignal> {
        let config = &self.setup.config;
        config.codes.first().map(|code| AntennaSignal {
            carrier_hz: code.carrier_hz,
            rate_hz: code.rate_hz,
            level_mv: config.receiver.level_min_mv * SELF_TEST_LEVEL,
        })
    }

    /// The modem's test frame, through its transmitter back into its receiver. One that arrives
    /// damaged is no bad frame of the link.
    fn loop_back(&mut self) -> bool {
        let sent = !self.faults.loses(Place::FskTransmitter);
        sent && !self.faults.loses(Place::FskReceiver)
    }
}
