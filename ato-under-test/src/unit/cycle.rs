//! The unit's 50 ms cycle: TWC, markers, mode, ATO, and what is sent once a cycle [S0 §3.2].

use alloc::vec::Vec;

use protocol::event::{COUNTER_STANDS, Event};
use protocol::injection::{Effect, Place};
use protocol::message::{AtoFailure, Mode, ModeSwitch, Refusals, SelfTest, TrainLines};
use protocol::{Instant, Speed};

use super::{Unit, report};
use crate::ato::{Ato, AtoInputs, AtoOutputs, Checks, Findings, TrainReport};
use crate::atp::{Atp, Code, ModeInputs};
use crate::kernel::RunCycle;

impl Unit {
    pub(super) fn cycle(&mut self, now: Instant, out: &mut Vec<u8>) {
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
        self.reject_watch.step(now, &self.ports, &mut self.log);
        let mode_inputs = self.mode_inputs();
        self.atp.cycle(now, mode_inputs, &mut self.log);
        self.operate(now);
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
            acknowledge: lines.contains(TrainLines::ACKNOWLEDGE),
            arrived: self.ato.arrived(),
        }
    }

    fn operate(&mut self, now: Instant) {
        let was_ready = self.ato_outputs.ready;
        let data = self.twc.data();
        let tachometers = self.atp.tachometers();
        // ATO goes by the wheel that markers calibrate; ATP keeps its own, safe speed.
        let wheel = 1.0 + self.locator.wheel_correction();
        let speed = tachometers.channel(tachometers.distance_channel()).mps() * wheel;
        let inputs = AtoInputs {
            mode: self.atp.sequence().mode(),
            limit: self.atp.limit(),
            fixed_speed: data
                .filter(|data| data.fixed_speed_kmh != u8::MAX)
                .map(|data| Speed::from_kmh(f64::from(data.fixed_speed_kmh))),
            running_mode: data.map(|data| data.running_mode).unwrap_or_default(),
            section: self.locator.section(),
            position_m: self.locator.position_m(),
            ahead_m: self.locator.ahead_m(),
            aligned_m: self.setup.config.doors.aligned_m,
            speed: Speed::from_mps(speed),
            standstill: tachometers.standstill(),
            power_cut: self.atp.power_cut() || self.tcms.cuts_power(),
            train: TrainReport {
                overrides: self.tcms.overrides(),
                sent: self.ato_outputs.effort,
                given: self.tcms.given(),
            },
            load_kg: self.tcms.load_kg(),
            checks: self.ato_checks(),
        };
        let fault = self.faults.at(Place::AtoCpu);
        if matches!(fault, Some(Effect::Dead)) {
            // A processor that has stopped leaves its outputs as they were and reports no new event.
            self.ato_outputs.findings = Findings::default();
            self.ato_outputs.slid_m = 0.0;
        } else {
            self.ato_outputs = self.ato.step(inputs, &self.setup.config.ato);
            self.ato_cycles = self.ato_cycles.wrapping_add(1);
            let effort = self.ato_outputs.effort;
            self.ato_outputs.effort = self.effort_output.give(effort, fault);
        }
        self.watch_processor();
        self.locator.slide(self.ato_outputs.slid_m);
        self.report_ato(now, was_ready);
        self.record_run(now, Speed::from_mps(speed));
    }

    /// A stopped processor is reset and its outputs are taken from it; ATP brakes in its place.
    fn watch_processor(&mut self) {
        if self.ato_watchdog.step(self.ato_cycles) {
            self.ato = Ato::new(&self.setup.config);
            self.ato_outputs = AtoOutputs {
                failure: AtoFailure::Processor,
                ..AtoOutputs::default()
            };
        }
    }

    fn record_run(&mut self, now: Instant, speed: Speed) {
        let cycle = RunCycle {
            position_m: self.locator.position_m(),
            speed_cms: speed.to_cms(),
            target_cms: self.ato_outputs.target.to_cms(),
            effort: self.ato_outputs.effort,
            marker: (self.locator.last_marker(), self.locator.count()),
            state: self.ato.state(),
        };
        let running = self.atp.sequence().mode() == Mode::AutomaticRun;
        self.run_record.step(now, running, cycle);
    }

    /// KRN's checks of what ATO needs [S0 §1, §3.3]; its processor is under the watchdog.
    fn ato_checks(&self) -> Checks {
        let failed = self.self_tester.failed();
        let run = self.atp.sequence().mode() == Mode::AutomaticRun;
        let causes = [
            (
                failed.intersects(SelfTest::CONFIGURATION | SelfTest::TRACK_DATABASE),
                AtoFailure::StoredData,
            ),
            (
                failed.intersects(SelfTest::MEMORY | SelfTest::TRA | SelfTest::TWC_MODEM),
                AtoFailure::SelfTest,
            ),
            (
                run && self.atp.tachometers().faulty(),
                AtoFailure::Tachometers,
            ),
            // On the way the train is better brought to its platform than stopped.
            (!run && !self.tra.ok(), AtoFailure::Tra),
        ];
        match causes.iter().find(|(holds, _)| *holds) {
            Some((_, failure)) => Checks::Failed(*failure),
            None if self.self_tester.finished() => Checks::Passed,
            None => Checks::Running,
        }
    }

    /// Logs what ATO found, and that it failed.
    fn report_ato(&mut self, now: Instant, was_ready: bool) {
        let outputs = self.ato_outputs;
        let found = outputs.findings;
        let hundredths = |value: f64| libm::round(value * 100.0) as i32;
        let failed = was_ready && !outputs.ready;
        if failed && !found.absurd.is_empty() {
            let bits = i32::from(found.absurd.bits());
            self.log.push(now, Event::AtoInputAbsurd, bits);
        }
        let findings = [
            (Event::AtoNotFollowing, found.not_following_mps),
            (Event::TrainWithholds, found.withheld_mps),
            (Event::StopOverrun, found.overrun_m),
            (Event::StopShort, found.short_m),
        ];
        for (event, value) in findings {
            if let Some(value) = value {
                self.log.push(now, event, hundredths(value));
            }
        }
        if failed {
            let reason = i32::from(outputs.failure.code());
            self.log.push(now, Event::AtoFailed, reason);
        }
    }

    fn send_cycle(&mut self, now: Instant, out: &mut Vec<u8>) {
        let to_tcms = report::to_tcms(self);
        self.send_through(Place::TcmsTransmitter, now, &to_tcms, out);
        if self.maintenance.listened_to(now) {
            self.ports.send(now, &report::status(self), out);
            self.maintenance.read_log(&self.log, &mut self.replies);
            if self.replies.is_empty() {
                self.maintenance
                    .read_run(&self.run_record, &mut self.replies);
            }
            self.send_replies(now, out);
        }
    }
}
