//! The unit's 50 ms cycle: TWC, TRA, TCMS, then mode and ATO, and what is sent once a cycle [S0 §3.2].

use alloc::vec::Vec;

use protocol::Instant;
use protocol::event::{COUNTER_STANDS, Event};
use protocol::injection::Place;
use protocol::message::Mode;

use super::{Unit, report};
use crate::twc::{FromWayside, StationSender};

impl Unit {
    pub(super) fn cycle(&mut self, now: Instant, out: &mut Vec<u8>) {
        if let Some((seq, data)) = self.board.modem.take(now) {
            let heard = FromWayside::Station(StationSender::TestModem(seq), data);
            self.hear_wayside(now, heard, out);
        }
        self.tra
            .step(now, self.functions.inputs.tra_answers, &mut self.log);
        self.report_tcms(now);
        self.reject_watch.step(now, &self.ports, &mut self.log);
        self.with_functions(|functions, around, log| functions.cycle(now, around, log));
        let running = self.functions.atp.sequence().mode() == Mode::AutomaticRun;
        self.run_record
            .step(now, running, self.functions.run_cycle());
        self.send_cycle(now, out);
    }

    fn report_tcms(&mut self, now: Instant) {
        match self.tcms.takes_change() {
            Some(true) => self.log.push(now, Event::TcmsRestored, 0),
            Some(false) => {
                let how = if self.tcms.stands(now) {
                    COUNTER_STANDS
                } else {
                    0
                };
                self.log.push(now, Event::TcmsLost, how);
            }
            None => {}
        }
    }

    fn send_cycle(&mut self, now: Instant, out: &mut Vec<u8>) {
        let to_tcms = report::to_tcms(self, now);
        self.send_through(Place::TcmsTransmitter, now, &to_tcms, out);
        if self.maintenance.listened_to(now) {
            self.ports.send(now, &report::status(self), out);
            self.self_tester.take_results(&mut self.replies);
            if self.replies.is_empty() {
                self.maintenance.read_log(&self.log, &mut self.replies);
            }
            if self.replies.is_empty() {
                self.maintenance
                    .read_run(&self.run_record, &mut self.replies);
            }
            if self.replies.is_empty() {
                self.maintenance
                    .read_stored(&self.memory, &mut self.replies);
            }
            self.send_replies(now, out);
        }
    }
}
