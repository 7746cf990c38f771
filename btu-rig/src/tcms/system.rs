//! One scan of TCMS, from its inputs to the demands on the train.

mod driving;

use protocol::message::Outputs;
use protocol::{Duration, Instant};

use crate::train::{CarSet, MAX_CARS, TrainData, TrainInputs};

use super::atc_link::{AtcLink, AtoOrder};
use super::cab_change::CabChange;
use super::causes::{lamps, power_cuts};
use super::consist::Consist;
use super::data::TcmsData;
use super::effort::{Effort, Order};
use super::emergency_line::{Line, LineInputs, emergency_line};
use super::equipment_monitor::{EquipmentFailures, EquipmentMonitor, MonitorInputs};
use super::feedback;
use super::holding_brake::HoldingBrake;
use super::inputs::{CabInputs, TcmsInputs};
use super::mode::TcmsMode;
use super::report::{Report, Scan};
use super::timer::OnDelay;
use super::view::{TcmsEvent, TcmsView};

/// Speed below which the train stands: its direction may change, and its cabs, m/s [default].
const STANDS_MPS: f64 = 0.1;
/// Longest time by which effort moves on in one step, s: after a gap it goes on from where it was.
const LONGEST_STEP_S: f64 = 0.05;

/// Train control and monitoring system of one train, stepped every 20 ms of virtual time.
#[derive(Clone, Debug)]
pub struct Tcms {
    /// Times and thresholds of the train's file.
    pub data: TcmsData,
    pub atc: AtcLink,
    /// Sharing of effort among the cars; `None` for a train that is a point mass.
    effort: Option<Effort>,
    full_load_kg: f64,
    /// Holding brake, share of full service.
    holding_share: f64,
    monitor: EquipmentMonitor,
    holding: HoldingBrake,
    cab_change: CabChange,
    dead_man: OnDelay,
    dead_man_acts: bool,
    /// ATO's direction: backward. It changes at standstill.
    backward: bool,
    /// The full service brake is ordered for another reason than brakes that are not released.
    full_service_otherwise: bool,
    /// Time of the last scan.
    stepped: Option<Instant>,
    /// Result of the last scan.
    pub view: TcmsView,
    report: Report,
}

/// Results of the first steps of a scan that later steps use.
#[derive(Clone, Copy, Debug)]
struct ScanContext<'a> {
    now: Instant,
    inputs: &'a TcmsInputs<'a>,
    cab: Option<&'a CabInputs>,
    order: AtoOrder,
    mode: TcmsMode,
}

impl Tcms {
    /// A system for a train, at its start.
    pub fn new(train: &TrainData) -> Self {
        let data = train.tcms().clone();
        let (effort, holding_share) = match train {
            TrainData::Cars(cars) => (
                Some(Effort::new(Consist::new(cars))),
                cars.service_brake.holding_share,
            ),
            TrainData::Ideal(ideal) => (None, ideal.holding_share),
        };
        let full_service_n = effort
            .as_ref()
            .map_or([0.0; MAX_CARS], |effort| effort.consist.full_service_n);
        Self {
            atc: AtcLink::new(Duration::from_secs(data.order_timeout_s)),
            full_load_kg: train.full_load_kg(),
            holding_share,
            monitor: EquipmentMonitor::new(&data, full_service_n),
            holding: HoldingBrake::new(&data),
            cab_change: CabChange::new(&data),
            dead_man: OnDelay::default(),
            dead_man_acts: false,
            backward: false,
            full_service_otherwise: false,
            stepped: None,
            view: TcmsView::default(),
            report: Report::new(&data),
            effort,
            data,
        }
    }

    /// No effort, nothing found and nothing latched, as when the train is newly put on the track. A holding brake that
    /// the unit asks for is on again in the next scan; a brake of the driver has to last its time again.
    pub fn rest(&mut self) {
        if let Some(effort) = &mut self.effort {
            effort.reset();
        }
        self.monitor.clear();
        self.unlatch();
    }

    /// Clears latches: the holding brake is on only while it is asked for, and a change of cabs under way ends.
    pub fn unlatch(&mut self) {
        self.holding.reset();
        self.cab_change.leave();
    }

    /// Events since the last call, oldest first.
    pub fn take_events(&mut self) -> Vec<TcmsEvent> {
        self.report.take()
    }

    /// Events lost because they were not taken in time.
    pub fn events_lost(&self) -> u32 {
        self.report.lost
    }

    /// One scan; returns the demands on the train.
    pub fn step(&mut self, now: Instant, inputs: &TcmsInputs<'_>) -> TrainInputs {
        let order = self.atc.step(now);
        // Driverless turn-back and put-away brake like the switches of the same name [S4].
        let inputs = &TcmsInputs {
            turn_back: inputs.turn_back || order.change_of_cabs,
            parking_brake: inputs.parking_brake || order.put_away,
            ..*inputs
        };
        let cab = inputs.active_cab();
        let scan = ScanContext {
            now,
            inputs,
            cab,
            mode: TcmsMode::of(cab, &order),
            order,
        };
        let load_kg = self.weigh(inputs.load_kg);
        let line = emergency_line(&line_inputs(&scan));
        let found = self.look(&scan, &line);
        let brake = self.full_service(&scan, &found);
        let powering = self.view.driving.dryinp;
        let speed_mps = feedback::speed_mps(inputs, self.effort.as_ref(), powering, &self.data);
        let holding = self.hold(&scan, speed_mps);
        let power_cuts = power_cuts(inputs, scan.mode, &line, &brake, &found, order.holding);
        let volts = cab.map_or(0.0, |cab| cab.controller.volts);
        let turned = self.turn(&scan, speed_mps);
        let power_cut = !power_cuts.is_empty() || !turned;
        let driving = self.drive(&scan, volts, power_cut, &line);
        let share = Self::share(&driving, &brake);
        let demands = self.share_out(
            &scan,
            &Order {
                share,
                holding,
                no_inverters: line.applied || inputs.security_brake,
                power_cut,
                speed_mps,
                inverters_out: inputs.inverters_cut_out.with(found.inverters),
                brakes_out: inputs.brakes_cut_out.with(found.brake_units),
            },
        );
        self.view = TcmsView {
            mode: scan.mode,
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
            given: feedback::given(inputs.equipment, self.effort.as_ref(), speed_mps, share),
            backward: cab.is_some_and(|cab| cab.reverser < 0) || self.backward,
            cab_order: self
                .cab_change
                .step(now, order.change_of_cabs, speed_mps < STANDS_MPS),
        };
        self.log(&scan);
        self.tell(&scan, share, load_kg)
    }

    /// Takes the load, limited to what the train can carry. Not-a-number counts as a full train, which
    /// brakes hardest.
    fn weigh(&mut self, load_kg: f64) -> f64 {
        let load_kg = if load_kg.is_nan() {
            self.full_load_kg
        } else {
            load_kg.clamp(0.0, self.full_load_kg)
        };
        if let Some(effort) = &mut self.effort
            && effort.consist.load_kg != load_kg
        {
            effort.consist.weigh(load_kg);
            self.monitor.weigh(effort.consist.full_service_n);
        }
        load_kg
    }

    /// State of the equipment, judged by what was asked of it in the last scan.
    fn look(&mut self, scan: &ScanContext<'_>, line: &Line) -> EquipmentFailures {
        let inputs = scan.inputs;
        let Some(equipment) = inputs.equipment else {
            self.monitor.clear();
            return EquipmentFailures::default();
        };
        let wired = line.applied || inputs.security_brake || inputs.parking_brake;
        let ordered = self.view.driving.dryinb || self.view.holding || self.full_service_otherwise;
        self.monitor.step(
            scan.now,
            &MonitorInputs {
                equipment,
                // Air takes its time: cylinders are compared with the force that they should hold by now.
                air_n: self
                    .effort
                    .as_ref()
                    .map_or(&self.view.demands.air_n, Effort::air_due_n),
                nobody_brakes: !ordered && !wired,
                brakes_cut_out: inputs.brakes_cut_out,
                inverters_cut_out: inputs.inverters_cut_out,
                forced_release: scan.cab.is_some_and(|cab| cab.forced_release),
            },
        )
    }

    fn log(&mut self, scan: &ScanContext<'_>) {
        let failed = scan.cab.is_some() && self.data.controller_failed(self.view.volts);
        self.report.step(
            scan.now,
            &Scan {
                inputs: scan.inputs,
                view: &self.view,
                motors: self
                    .effort
                    .as_ref()
                    .map_or(CarSet::NONE, |e| e.consist.motors),
                atc: &self.atc,
                controller_failed: failed,
                dead_man: self.dead_man_acts,
            },
        );
    }

    /// Demands on the train.
    fn tell(&self, scan: &ScanContext<'_>, share: f64, load_kg: f64) -> TrainInputs {
        let (inputs, view) = (scan.inputs, &self.view);
        let held = if view.holding {
            -self.holding_share
        } else {
            1.0
        };
        TrainInputs {
            demand: share.min(held),
            motor_n: view.demands.motor_n,
            air_n: view.demands.air_n,
            emergency: view.line.applied,
            security: inputs.security_brake,
            parking: inputs.parking_brake,
            forced_release: scan.cab.is_some_and(|cab| cab.forced_release),
            brakes_cut_out: inputs.brakes_cut_out,
            inverters_cut_out: inputs.inverters_cut_out,
            backward: view.backward,
            load_kg,
            ..TrainInputs::default()
        }
    }
}

fn line_inputs(scan: &ScanContext<'_>) -> LineInputs {
    LineInputs {
        cab_valid: scan.cab.is_some(),
        controller: scan.cab.is_some_and(|cab| cab.controller.emergency),
        buttons: scan.inputs.cabs.map(|cab| cab.emergency_button),
        atc_relay: scan.inputs.contact(Outputs::EB_RELAY),
        main_reservoir_low: scan.inputs.main_reservoir_low,
        cut_out: scan.inputs.eb_cut_out,
    }
}
