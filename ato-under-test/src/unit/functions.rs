//! Knowledge and decisions of the unit from one set of inputs: ATP, TWC data, PSM and ATO.
//!
//! A scan is protection and position, a cycle is station data, mode and ATO. Nothing here drives an output: the
//! unit does that with what its functions ask for.

mod operation;

use protocol::Instant;
use protocol::config::{TachoConfig, UnitConfig};
use protocol::event::Event;
use protocol::injection::{Effect, Place};
use protocol::message::{
    DoorSide, LogEntry, Mode, ModeSwitch, Refusals, TrainLines, TwcTrain, TwcTrainBits, TwcWayside,
};

use crate::ato::{Ato, AtoOutputs};
use crate::atp::{Atp, Code, ModeInputs, ScanContext};
use crate::com::TcmsLink;
use crate::driverless::{Cabs, Stabling, Station, StationInputs};
use crate::faults::Faults;
use crate::front_end::EffortOutput;
use crate::guards::Guards;
use crate::kernel::{EventLog, SelfTester, Watchdog, hundredths};
use crate::psm::{Debounce, Locator, Movement, TachoCompare, Tra, WheelMotion};
use crate::setup::Setup;
use crate::signals::{Inputs, MarkerPulse};
use crate::timer::{Edge, ms};
use crate::twc::Twc;

/// Data that the functions need beside their inputs.
pub struct Surroundings<'a> {
    pub setup: &'a Setup,
    pub self_tester: &'a SelfTester,
    pub tcms: &'a TcmsLink,
    pub tra: &'a Tra,
    pub faults: &'a Faults,
    pub guards: Guards,
    /// The brake line has followed the relay, and something else has opened the line since.
    pub line_fell: bool,
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
    /// Station data name another place than the known place of the standing train.
    elsewhere: Edge,
    /// A section began in this cycle.
    relocated: bool,
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
    /// Functions at power-up: nothing is known, the brake is applied.
    pub fn new(config: &UnitConfig) -> Self {
        Self {
            inputs: Inputs::default(),
            atp: Atp::new(config),
            twc: Twc::new(ms(config.link.twc_timeout_ms)),
            locator: Locator::new(config),
            debounce: Debounce::default(),
            elsewhere: Edge::default(),
            relocated: false,
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

    pub fn scan(&mut self, now: Instant, around: &Surroundings<'_>, log: &mut EventLog) {
        self.protect(now, around, log);
        self.locate(now, around, log);
    }

    pub fn cycle(&mut self, now: Instant, around: &Surroundings<'_>, log: &mut EventLog) {
        self.relocated = false;
        let between_loops = self.between_loops(around);
        self.twc.step(now, between_loops, log);
        if let Some(data) = self.twc.data.as_ref().filter(|_| self.twc.valid) {
            let standstill = self.atp.tachometers().standstill();
            let line = &around.setup.line;
            let section = line.section(data.section).filter(|_| around.guards.station);
            let elsewhere =
                section.is_some_and(|section| self.locator.contradicts(data, section, line));
            if self.elsewhere.rises(elsewhere && standstill) {
                log.push(now, Event::TwcStationInvalid, i32::from(data.station));
            }
            self.relocated = self.locator.locate(data, line, standstill);
        }
        let by_signal = matches!(
            self.atp.sequence().mode(),
            Mode::Manual | Mode::Automatic | Mode::AutomaticRun
        );
        // A cab that is left, and taken up again, may stand elsewhere, or face the other way.
        let stands = self.atp.tachometers().standstill() && self.atp.sequence().mode() != Mode::Off;
        self.locator
            .keep_place((by_signal || stands) && around.guards.station);
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
            aligned: self.aligned(),
            at_platform: self.at_platform(),
            door_side: self
                .twc
                .data
                .as_ref()
                .map(|data| data.door_side)
                .unwrap_or_default(),
            door_order: self.door_order(around.faults),
            twc_up: self.twc.up,
            tcms_up: around.tcms.alive,
            ato_ready: self.ato_outputs.ready,
            guards: around.guards,
            line_open: self.line_open(around) && around.guards.line,
            line_fell: around.line_fell && around.guards.line,
            line_stays: self.inputs.alive && !self.line_dead(),
            tcms_eb: around.tcms.emergency_brake_applied(),
            runs_farther: match around.guards.wheel {
                true => self.locator.runs_farther(),
                false => 0.0,
            },
            tcms_speed: around.tcms.speed(),
            clock_ahead: around.tcms.pace.clock_ahead(),
            tcms_holds: around.tcms.overrides(),
            ato_powers: self.ato_outputs.effort > 0,
            jogs_backward: self.ato_outputs.jogs_backward,
            // An overrun counts only behind the section's last marker: wheels may be wrong by more
            // than an overrun.
            overrun_m: self
                .locator
                .to_stop_m()
                .filter(|_| self.locator.knows_stop_point())
                .map(|to_stop_m| -to_stop_m),
        };
        log.freeze(LogEntry {
            speed_cms: self.atp.tachometers().speed().to_cms(),
            limit_cms: self.atp.limit().to_cms(),
            position_cm: hundredths(self.locator.position_m()),
            mode: self.atp.sequence().mode(),
            eb_cause: self.atp.brake().cause(),
            ..LogEntry::default()
        });
        self.atp
            .scan(now, &self.inputs, context, &around.setup.config, log);
    }

    fn locate(&mut self, now: Instant, around: &Surroundings<'_>, log: &mut EventLog) {
        let tachometers = self.atp.tachometers();
        let channel = tachometers.distance_channel;
        let pulses = &self.inputs.pulses[channel];
        let movement = Movement {
            moved_m: tachometers.moved_m(),
            edge_age_s: pulses.sampled_at.since(pulses.edge_at).as_secs(),
            speed_mps: tachometers.channel(channel).mps(),
            standstill: tachometers.standstill(),
            driven: self.atp.sequence().mode() == Mode::AutomaticRun,
        };
        let works = around.guards.marker_debounce;
        let config = &around.setup.config.marker;
        let marker = self
            .debounce
            .take(now, self.inputs.marker, works, config, log);
        let tested = self.inputs.test_speed.contains(&true);
        self.locator.hold_markers(around.guards.marker, tested);
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
            ways_m: tachometers.ways_m,
            speeds: [0, 1].map(|channel| tachometers.channel(channel)),
            loose_mps2: tachometers.loose_mps2,
        };
        self.tacho_compare.step(now, &motion, config, log);
        if let Some(pulse) = marker {
            let span = self.locator.span;
            self.tacho_compare
                .pass_marker(now, pulse.marker, span, config, log);
        }
    }

    pub fn aligned(&self) -> bool {
        self.atp.tachometers().standstill() && self.locator.aligned()
    }

    /// Whether the train is on the arrival station's loop, with valid station data.
    pub(super) fn at_platform(&self) -> bool {
        let on_loop = self.twc.data.as_ref().zip(self.locator.section.as_ref());
        self.twc.valid && on_loop.is_some_and(|(data, section)| data.loop_id == section.to_loop)
    }

    /// No loop lies where the train is, by data of its section.
    fn between_loops(&self, around: &Surroundings<'_>) -> bool {
        let here = self.locator.section.as_ref().zip(self.twc.data.as_ref());
        around.guards.loop_places
            && here.is_some_and(|(section, data)| {
                let own = data.section == section.section || data.station == section.to_station;
                own && around
                    .setup
                    .line
                    .between_loops(section, self.locator.position_m())
            })
    }

    /// State of the train, as told to the wayside.
    pub fn train_state(&self) -> TwcTrain {
        let tachometers = self.atp.tachometers();
        let mut bits = TwcTrainBits::empty();
        bits.set(TwcTrainBits::DOORS_CLOSED, self.atp.doors_closed());
        bits.set(TwcTrainBits::ALIGNED, self.aligned());
        bits.set(TwcTrainBits::STANDSTILL, tachometers.standstill());
        TwcTrain {
            mode: self.atp.sequence().mode(),
            bits,
            speed_cms: tachometers.speed().to_cms(),
            ..TwcTrain::default()
        }
    }

    /// Doors of a driverless train. A processor that has stopped leaves its orders as they were.
    fn serve_station(&mut self, now: Instant, around: &Surroundings<'_>, log: &mut EventLog) {
        if around.faults.dead(Place::AtoCpu) {
            return;
        }
        let active = self.inputs.alive && self.inputs.lines.contains(TrainLines::HCR);
        let inputs = StationInputs {
            driverless: self.driverless() && active && around.self_tester.finished(),
            standstill: self.atp.tachometers().standstill(),
            running: self.atp.sequence().mode() == Mode::AutomaticRun,
            enabled: self.atp.enabled(),
            open: self.atp.doors_open(),
            closed: self.atp.doors_closed(),
            departure: self.departure(around) == Some(true),
            acknowledge: self.inputs.lines.contains(TrainLines::ACKNOWLEDGE),
            guards: around.guards,
        };
        let config = &around.setup.config.driverless;
        self.station.step(now, &inputs, config, log);
    }

    /// Sides on which ATO orders doors to open.
    fn door_order(&self, faults: &Faults) -> DoorSide {
        match (self.station.opens, faults.at(Place::DoorOrder)) {
            (DoorSide::None, _) | (_, None) => self.station.opens,
            (side, Some(Effect::Offset { by })) => {
                let code = libm::round(f64::from(side.code()) + by) as u8;
                DoorSide::from_code(code)
            }
            (side, Some(_)) => side,
        }
    }

    /// Station data that are valid and of the place where the train stands.
    pub(super) fn station_data(&self) -> Option<&TwcWayside> {
        let refused = !self.twc.valid || self.elsewhere.value();
        self.twc.data.as_ref().filter(|_| !refused)
    }

    /// Departure in valid station data, given or withheld; `None` = no data, or no run may begin.
    fn departure(&self, around: &Surroundings<'_>) -> Option<bool> {
        let data = self.station_data()?;
        (!around.barred).then_some(data.departure == 1)
    }

    /// ATO holds the train, while driving or at a station. After a failure of ATO the train stays held until the
    /// driver moves the controller.
    pub fn holds(&self) -> bool {
        let left_alone = self.atp.sequence().failed()
            && self.atp.tachometers().standstill()
            && self.inputs.controller == 0;
        self.ato_outputs.holding_brake || self.station.waits || left_alone || self.cabs.holds()
    }

    fn mode_inputs(&self, around: &Surroundings<'_>) -> ModeInputs {
        let lines = self.inputs.lines;
        let heard = self.departure(around);
        let standstill = self.atp.tachometers().standstill();
        let code = matches!(self.atp.decoder().code, Code::Known(_));
        let switch = self.inputs.mode_switch;
        let mut lacking = Refusals::empty();
        lacking.set(Refusals::NOT_STANDSTILL, !standstill);
        let unproved = !around.guards.departure;
        let open = !self.atp.doors_closed() || around.tcms.reads_doors_open();
        lacking.set(Refusals::DOORS_OPEN, !unproved && open);
        lacking.set(Refusals::DOOR_SEQUENCE, !unproved && self.station.waits);
        lacking.set(Refusals::NO_TWC, !self.twc.up);
        lacking.set(Refusals::STATION_INVALID, self.station_data().is_none());
        lacking.set(Refusals::NO_CODE, !code);
        lacking.set(
            Refusals::CAB_INACTIVE,
            !lines.contains(TrainLines::HCR) || around.tcms.reads_cab_unmanned() || self.turned(),
        );
        lacking.set(Refusals::MODE_SWITCH, !switch.is_automatic());
        lacking.set(
            Refusals::CONTROLLER_NOT_NEUTRAL,
            self.inputs.controller != 0,
        );
        let line_open = self.line_open(around) && around.guards.line;
        lacking.set(
            Refusals::EB_APPLIED,
            self.atp.brake().applied() || line_open,
        );
        lacking.set(Refusals::TCMS_NOT_READY, !around.tcms.ready());
        lacking.set(Refusals::ATO_NOT_READY, !self.ato_outputs.ready);
        lacking.set(Refusals::TRA_FAILED, !around.tra.ok());
        let failed = around.self_tester.failed_for_running();
        lacking.set(Refusals::SELF_TEST, !failed.is_empty());
        lacking.set(Refusals::ORDERED, self.ordered_to_stay());
        let asleep = self.stabling.sleeps() && around.guards.put_away_brake;
        let given_up = self.cabs.handed_over() && !around.guards.hand_over_brake;
        ModeInputs {
            ready: around.self_tester.finished() && self.inputs.alive && !asleep,
            cab_active: lines.contains(TrainLines::HCR) || given_up,
            switch: if self.inputs.alive && !self.atp.switch_chatters() {
                switch
            } else {
                ModeSwitch::Off
            },
            lacking,
            // A train at its stop point has nowhere to run: data of the next section are still to
            // come.
            departure: heard == Some(true) && !self.aligned(),
            heard,
            start: !around.barred && lines.contains(TrainLines::START),
            acknowledge: lines.contains(TrainLines::ACKNOWLEDGE),
            arrived: self.ato.arrived(),
            relocated: self.relocated,
            gave_up: self.ato.gave_up(),
            line_open: line_open && !self.atp.brake().applied(),
            line_fell: around.line_fell,
            forced: self.atp.forced(),
        }
    }

    /// The reverser is not forward while ATO drives. A jog with the reverser at neutral is refused by ATP itself,
    /// which reports it.
    fn turned(&self) -> bool {
        let lines = self.inputs.lines;
        let forward = lines.contains(TrainLines::FORWARD) && !lines.contains(TrainLines::BACKWARD);
        let jogs = self.ato_outputs.jogs_backward.is_some();
        !forward && (!jogs || lines.contains(TrainLines::BACKWARD))
    }

    /// The brake line is read back as open.
    fn line_dead(&self) -> bool {
        self.inputs.alive && !self.inputs.lines.contains(TrainLines::EB_LOOP)
    }

    /// The emergency brake line is open, as it is read back or TCMS tells it.
    fn line_open(&self, around: &Surroundings<'_>) -> bool {
        self.line_dead() || around.tcms.emergency_brake_applied() == Some(true)
    }
}
