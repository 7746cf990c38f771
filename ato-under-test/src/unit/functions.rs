//! What the unit knows and decides from one set of inputs: ATP, TWC data, PSM and ATO.
//!
//! A scan is protection and position, a cycle is station data, mode and ATO. Nothing here drives an output: the
//! unit does that with what its functions ask for.

use protocol::config::{TachoConfig, UnitConfig};
use protocol::event::Event;
use protocol::injection::{Effect, Place};
use protocol::message::{
    AtoFailure, DoorSide, Mode, ModeSwitch, Refusals, RunningMode, SelfTest, TrainLines,
};
use protocol::{Duration, Instant, Speed};

use crate::ato::{Ato, AtoInputs, AtoOutputs, Checks, Findings, JogOutcome, TrainReport};
use crate::atp::{Atp, Code, DeadGuards, ModeInputs, ScanContext};
use crate::com::TcmsLink;
use crate::driverless::{Cabs, DeadOrders, Stabling, Station, StationInputs};
use crate::front_end::{EffortOutput, Faults};
use crate::kernel::{EventLog, FreezeFrame, RunCycle, SelfTester, Watchdog};
use crate::psm::{Debounce, Locator, Movement, TachoCompare, Tra, WheelMotion};
use crate::setup::Setup;
use crate::signals::{Inputs, MarkerPulse};
use crate::twc::{TrainState, Twc};

/// What the functions look at beside their inputs.
pub struct Surroundings<'a> {
    pub setup: &'a Setup,
    pub self_tester: &'a SelfTester,
    pub tcms: &'a TcmsLink,
    pub tra: &'a Tra,
    pub faults: &'a Faults,
    /// The harness has been alive at least once.
    pub ever_heard: bool,
    /// No run may begin: a tester is armed.
    pub barred: bool,
}

#[derive(Clone, Debug)]
pub struct Functions {
    pub inputs: Inputs,
    pub atp: Atp,
    pub twc: Twc,
    pub locator: Locator,
    debounce: Debounce,
    tacho_compare: TachoCompare,
    pub ato: Ato,
    pub ato_outputs: AtoOutputs,
    /// Doors of a driverless train.
    pub station: Station,
    effort_output: EffortOutput,
    pub cabs: Cabs,
    pub stabling: Stabling,
    /// Cycles ATO's processor has run, wrapping.
    ato_cycles: u8,
    ato_watchdog: Watchdog,
}

impl Functions {
    /// As at power-up: nothing is known, the brake is applied.
    pub fn new(config: &UnitConfig) -> Self {
        Self {
            inputs: Inputs::default(),
            atp: Atp::new(config),
            twc: Twc::new(Duration::from_ms(u64::from(config.link.twc_timeout_ms))),
            locator: Locator::new(config),
            debounce: Debounce::default(),
            tacho_compare: TachoCompare::default(),
            ato: Ato::new(config),
            ato_outputs: AtoOutputs::default(),
            station: Station::default(),
            effort_output: EffortOutput::default(),
            cabs: Cabs::default(),
            stabling: Stabling::default(),
            ato_cycles: 0,
            ato_watchdog: Watchdog::default(),
        }
    }

    /// One scan.
    pub fn scan(&mut self, now: Instant, around: &Surroundings<'_>, log: &mut EventLog) {
        self.protect(now, around, log);
        self.locate(now, around, log);
    }

    /// One cycle.
    pub fn cycle(&mut self, now: Instant, around: &Surroundings<'_>, log: &mut EventLog) {
        self.twc.step(now, log);
        if let Some(data) = self.twc.data().filter(|_| self.twc.valid()) {
            let standstill = self.atp.tachometers().standstill();
            self.locator.locate(data, &around.setup.line, standstill);
        }
        self.serve_station(now, around, log);
        self.carry_out(now, around, log);
        let mode_inputs = self.mode_inputs(around);
        self.atp.cycle(now, mode_inputs, log);
        self.operate(now, around, log);
    }

    fn protect(&mut self, now: Instant, around: &Surroundings<'_>, log: &mut EventLog) {
        let context = ScanContext {
            vital_passed: around.self_tester.vital_passed(),
            started: around.self_tester.finished(),
            ever_alive: around.ever_heard,
            aligned: self.aligned(&around.setup.config),
            at_platform: self.at_platform(),
            door_side: self
                .twc
                .data()
                .map(|data| data.door_side)
                .unwrap_or_default(),
            door_order: self.door_order(around.faults),
            twc_up: self.twc.up(),
            tcms_up: around.tcms.alive(),
            ato_ready: self.ato_outputs.ready,
            dead_guards: DeadGuards {
                stop: around.faults.dead(Place::StopGuard),
                release: around.faults.dead(Place::ReleaseGuard),
                doors: around.faults.dead(Place::DoorGuard),
                jog: around.faults.dead(Place::JogGuard),
            },
            jogs_backward: self.ato_outputs.jogs_backward,
            // Behind its last marker alone; wheels may be wrong by more than an overrun.
            overrun_m: self
                .locator
                .to_stop_m()
                .filter(|_| self.locator.passed_last_marker())
                .map(|to_stop_m| -to_stop_m),
        };
        log.freeze(FreezeFrame {
            speed: self.atp.tachometers().speed(),
            limit: self.atp.limit(),
            position_m: self.locator.position_m(),
            mode: self.atp.sequence().mode(),
            eb_cause: self.atp.brake().cause(),
        });
        self.atp
            .scan(now, &self.inputs, context, &around.setup.config, log);
    }

    fn locate(&mut self, now: Instant, around: &Surroundings<'_>, log: &mut EventLog) {
        let tachometers = self.atp.tachometers();
        let channel = tachometers.distance_channel();
        let pulses = &self.inputs.pulses[channel];
        let movement = Movement {
            moved_m: tachometers.moved_m(),
            edge_age_s: pulses.sampled_at.since(pulses.edge_at).as_secs(),
            speed_mps: tachometers.channel(channel).mps(),
            standstill: tachometers.standstill(),
            driven: self.atp.sequence().mode() == Mode::AutomaticRun,
        };
        let dead = around.faults.dead(Place::MarkerDebounce);
        let config = &around.setup.config.marker;
        let marker = self
            .debounce
            .take(now, self.inputs.marker, dead, config, log);
        self.locator.step(now, movement, marker, log);
        self.compare_tachometers(now, marker, &around.setup.config.tacho, log);
    }

    fn compare_tachometers(
        &mut self,
        now: Instant,
        marker: Option<MarkerPulse>,
        config: &TachoConfig,
        log: &mut EventLog,
    ) {
        let tachometers = self.atp.tachometers();
        let motion = WheelMotion {
            ways_m: tachometers.ways_m(),
            speeds: [0, 1].map(|channel| tachometers.channel(channel)),
            loose_mps2: tachometers.loose_mps2(),
        };
        self.tacho_compare.step(now, &motion, config, log);
        if let Some(pulse) = marker {
            let span = self.locator.span();
            self.tacho_compare
                .pass_marker(now, pulse.marker, span, config, log);
        }
    }

    pub fn aligned(&self, config: &UnitConfig) -> bool {
        self.atp.tachometers().standstill() && self.locator.aligned(config.doors.aligned_m)
    }

    /// On the arrival station's loop, with valid station data.
    pub(super) fn at_platform(&self) -> bool {
        let on_loop = self.twc.data().zip(self.locator.section());
        self.twc.valid() && on_loop.is_some_and(|(data, section)| data.loop_id == section.to_loop)
    }

    /// What the train says of itself to the wayside.
    pub fn train_state(&self, config: &UnitConfig) -> TrainState {
        let tachometers = self.atp.tachometers();
        TrainState {
            mode: self.atp.sequence().mode(),
            doors_closed: self.atp.doors_closed(),
            aligned: self.aligned(config),
            standstill: tachometers.standstill(),
            speed: tachometers.speed(),
        }
    }

    /// Doors of a driverless train. A processor that has stopped leaves its orders as they were.
    fn serve_station(&mut self, now: Instant, around: &Surroundings<'_>, log: &mut EventLog) {
        if around.faults.dead(Place::AtoCpu) {
            return;
        }
        let active = self.inputs.alive && self.inputs.lines.contains(TrainLines::HCR);
        let driverless = self.inputs.mode_switch == ModeSwitch::Driverless;
        let inputs = StationInputs {
            driverless: driverless && active && around.self_tester.finished(),
            standstill: self.atp.tachometers().standstill(),
            running: self.atp.sequence().mode() == Mode::AutomaticRun,
            enabled: self.atp.enabled(),
            open: self.atp.doors_open(),
            closed: self.atp.doors_closed(),
            departure: self.departure(around),
            acknowledge: self.inputs.lines.contains(TrainLines::ACKNOWLEDGE),
            dead: DeadOrders {
                closing: around.faults.dead(Place::DoorClosing),
                reopening: around.faults.dead(Place::DoorReopening),
            },
        };
        let config = &around.setup.config.driverless;
        self.station.step(now, &inputs, config, log);
    }

    /// Sides on which ATO orders doors to open.
    fn door_order(&self, faults: &Faults) -> DoorSide {
        match (self.station.opens(), faults.at(Place::DoorOrder)) {
            (DoorSide::None, _) | (_, None) => self.station.opens(),
            (side, Some(Effect::Offset { by })) => {
                let code = libm::round(f64::from(side.code()) + by) as u8;
                DoorSide::from_code(code)
            }
            (side, Some(_)) => side,
        }
    }

    /// The wayside has given departure.
    fn departure(&self, around: &Surroundings<'_>) -> bool {
        let given = self.twc.data().is_some_and(|data| data.departure == 1);
        !around.barred && self.twc.valid() && given
    }

    /// ATO holds the train, driving or at a station.
    pub fn ato_holds(&self) -> bool {
        self.ato_outputs.holding_brake || self.station.waits()
    }

    /// ATO holds the train; so it stays when ATO has failed, until the driver takes it.
    pub fn holds(&self) -> bool {
        let left_alone = self.atp.sequence().failed()
            && self.atp.tachometers().standstill()
            && self.inputs.controller == 0;
        self.ato_holds() || left_alone || self.cabs.holds()
    }

    fn mode_inputs(&self, around: &Surroundings<'_>) -> ModeInputs {
        let lines = self.inputs.lines;
        let standstill = self.atp.tachometers().standstill();
        let code = matches!(self.atp.decoder().code(), Code::Known(_));
        let switch = self.inputs.mode_switch;
        let mut lacking = Refusals::empty();
        lacking.set(Refusals::NOT_STANDSTILL, !standstill);
        let unproved = around.faults.dead(Place::DepartureGuard);
        lacking.set(Refusals::DOORS_OPEN, !unproved && !self.atp.doors_closed());
        lacking.set(Refusals::DOOR_SEQUENCE, !unproved && self.station.waits());
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
        lacking.set(Refusals::TCMS_NOT_READY, !around.tcms.ready());
        lacking.set(Refusals::ATO_NOT_READY, !self.ato_outputs.ready);
        lacking.set(Refusals::TRA_FAILED, !around.tra.ok());
        // The TEST board takes no part in running.
        let failed = around.self_tester.failed().difference(SelfTest::TEST_BOARD);
        lacking.set(Refusals::SELF_TEST, !failed.is_empty());
        lacking.set(Refusals::ORDERED, self.ordered_to_stay());
        let dead = |place| around.faults.dead(place);
        let asleep = self.stabling.asleep() && !dead(Place::PutAwayBrake);
        let given_up = self.cabs.handed_over() && dead(Place::HandOverBrake);
        ModeInputs {
            ready: around.self_tester.finished() && self.inputs.alive && !asleep,
            cab_active: lines.contains(TrainLines::HCR) || given_up,
            switch: if self.inputs.alive {
                switch
            } else {
                ModeSwitch::Off
            },
            lacking,
            // At its stop point it has nowhere to run: data of the next section are still to come.
            departure: self.departure(around) && !self.aligned(&around.setup.config),
            start: !around.barred && lines.contains(TrainLines::START),
            acknowledge: lines.contains(TrainLines::ACKNOWLEDGE),
            arrived: self.ato.arrived(),
            gave_up: self.ato.gave_up(),
        }
    }

    fn operate(&mut self, now: Instant, around: &Surroundings<'_>, log: &mut EventLog) {
        let was_ready = self.ato_outputs.ready;
        let data = self.twc.data();
        let tachometers = self.atp.tachometers();
        let inputs = AtoInputs {
            mode: self.atp.sequence().mode(),
            limit: self.atp.limit(),
            fixed_speed: data
                .filter(|data| data.fixed_speed_kmh != u8::MAX)
                .map(|data| Speed::from_kmh(f64::from(data.fixed_speed_kmh))),
            running_mode: match data.map(|data| data.running_mode) {
                Some(RunningMode::Slow) if around.faults.dead(Place::SlowRunning) => {
                    RunningMode::Normal
                }
                ordered => ordered.unwrap_or_default(),
            },
            section: self.locator.section(),
            position_m: self.locator.position_m(),
            ahead_m: self.locator.ahead_m(),
            aligned_m: around.setup.config.doors.aligned_m,
            last_marker: self.locator.passed_last_marker(),
            jog_dead: around.faults.dead(Place::Jog),
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

    /// Speed ATO goes by: of the wheel that markers calibrate; ATP keeps its own, safe speed.
    fn wheel_speed(&self) -> Speed {
        let tachometers = self.atp.tachometers();
        let wheel = 1.0 + self.locator.wheel_correction();
        Speed::from_mps(tachometers.channel(tachometers.distance_channel()).mps() * wheel)
    }

    /// This cycle as the run record keeps it.
    pub fn run_cycle(&self) -> RunCycle {
        RunCycle {
            position_m: self.locator.position_m(),
            speed_cms: self.wheel_speed().to_cms(),
            target_cms: self.ato_outputs.target.to_cms(),
            effort: self.ato_outputs.effort,
            marker: (self.locator.last_marker(), self.locator.count()),
            state: self.ato.state(),
        }
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
        let hundredths = |value: f64| libm::round(value * 100.0) as i32;
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
