//! Takes what the unit sends: each frame goes to the part of the rig that it is for.

use protocol::Instant;
use protocol::message::{IoOutput, Message};

use super::Rig;

impl Rig {
    /// Decodes bytes that came from the unit, and hands each frame on.
    pub fn receive(&mut self, now: Instant, bytes: &[u8]) {
        self.now = now;
        self.watch.note(bytes.len());
        self.link.push(bytes);
        while let Some(received) = self.link.poll(now) {
            let stamp_ms = received.header.stamp_ms;
            self.unit_stamp = Some((now, stamp_ms));
            self.line_watch
                .on_frame(now, received.header.channel, stamp_ms);
            self.harness.note_frame(now, received.header.channel);
            self.watch
                .note_frame(received.header.channel, self.link.counters());
            let harness = self.harness.is_there();
            match &received.message {
                Message::IoOutput(_)
                | Message::AtcToTcms(_)
                | Message::TwcTrain(_)
                | Message::TwcReport(_)
                    if !harness => {}
                Message::IoOutput(io) => {
                    let outputs = self.faults.bench.read(io.outputs);
                    self.latest.on_io(now, &IoOutput { outputs, ..*io });
                }
                Message::AtcToTcms(command) => {
                    if !self.tcms_port.silent() {
                        self.tcms.atc.receive(now, command);
                    }
                    self.latest.on_tcms(now, command);
                }
                Message::TwcTrain(answer) => {
                    self.wayside.on_answer();
                    self.latest.on_twc(now, answer, self.wayside.answers());
                }
                Message::TwcReport(report) => {
                    self.wayside.orders.on_report();
                    self.latest.on_report(now, report);
                }
                Message::Taken(taken) => self.watch.note_taken(*taken),
                Message::TrainState(state) => {
                    self.latest.on_train_state(now, state, harness);
                    let counters = &self.link.counters();
                    self.subscription.on_state(stamp_ms, state, counters);
                    if !harness {
                        // The next `TrainState` is for the next scan, so that each scan's sample has one stamp.
                        break;
                    }
                }
                message => self.on_tester(now, stamp_ms, message),
            }
        }
    }

    fn on_tester(&mut self, now: Instant, stamp_ms: u32, message: &Message) {
        let restarts = self.tester.restarts;
        self.tester.receive(now, message);
        if self.tester.restarts != restarts {
            self.line_watch.note_restart(now);
            self.subscription.restart();
        }
        if let Message::Identity(identity) = message {
            self.identity.on_identity(identity);
        }
        if let Message::StimulusAnswer(_) | Message::ArmState(_) = message {
            self.subscription.on_answer(stamp_ms);
        }
        if let Message::Status(status) = message {
            self.subscription.on_status(stamp_ms);
            self.latest.on_status(now, status);
            if let Some((at, stamp_ms)) = self.unit_stamp {
                self.line_watch.on_clock(at, stamp_ms);
            }
            self.line_watch.on_refused(now, status.rejected_frames);
        }
    }
}
