//! The unit's side of the self-test: what each part answers is put together and passed to KRN.

use protocol::event::Event;
use protocol::injection::Place;
use protocol::message::{DoorSide, TrainLines, TwcWayside};
use protocol::{CYCLE, Duration, Instant};

use super::Unit;
use crate::atp::{Code, lookup};
use crate::kernel::{SelfTestInputs, SelfTester};
use crate::signals::AntennaSignal;

/// Level of the self-test's code over the least that the receiver must decode [default].
const SELF_TEST_LEVEL: f64 = 1.2;
/// Cells of the tested memory that fail with an injected fault.
const BAD_CELLS: usize = 4;

impl Unit {
    pub(super) fn test_self(&mut self, now: Instant) {
        if self.functions.stabling.takes_test() && self.guards.wake_up_test {
            let span = u64::from(self.setup.config.start.self_test_ms);
            self.self_tester = SelfTester::new(now, Duration::from_ms(span));
            self.functions.inspect_ato(&self.setup.config);
        }
        if !self.maintenance.armed() {
            self.self_tester.cancel();
        } else if let Some(request) = self.maintenance.take_self_test() {
            let config = &self.setup.config;
            self.self_tester.begin(now, request, config);
        }
        if !self.self_tester.runs() {
            return;
        }
        let inputs = &self.scanned.tested;
        let config = &self.setup.config;
        let heard = inputs.self_test_signal.map(|signal| lookup(signal, config));
        let seen = SelfTestInputs {
            code_heard: heard == Some(Code::Known(0)),
            tra_answers: inputs.tra_answers,
            line_due: self.relay_watch.line_due,
            line_energised: inputs.lines.contains(TrainLines::EB_LOOP),
            modem_hears: self.self_tester.tests() && self.loop_back(),
            twc_cpu_hands_on: self.self_tester.tests() && self.hands_on_test_data(now),
            tcms_link_hears: self.self_tester.tests() && self.tcms_loop_back(),
            board_answers: self.board.answers(),
            bad_cells: self.faults.at(Place::Memory).map_or(0, |_| BAD_CELLS),
        };
        let (config, line) = (&self.setup.config, &self.setup.line);
        let failed = self.self_tester.step(now, seen, config, line);
        if let Some(failed) = failed.filter(|failed| !failed.is_empty()) {
            self.log
                .push(now, Event::SelfTestFailed, i32::from(failed.bits()));
        }
    }

    /// The code that is fed into the receiver: the first of the table, little above the least level it must
    /// decode.
    pub(super) fn self_test_code(&self) -> Option<AntennaSignal> {
        let config = &self.setup.config;
        let code = config.codes.first();
        code.filter(|_| self.self_tester.feeds_receiver())
            .map(|code| AntennaSignal {
                carrier_hz: code.carrier_hz,
                rate_hz: code.rate_hz,
                level_mv: config.receiver.level_min_mv * SELF_TEST_LEVEL,
                ..AntennaSignal::default()
            })
    }

    /// The modem's test frame, through its transmitter back into its receiver. One that arrives
    /// damaged is no bad frame of the link.
    fn loop_back(&mut self) -> bool {
        let sent = !self.faults.loses(Place::FskTransmitter);
        sent && !self.faults.loses(Place::FskReceiver)
    }

    /// The test data of the TWC CPU, handed on unchanged before the next ones come.
    fn hands_on_test_data(&self, now: Instant) -> bool {
        let data = TwcWayside {
            door_side: DoorSide::Left,
            ..TwcWayside::default()
        };
        let handed_on = self.hand_on(now, data);
        handed_on.is_some_and(|(due, heard)| heard == data && due.since(now) < CYCLE)
    }

    /// The test frame of the RS-485 link, which its receiver hears on the two wires that its transmitter drives.
    fn tcms_loop_back(&mut self) -> bool {
        let sent = !self.faults.loses(Place::TcmsTransmitter);
        sent && !self.faults.loses(Place::TcmsReceiver)
    }
}
