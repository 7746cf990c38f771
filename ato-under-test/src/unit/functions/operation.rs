//! ATO's part of a cycle: its inputs, the watchdog over its processor, KRN's checks of what ATO needs, and what is
//! logged of ATO.

use protocol::config::UnitConfig;
use protocol::event::Event;
use protocol::injection::Place;
use protocol::message::{AtoFailure, Mode, RunRow, RunningMode, SelfTest};
use protocol::{Instant, Speed};

use super::{Functions, Surroundings};
use crate::ato::{Ato, AtoInputs, AtoOutputs, Checks, Findings, JogOutcome, TrainReport};
use crate::driverless::Station;
use crate::kernel::{EventLog, hundredths};

impl Functions {
    pub(super) fn operate(&mut self, now: Instant, around: &Surroundings<'_>, log: &mut EventLog) {
        let was_ready = self.ato_outputs.ready;
        let data = self.twc.data.as_ref();
        let tachometers = self.atp.tachometers();
        let inputs = AtoInputs {
            mode: self.atp.sequence().mode(),
            limit: self.atp.limit(),
            codes: &around.setup.config.codes,
            heard_within_s: f64::from(around.setup.config.receiver.hold_ms) / 1000.0,
            fixed_speed: data
                .filter(|data| data.fixed_speed_kmh != u8::MAX)
                .map(|data| Speed::from_kmh(f64::from(data.fixed_speed_kmh))),
            running_mode: match data.map(|data| data.running_mode) {
                Some(RunningMode::Slow) if !around.guards.slow_running => RunningMode::Normal,
                ordered => ordered.unwrap_or_default(),
            },
            section: self.locator.section.as_ref(),
            position_m: self.locator.position_m(),
            ahead_m: self.locator.ahead_m(),
            aligned_m: around.setup.config.doors.aligned_m,
            last_marker: self.locator.knows_stop_point(),
            jogs: around.guards.jogging,
            speed: self.wheel_speed(),
            standstill: tachometers.standstill(),
            power_cut: self.atp.power_cut() || around.tcms.cuts_power(),
            train: TrainReport {
                overrides: around.tcms.overrides(),
                sent: self.ato_outputs.effort,
                given: around.tcms.given(),
            },
            load_kg: around.tcms.load_kg(),
            checks: self.ato_checks(around),
        };
        let fault = around.faults.at(Place::AtoCpu);
        if around.faults.dead(Place::AtoCpu) {
            // A processor that has stopped leaves its outputs as they were and reports no new event.
            self.ato_outputs.findings = Findings::default();
            self.ato_outputs.jog = JogOutcome::default();
            self.ato_outputs.slid_m = 0.0;
        } else {
            self.ato_outputs = self.ato.step(inputs, &around.setup.config.ato);
            self.ato_cycles = self.ato_cycles.wrapping_add(1);
            let effort = self.ato_outputs.effort;
            self.ato_outputs.effort = self.effort_output.give(effort, fault);
        }
        self.watch_processor(&around.setup.config);
        self.locator.slide(self.ato_outputs.slid_m);
        self.report_ato(now, was_ready, log);
    }

    /// A stopped processor is reset and its outputs are taken from it; ATP brakes in its place.
    fn watch_processor(&mut self, config: &UnitConfig) {
        if self.ato_watchdog.step(self.ato_cycles) {
            self.ato = Ato::new(config);
            self.station = Station::default();
            self.ato_outputs = AtoOutputs {
                failure: AtoFailure::Processor,
                ..AtoOutputs::default()
            };
        }
    }

    /// ATO begins with its inspection, as at power-up.
    pub fn inspect_ato(&mut self, config: &UnitConfig) {
        self.ato = Ato::new(config);
        self.ato_outputs = AtoOutputs::default();
    }

    /// Speed that ATO uses: by the wheel that markers calibrate; ATP keeps its own, safe speed.
    fn wheel_speed(&self) -> Speed {
        let tachometers = self.atp.tachometers();
        let wheel = 1.0 + self.locator.wheel.correction();
        Speed::from_mps(tachometers.channel(tachometers.distance_channel).mps() * wheel)
    }

    /// This cycle for the run record, and how many markers were detected so far.
    pub fn run_cycle(&self) -> (RunRow, u8) {
        let row = RunRow {
            position_cm: hundredths(self.locator.position_m()),
            speed_cms: self.wheel_speed().to_cms(),
            target_cms: self.ato_outputs.target.to_cms(),
            effort: self.ato_outputs.effort,
            marker: self.locator.last_marker,
            ato_state: self.ato.state,
            ..RunRow::default()
        };
        (row, self.locator.count)
    }

    /// KRN's checks of what ATO needs [S0 §1, §3.3]; its processor is under the watchdog.
    fn ato_checks(&self, around: &Surroundings<'_>) -> Checks {
        let failed = around.self_tester.failed();
        let run = self.atp.sequence().mode() == Mode::AutomaticRun;
        let causes = [
            (
                failed.intersects(SelfTest::CONFIGURATION | SelfTest::TRACK_DATABASE),
                AtoFailure::StoredData,
            ),
            (
                failed.intersects(
                    SelfTest::MEMORY | SelfTest::TRA | SelfTest::TWC_MODEM | SelfTest::TWC_CPU,
                ),
                AtoFailure::SelfTest,
            ),
            (
                run && self.atp.tachometers().faulty(),
                AtoFailure::Tachometers,
            ),
            // On the way the train is better brought to its platform than stopped.
            (!run && !around.tra.ok(), AtoFailure::Tra),
        ];
        match causes.iter().find(|(holds, _)| *holds) {
            Some((_, failure)) => Checks::Failed(*failure),
            None if around.self_tester.finished() => Checks::Passed,
            None => Checks::Running,
        }
    }

    /// Logs what ATO found, and that it failed.
    fn report_ato(&self, now: Instant, was_ready: bool, log: &mut EventLog) {
        let outputs = self.ato_outputs;
        let found = outputs.findings;
        let failed = was_ready && !outputs.ready;
        if failed && !found.absurd.is_empty() {
            let bits = i32::from(found.absurd.bits());
            log.push(now, Event::AtoInputAbsurd, bits);
        }
        let findings = [
            (Event::AtoNotFollowing, found.not_following_mps),
            (Event::TrainWithholds, found.withheld_mps),
            (Event::StopOverrun, found.overrun_m),
            (Event::StopShort, found.short_m),
            (Event::JogBegun, outputs.jog.begun_m),
            (Event::JogFailed, outputs.jog.failed_m),
        ];
        for (event, value) in findings {
            if let Some(value) = value {
                log.push(now, event, hundredths(value));
            }
        }
        if failed {
            let reason = i32::from(outputs.failure.code());
            log.push(now, Event::AtoFailed, reason);
        }
    }
}
