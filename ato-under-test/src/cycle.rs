//! The unit's 50 ms cycle: TWC, markers, mode, ATO, and what is sent once a cycle [S0 §3.2].

use alloc::vec::Vec;

use protocol::event::Event;
use protocol::injection::{Effect, Place};
use protocol::message::{ModeSwitch, Refusals, SelfTest, TrainLines};
use protocol::{Instant, Speed};

use crate::ato::AtoInputs;
use crate::atp::{Atp, Code, ModeInputs};
use crate::report;
use crate::unit::Unit;

impl Unit {
    /// One cycle.
    pub(crate) fn cycle(&mut self, now: Instant, out: &mut Vec<u8>) {
        if let Some(data) = self.board.take_twc(now) {
            self.take_station(now, None, data, out);
        }
        self.twc.step(now, &mut self.log);
        if let Some(data) = self.twc.data().filter(|_| self.twc.valid()) {
            let standstill = self.atp.tachometers().standstill();
            self.locator.locate(data, &self.setup.line, standstill);
        }
        self.tra.step(now, self.inputs.tra_answers, &mut self.log);
        self.report_tcms(now);
        self.reject_watch
            .step(now, self.link.counters(), &mut self.log);
        let mode_inputs = self.mode_inputs();
        self.atp.cycle(now, mode_inputs, &mut self.log);
        self.operate(now);
        self.send_cycle(now, out);
    }

    fn report_tcms(&mut self, now: Instant) {
        match self.tcms.takes_change() {
            Some(true) => self.log.push(now, Event::TcmsRestored, 0),
            Some(false) => self.log.push(now, Event::TcmsLost, 0),
            None => {}
        }
    }

    fn mode_inputs(&self) -> ModeInputs {
        let lines = self.inputs.lines;
        let standstill = self.atp.tachometers().standstill();
        let code = matches!(self.atp.decoder().code(), Code::Known(_));
        let switch = self.inputs.mode_switch;
        let mut lacking = Refusals::empty();
        lacking.set(Refusals::NOT_STANDSTILL, !standstill);
        lacking.set(
            Refusals::DOORS_OPEN,
            !lines.contains(TrainLines::DOORS_CLOSED),
        );
        lacking.set(Refusals::NO_TWC, !self.twc.up());
        lacking.set(Refusals::STATION_INVALID, !self.twc.valid());
        lacking.set(Refusals::NO_CODE, !code);
        lacking.set(Refusals::CAB_INACTIVE, !lines.contains(TrainLines::HCR));
        lacking.set(Refusals::MODE_SWITCH, !Atp::switch_automatic(switch));
        lacking.set(
            Refusals::CONTROLLER_NOT_NEUTRAL,
            self.inputs.controller != 0,
        );
        lacking.set(Refusals::EB_APPLIED, self.atp.brake().applied());
        lacking.set(Refusals::TCMS_NOT_READY, !self.tcms.ready());
        lacking.set(Refusals::ATO_NOT_READY, !self.ato_outputs.ready);
        lacking.set(Refusals::TRA_FAILED, !self.tra.ok());
        // The TEST board takes no part in running.
        let failed = self.self_tester.failed().difference(SelfTest::TEST_BOARD);
        lacking.set(Refusals::SELF_TEST, !failed.is_empty());
        ModeInputs {
            ready: self.self_tester.finished() && self.inputs.alive,
            cab_active: lines.contains(TrainLines::HCR),
            switch: if self.inputs.alive {
                switch
            } else {
                ModeSwitch::Off
            },
            lacking,
            departure: self.twc.data().is_some_and(|data| data.departure == 1),
            start: lines.contains(TrainLines::START),
            arrived: standstill && self.locator.to_stop_m().is_some_and(|d| d < 1.0),
        }
    }

    /// One cycle of ATO.
    fn operate(&mut self, now: Instant) {
        let was_ready = self.ato_outputs.ready;
        let data = self.twc.data();
        let inputs = AtoInputs {
            mode: self.atp.sequence().mode(),
            limit: self.atp.limit(),
            fixed_speed: data
                .filter(|data| data.fixed_speed_kmh != u8::MAX)
                .map(|data| Speed::from_kmh(f64::from(data.fixed_speed_kmh))),
            running_mode: data.map(|data| data.running_mode).unwrap_or_default(),
            section: self.locator.section(),
            position_m: self.locator.position_m(),
            speed: self.atp.tachometers().speed(),
            standstill: self.atp.tachometers().standstill(),
            power_cut: self.atp.power_cut(),
            load_kg: self.tcms.load_kg(),
            healthy: self.self_tester.finished()
                && !matches!(self.faults.at(Place::AtoCpu), Some(Effect::Dead)),
        };
        self.ato_outputs = self.ato.step(inputs, &self.setup.config.ato);
        let fault = self.faults.at(Place::AtoCpu);
        self.ato_outputs.effort = self.effort_output.give(self.ato_outputs.effort, fault);
        if was_ready && !self.ato_outputs.ready {
            self.log.push(now, Event::AtoFailed, 0);
        }
    }

    fn send_cycle(&mut self, now: Instant, out: &mut Vec<u8>) {
        if !self.loses(Place::TcmsTransmitter) {
            self.link.send(now, &report::to_tcms(self), out);
        }
        if self.maintenance.listened_to(now) {
            self.link.send(now, &report::status(self), out);
            self.maintenance.read_log(&self.log, &mut self.replies);
            for reply in self.replies.drain(..) {
                self.link.send(now, &reply, out);
            }
        }
    }
}
