//! One scan of TCMS, from inputs to what the train is told.

use protocol::event::Event;
use protocol::message::{AtcToTcms, ModeSwitch, Outputs};
use protocol::{Duration, Instant, SCAN};

use crate::train::{CarSet, Equipment, MAX_CARS, TrainData, TrainInputs};

use super::atc_link::{AtcLink, AtoOrder};
use super::consist::Consist;
use super::controller::{ControllerInputs, FULL_BRAKE, FULL_POWER};
use super::data::TcmsData;
use super::driving_control::{DrivingInputs, DrivingOutputs, driving_control};
use super::effort::{Demands, Effort, Order};
use super::emergency_line::{Line, LineInputs, emergency_line};
use super::full_service_brake::{BrakeInputs, BrakeOutputs, full_service_brake};
use super::holding_brake::{HoldingBrake, HoldingInputs};
use super::speed::train_speed;
use super::timer::Lasting;
use super::watch::{Found, Watch, WatchInputs};
use super::words::{EbSources, Lamps, PowerCuts};

/// Mode TCMS drives in (S4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TcmsMode {
    /// None: no cab counts, or its mode switch is off.
    #[default]
    None,
    /// Emergency.
    Emergency,
    /// Yard.
    Yard,
    /// Manual.
    Manual,
    /// Automatic.
    Automatic,
    /// Driverless.
    Driverless,
}

impl TcmsMode {
    /// Place among the labels of the signal `tcms_mode`.
    pub fn code(self) -> u8 {
        self as u8
    }

    fn by_ato(self) -> bool {
        matches!(self, Self::Automatic | Self::Driverless)
    }
}

/// One cab as wired to TCMS. The default is a cab nobody is in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CabInputs {
    /// Head control relay energised.
    pub hcr: bool,
    /// Reverser: 1, 0 or −1.
    pub reverser: i8,
    /// Mode switch.
    pub mode_switch: ModeSwitch,
    /// Master controller.
    pub controller: ControllerInputs,
    /// The dead man is held.
    pub dead_man: bool,
    /// Emergency push button pressed.
    pub emergency_button: bool,
    /// Button for release by force pressed.
    pub forced_release: bool,
}

/// What TCMS is given in one scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TcmsInputs {
    /// Both cabs; the unit is in the first.
    pub cabs: [CabInputs; 2],
    /// All doors proved closed.
    pub doors_closed: bool,
    /// Pressure switch of the main reservoir.
    pub main_reservoir_low: bool,
    /// The emergency brake is cut out.
    pub eb_cut_out: bool,
    /// Security brake, hard-wired.
    pub security_brake: bool,
    /// Parking brake.
    pub parking_brake: bool,
    /// Driverless initialisation or turn-back.
    pub turn_back: bool,
    /// Cars whose brake is cut out.
    pub brakes_cut_out: CarSet,
    /// Cars whose inverter is cut out.
    pub inverters_cut_out: CarSet,
    /// The unit's contacts; `None` = not heard.
    pub contacts: Option<Outputs>,
    /// Passengers as the brake control units weigh them, kg.
    pub load_kg: f64,
    /// What the equipment reports; `None` = generators turn the wheels, and it counts as sound.
    pub equipment: Option<Equipment>,
    /// Speed of the wheels while generators turn them, m/s, a size.
    pub speed_mps: f64,
    /// Frames of the unit that were refused so far.
    pub frames_refused: u32,
}

/// What TCMS did in one scan, for signals, lamps and the unit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TcmsView {
    /// Mode.
    pub mode: TcmsMode,
    /// Outputs of the driving-control module.
    pub driving: DrivingOutputs,
    /// Outputs of the full-service-brake module.
    pub brake: BrakeOutputs,
    /// Holding brake ordered.
    pub holding: bool,
    /// Emergency brake train line.
    pub line: Line,
    /// Why powering is cut.
    pub power_cuts: PowerCuts,
    /// Lamps.
    pub lamps: Lamps,
    /// What is wrong with the equipment.
    pub found: Found,
    /// Voltage of the controller that counts, V.
    pub volts: f64,
    /// Speed as TCMS sees it, m/s.
    pub speed_mps: f64,
    /// Demands on the cars.
    pub demands: Demands,
    /// Effort the train gives, −1024..1023, for the unit.
    pub given: i16,
    /// Forward or backward, as the reverser that counts.
    pub backward: bool,
}

/// An event TCMS logs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TcmsEvent {
    /// What.
    pub event: Event,
    /// Its parameter.
    pub parameter: i32,
}

/// The system.
#[derive(Clone, Debug)]
pub struct Tcms {
    data: TcmsData,
    atc: AtcLink,
    effort: Option<Effort>,
    watch: Watch,
    holding: HoldingBrake,
    dead_man: Lasting,
    found_before: Found,
    counted: Counted,
    view: TcmsView,
    events: Vec<TcmsEvent>,
}

/// What has been told by an event already.
#[derive(Clone, Copy, Debug, Default)]
struct Counted {
    controller_failed: bool,
    contradicts: bool,
    two_cabs: bool,
    atc_silent: Option<bool>,
    ato_contradictions: u32,
    frames_refused: u32,
    main_reservoir_low: bool,
    dead_man: bool,
    regeneration: CarSet,
}

impl Tcms {
    /// A system for a train, at its start.
    pub fn new(train: &TrainData) -> Self {
        let data = train.tcms().clone();
        let effort = match train {
            TrainData::Cars(cars) => Some(Effort::new(Consist::new(cars))),
            TrainData::Ideal(_) => None,
        };
        let full_service_n = effort
            .as_ref()
            .map_or([0.0; MAX_CARS], |effort| effort.consist.full_service_n);
        Self {
            atc: AtcLink::new(Duration::from_secs(data.order_timeout_s)),
            watch: Watch::new(&data, full_service_n),
            holding: HoldingBrake::new(&data),
            dead_man: Lasting::default(),
            found_before: Found::default(),
            counted: Counted::default(),
            view: TcmsView::default(),
            events: Vec::new(),
            effort,
            data,
        }
    }

    /// Its data.
    pub fn data(&self) -> &TcmsData {
        &self.data
    }

    /// No effort, as when the train is put on the track anew.
    pub fn rest(&mut self) {
        if let Some(effort) = &mut self.effort {
            effort.reset();
        }
    }

    /// Takes a frame of the unit.
    pub fn hear(&mut self, now: Instant, frame: &AtcToTcms) {
        self.atc.hear(now, frame);
    }

    /// What it did in the last scan.
    pub fn view(&self) -> &TcmsView {
        &self.view
    }

    /// Its new events.
    pub fn take_events(&mut self) -> Vec<TcmsEvent> {
        std::mem::take(&mut self.events)
    }

    /// One scan: what the train is told.
    pub fn step(&mut self, now: Instant, inputs: &TcmsInputs) -> TrainInputs {
        let order = self.atc.step(now);
        let cab = active_cab(&inputs.cabs);
        let mode = mode(cab, &order);
        let line = emergency_line(&line_inputs(inputs, cab));
        let found = self.look(now, inputs, cab);
        let volts = cab.map_or(0.0, |cab| cab.controller.volts);
        let brake = self.full_service(now, inputs, cab, mode, &order, &found);
        let speed_mps = self.speed(inputs);
        let holding = self.hold(now, inputs, mode, &order, speed_mps);
        let power_cuts = power_cuts(inputs, cab, mode, &line, &brake, &found, &order);
        let driving = driving_control(&DrivingInputs {
            drxemod: mode == TcmsMode::Emergency,
            drxymod: mode == TcmsMode::Yard,
            drxmmod: mode == TcmsMode::Manual,
            drxamod: mode == TcmsMode::Automatic,
            drxdmod: mode == TcmsMode::Driverless,
            drxmcrv: self.data.value(volts),
            drxp: cab.is_some_and(|cab| cab.controller.power),
            drxb: cab.is_some_and(|cab| cab.controller.brake),
            drxcoa: cab.is_some_and(|cab| cab.controller.neutral),
            drxpcut: !power_cuts.is_empty(),
            drxtebe: order.value,
            drxaop: order.power,
            drxaob: order.brake,
        });
        let share = share(&driving, &brake);
        let out = self.effort_order(inputs, share, holding, &line, speed_mps, &found);
        let demands = self.share_out(inputs, &out);
        let backward = cab.is_some_and(|cab| cab.reverser < 0);
        self.view = TcmsView {
            mode,
            driving,
            brake,
            holding,
            line,
            power_cuts,
            lamps: lamps(inputs, &line, &found),
            found,
            volts,
            speed_mps,
            demands,
            given: self.given(inputs, share),
            backward,
        };
        self.report(inputs, cab);
        let held = if holding { -self.holding_share() } else { 1.0 };
        TrainInputs {
            demand: share.min(held),
            motor_n: demands.motor_n,
            air_n: demands.air_n,
            emergency: line.applied,
            security: inputs.security_brake,
            parking: inputs.parking_brake,
            forced_release: cab.is_some_and(|cab| cab.forced_release),
            brakes_cut_out: inputs.brakes_cut_out,
            inverters_cut_out: inputs.inverters_cut_out,
            backward,
            load_kg: inputs.load_kg,
            ..TrainInputs::default()
        }
    }

    fn holding_share(&self) -> f64 {
        self.effort.as_ref().map_or(0.7, |effort| {
            effort.consist.data.service_brake.holding_share
        })
    }

    fn look(&mut self, now: Instant, inputs: &TcmsInputs, cab: Option<&CabInputs>) -> Found {
        let Some(equipment) = &inputs.equipment else {
            return Found::default();
        };
        self.watch.step(
            now,
            &WatchInputs {
                equipment,
                air_n: &self.view.demands.air_n,
                brakes_off: !self.view.driving.dryinb
                    && !self.view.brake.bcymsb
                    && !self.view.holding,
                brakes_cut_out: inputs.brakes_cut_out,
                inverters_cut_out: inputs.inverters_cut_out,
                forced_release: cab.is_some_and(|cab| cab.forced_release),
            },
        )
    }

    fn full_service(
        &mut self,
        now: Instant,
        inputs: &TcmsInputs,
        cab: Option<&CabInputs>,
        mode: TcmsMode,
        order: &AtoOrder,
        found: &Found,
    ) -> BrakeOutputs {
        let released = cab.is_some_and(|cab| !cab.dead_man);
        let limit = Duration::from_secs(self.data.dead_man_s);
        let dead_man = self.dead_man.update(now, released, limit);
        self.note(self.counted.dead_man, dead_man, Event::DeadMan, 0);
        self.counted.dead_man = dead_man;
        full_service_brake(&BrakeInputs {
            bcxemod: mode == TcmsMode::Emergency,
            bcxymod: mode == TcmsMode::Yard,
            bcxmmod: mode == TcmsMode::Manual,
            bcxamod: mode == TcmsMode::Automatic,
            bcxdmod: mode == TcmsMode::Driverless,
            bcxvvvff: !found.inverters.is_empty(),
            bcxecuf: !found.brake_units.is_empty(),
            bcxbccsf: !found.cylinders.is_empty(),
            bcxnrb: !found.not_released.is_empty(),
            bcxatof: order.failed,
            bcxdoreq: !inputs.doors_closed,
            bcxacfsb: inputs.contacts.is_some_and(|c| c.contains(Outputs::FSB)),
            bcxdmfsb: dead_man,
            bcxinb7: self.view.driving.dryinb7,
        })
    }

    /// Mean of the inverters, or of the generators' wheels.
    fn speed(&self, inputs: &TcmsInputs) -> f64 {
        match (&inputs.equipment, &self.effort) {
            (Some(equipment), Some(effort)) => train_speed(
                &equipment.axle_mps,
                effort.consist.motors.without(equipment.inverters_silent),
                self.view.driving.dryinp,
                self.data.slip_kmh / 3.6,
            ),
            (Some(equipment), None) => equipment.axle_mps[0],
            (None, _) => inputs.speed_mps,
        }
    }

    fn hold(
        &mut self,
        now: Instant,
        inputs: &TcmsInputs,
        mode: TcmsMode,
        order: &AtoOrder,
        speed_mps: f64,
    ) -> bool {
        let contact = inputs
            .contacts
            .is_some_and(|c| c.contains(Outputs::HOLDING_BRAKE));
        let traction = match (&inputs.equipment, &self.effort) {
            (Some(equipment), Some(effort)) => {
                let most_n = equipment.traction_n.iter().fold(0.0, |a: f64, b| a.max(*b));
                most_n / effort.consist.traction_n()
            }
            _ => f64::from(self.view.driving.drytebe) / f64::from(FULL_POWER),
        };
        self.holding.step(
            now,
            &HoldingInputs {
                by_ato: mode.by_ato(),
                requested: order.holding || contact,
                braking: self.view.driving.dryinb,
                speed_mps,
                traction,
                turn_back: inputs.turn_back,
            },
        )
    }

    fn effort_order(
        &self,
        inputs: &TcmsInputs,
        share: f64,
        holding: bool,
        line: &Line,
        speed_mps: f64,
        found: &Found,
    ) -> Order {
        Order {
            share: if line.applied { share.min(0.0) } else { share },
            holding,
            no_inverters: line.applied || inputs.security_brake,
            speed_mps,
            inverters_out: inputs.inverters_cut_out.with(found.inverters),
            brakes_out: inputs.brakes_cut_out.with(found.brake_units),
        }
    }

    fn share_out(&mut self, inputs: &TcmsInputs, order: &Order) -> Demands {
        let Some(effort) = &mut self.effort else {
            return Demands::default();
        };
        if effort.consist.load_kg() != inputs.load_kg {
            effort.consist.weigh(inputs.load_kg);
            self.watch.weigh(effort.consist.full_service_n);
        }
        effort.step(SCAN.as_secs(), order, inputs.equipment.as_ref())
    }

    /// Effort the train gives as the unit is told it.
    fn given(&self, inputs: &TcmsInputs, share: f64) -> i16 {
        let given = match (&inputs.equipment, &self.effort) {
            (Some(equipment), Some(effort)) => {
                let sum = |of: &crate::train::PerCar| of.iter().sum::<f64>();
                let brake_n = sum(&equipment.electric_n) + sum(&equipment.air_n);
                let full_n = sum(&effort.consist.full_service_n);
                let most_n = effort.power_n(self.view.speed_mps);
                sum(&equipment.traction_n) / most_n - brake_n / full_n
            }
            _ => share,
        };
        let scale = if given < 0.0 {
            FULL_BRAKE.abs()
        } else {
            FULL_POWER
        };
        (given * f64::from(scale))
            .round()
            .clamp(f64::from(FULL_BRAKE), f64::from(FULL_POWER)) as i16
    }

    fn note(&mut self, before: bool, now: bool, event: Event, parameter: i32) {
        if now && !before {
            self.events.push(TcmsEvent { event, parameter });
        }
    }

    fn note_cars(&mut self, before: CarSet, now: CarSet, event: Event) {
        for car in now.without(before).iter() {
            self.note(false, true, event, car as i32 + 1);
        }
    }

    /// Logs what began in this scan.
    fn report(&mut self, inputs: &TcmsInputs, cab: Option<&CabInputs>) {
        let (before, now) = (self.found_before, self.view.found);
        self.note_cars(before.inverters, now.inverters, Event::InverterFailed);
        self.note_cars(before.brake_units, now.brake_units, Event::BrakeUnitFailed);
        self.note_cars(before.cylinders, now.cylinders, Event::BrakeCylinderFailed);
        self.note_cars(
            before.not_released,
            now.not_released,
            Event::BrakeNotReleased,
        );
        self.found_before = now;

        let mut counted = self.counted;
        let regeneration = inputs
            .equipment
            .map_or(CarSet::NONE, |equipment| equipment.regeneration_cut_out);
        self.note_cars(
            counted.regeneration,
            regeneration,
            Event::RegenerationCutOut,
        );
        counted.regeneration = regeneration;

        let volts = self.view.volts;
        let failed = cab.is_some() && self.data.controller_failed(volts);
        let millivolts = (volts * 1000.0).round() as i32;
        self.note(
            counted.controller_failed,
            failed,
            Event::ControllerFailed,
            millivolts,
        );
        counted.controller_failed = failed;

        let contradicts = cab.is_some_and(|cab| cab.controller.power && cab.controller.brake);
        self.note(
            counted.contradicts,
            contradicts,
            Event::ControllerContradicts,
            0,
        );
        counted.contradicts = contradicts;

        let two_cabs = inputs.cabs.iter().all(|cab| cab.hcr);
        self.note(counted.two_cabs, two_cabs, Event::TwoCabsActive, 0);
        counted.two_cabs = two_cabs;

        let low = inputs.main_reservoir_low;
        self.note(counted.main_reservoir_low, low, Event::MainReservoirLow, 0);
        counted.main_reservoir_low = low;

        let contradictions = self.atc.contradictions();
        let more = contradictions > counted.ato_contradictions;
        let effort = i32::from(self.atc.effort());
        self.note(false, more, Event::AtoOrderContradicts, effort);
        counted.ato_contradictions = contradictions;

        let refused = inputs.frames_refused;
        let parameter = i32::try_from(refused).unwrap_or(i32::MAX);
        self.note(
            false,
            refused > counted.frames_refused,
            Event::AtcFramesRefused,
            parameter,
        );
        counted.frames_refused = refused;

        // Silence before the unit was first heard is a unit that is not switched on yet.
        match (counted.atc_silent, self.atc.silent()) {
            (Some(false), true) => self.note(false, true, Event::AtcSilent, 0),
            (Some(true), false) => self.note(false, true, Event::AtcRestored, 0),
            _ => {}
        }
        if counted.atc_silent.is_some() || !self.atc.silent() {
            counted.atc_silent = Some(self.atc.silent());
        }
        self.counted = counted;
    }
}

/// The cab whose head control relay is energised; none when both are.
fn active_cab(cabs: &[CabInputs; 2]) -> Option<&CabInputs> {
    let mut active = cabs.iter().filter(|cab| cab.hcr);
    match (active.next(), active.next()) {
        (Some(cab), None) => Some(cab),
        _ => None,
    }
}

/// Automatic and driverless only while the unit is in automatic: until then, and after it, the driver
/// has the train.
fn mode(cab: Option<&CabInputs>, order: &AtoOrder) -> TcmsMode {
    match cab.map_or(ModeSwitch::Off, |cab| cab.mode_switch) {
        ModeSwitch::Off | ModeSwitch::Unknown(_) => TcmsMode::None,
        ModeSwitch::Emergency => TcmsMode::Emergency,
        ModeSwitch::Yard => TcmsMode::Yard,
        ModeSwitch::Automatic if order.automatic => TcmsMode::Automatic,
        ModeSwitch::Driverless if order.automatic => TcmsMode::Driverless,
        ModeSwitch::Manual | ModeSwitch::Automatic | ModeSwitch::Driverless => TcmsMode::Manual,
    }
}

fn line_inputs(inputs: &TcmsInputs, cab: Option<&CabInputs>) -> LineInputs {
    LineInputs {
        cab_valid: cab.is_some(),
        controller: cab.is_some_and(|cab| cab.controller.emergency),
        buttons: inputs.cabs.map(|cab| cab.emergency_button),
        atc_relay: inputs
            .contacts
            .is_some_and(|contacts| contacts.contains(Outputs::EB_RELAY)),
        main_reservoir_low: inputs.main_reservoir_low,
        cut_out: inputs.eb_cut_out,
    }
}

fn power_cuts(
    inputs: &TcmsInputs,
    cab: Option<&CabInputs>,
    mode: TcmsMode,
    line: &Line,
    brake: &BrakeOutputs,
    found: &Found,
    order: &AtoOrder,
) -> PowerCuts {
    let contact = |output| inputs.contacts.is_some_and(|c| c.contains(output));
    let mut cuts = PowerCuts::default();
    for (cut, holds) in [
        (PowerCuts::DOORS, !inputs.doors_closed),
        (PowerCuts::HCR, cab.is_none()),
        (
            PowerCuts::REVERSER,
            cab.is_some_and(|cab| cab.reverser == 0),
        ),
        (PowerCuts::EMERGENCY, line.applied),
        (PowerCuts::FULL_SERVICE, brake.bcypcut),
        (PowerCuts::ATC, contact(Outputs::POWER_CUT)),
        (PowerCuts::ATC_SILENT, inputs.contacts.is_none()),
        (
            PowerCuts::HOLDING,
            order.holding || contact(Outputs::HOLDING_BRAKE),
        ),
        (PowerCuts::SECURITY, inputs.security_brake),
        (PowerCuts::PARKING, inputs.parking_brake),
        (PowerCuts::NOT_RELEASED, !found.not_released.is_empty()),
        (PowerCuts::MAIN_RESERVOIR, inputs.main_reservoir_low),
        (PowerCuts::MODE, mode == TcmsMode::None),
        (PowerCuts::TURN_BACK, inputs.turn_back),
    ] {
        cuts.set(cut, holds);
    }
    cuts
}

/// Share of full effort, −1..1.
fn share(driving: &DrivingOutputs, brake: &BrakeOutputs) -> f64 {
    if brake.bcymsb {
        return -1.0;
    }
    let value = f64::from(driving.drytebe);
    if value < 0.0 {
        value / f64::from(FULL_BRAKE.abs())
    } else {
        value / f64::from(FULL_POWER)
    }
}

fn lamps(inputs: &TcmsInputs, line: &Line, found: &Found) -> Lamps {
    let forced = active_cab(&inputs.cabs).is_some_and(|cab| cab.forced_release);
    let failed = found
        .inverters
        .with(found.brake_units)
        .with(found.cylinders);
    let mut lamps = Lamps::default();
    for (lamp, lit) in [
        (Lamps::EMERGENCY, line.applied),
        (Lamps::EB_CUT_OUT, inputs.eb_cut_out),
        (Lamps::SECURITY, inputs.security_brake),
        (Lamps::PARKING, inputs.parking_brake),
        (Lamps::FORCED_RELEASE, forced),
        (Lamps::NOT_RELEASED, !found.not_released.is_empty()),
        (Lamps::FAILURE, !failed.is_empty()),
    ] {
        lamps.set(lamp, lit);
    }
    lamps
}

impl TcmsView {
    /// What opens the emergency brake train line.
    pub fn eb_sources(&self) -> EbSources {
        self.line.sources
    }
}
