//! TCMS on the bench: its inputs of each scan, and its state as signals.

use protocol::message::{Channel, EbCause, Mode};
use protocol::signal::{Sample, Signal};
use protocol::{CYCLE, Duration, SCAN, Speed};

use crate::procedure::{EventSource, UnitEvent};
use crate::stimulus::TrainSwitch;
use crate::tcms::{CabOrder, TcmsEvent, TcmsInputs, TcmsView};
use crate::train::TrainInputs;

use super::Rig;
use super::session::MAX_EVENTS;

/// TCMS's own cycle: two scans [default].
const TCMS_CYCLE: Duration = Duration::from_us(2 * SCAN.as_us());

/// Demands of TCMS on each MT pair from the head: inverters, air of trailers, air of motor cars.
pub const PAIR_DEMANDS: [[Signal; 3]; 4] = [
    [Signal::Motor1, Signal::AirTrailer1, Signal::AirMotor1],
    [Signal::Motor2, Signal::AirTrailer2, Signal::AirMotor2],
    [Signal::Motor3, Signal::AirTrailer3, Signal::AirMotor3],
    [Signal::Motor4, Signal::AirTrailer4, Signal::AirMotor4],
];

impl Rig {
    /// Orders to the train in this scan; TCMS is stepped when its cycle is due.
    pub(super) fn orders_of_tcms(&mut self) -> TrainInputs {
        if self.now.as_us().is_multiple_of(TCMS_CYCLE.as_us()) {
            self.train_orders = self.step_tcms();
        }
        self.train_orders
    }

    fn step_tcms(&mut self) -> TrainInputs {
        let rims = Speed::from_mps(self.wheel.velocity_mps().abs());
        if let Some(faults) = self.injected.step(self.now, rims) {
            self.faults = faults;
            self.fail_equipment();
            self.desk.faults = self.faults.desk;
            self.tcms_port.fault = self.faults.tcms;
        }
        let equipment = self.train_driven.then(|| self.train.equipment());
        let refused = self.link.counters().rejected_on(Channel::Tcms);
        let desk = &self.desk;
        let on = |switch| desk.switches.on(switch);
        let inputs = TcmsInputs {
            cabs: desk.cabs(&self.tcms.data),
            doors_closed: desk.doors_proved(),
            main_reservoir_low: desk.main_reservoir_low(),
            eb_cut_out: on(TrainSwitch::EbCutOut),
            security_brake: on(TrainSwitch::SecurityBrake),
            parking_brake: on(TrainSwitch::ParkingBrake),
            turn_back: on(TrainSwitch::TurnBack),
            brakes_cut_out: desk.brakes_cut_out,
            inverters_cut_out: desk.inverters_cut_out,
            contacts: self.latest.outputs(),
            load_kg: self.tcms_port.load_kg,
            equipment: equipment.as_ref(),
            speed_mps: self.wheel.velocity_mps().abs(),
            frames_refused: u32::try_from(refused).unwrap_or(u32::MAX),
        };
        let mut orders = self.tcms.step(self.now, &inputs);
        orders.regeneration_refused = !on(TrainSwitch::Regeneration);
        self.log_tcms();
        let view = &self.tcms.view;
        // Making safe has given the train back to the unit's cab.
        let changes = !self.quiescent && !self.faults.cabs_stay;
        match view.cab_order.filter(|_| changes) {
            Some(CabOrder::GiveUp) => self.desk.hcr = false,
            Some(CabOrder::TakeUp) => self.desk.switches.set(TrainSwitch::OtherCab, true),
            None => {}
        }
        let line = view.line;
        self.desk.set_loop(line.energised, line.fed);
        orders
    }

    /// Keeps TCMS's new events, each with speed, limit, position, mode and brake cause at this moment.
    fn log_tcms(&mut self) {
        let events = self.tcms.take_events();
        let sample = &self.latest.sample;
        let value = |signal| sample.get(signal).unwrap_or(0.0);
        for TcmsEvent { event, parameter } in events {
            let index = self.tcms_logged;
            self.tcms_logged += 1;
            // Nobody takes events while no procedure runs; the newest are of no use without the first.
            if self.tcms_events.len() >= MAX_EVENTS {
                self.tcms_dropped += 1;
                continue;
            }
            self.tcms_events.push(UnitEvent {
                source: EventSource::Tcms,
                index,
                code: event.definition().code,
                at_ms: self.now.stamp_ms(),
                parameter,
                speed: Speed::from_kmh(value(Signal::TrainSpeed)),
                limit: Speed::from_kmh(value(Signal::Limit)),
                position_m: value(Signal::TrainPosition),
                mode: Mode::from_code(value(Signal::Mode) as u8),
                eb_cause: EbCause::from_code(value(Signal::EbCause) as u8),
            });
        }
    }

    /// Records what TCMS does: bits each scan, efforts once in a cycle, as rows have them.
    pub(super) fn record_tcms(&mut self) {
        let view = &self.tcms.view;
        let sample = &mut self.latest.sample;
        record_words(sample, view);
        let alive = self.tcms_port.alive(self.now);
        sample.set_bit(Signal::TcmsAlive, alive);
        if !self.now.as_us().is_multiple_of(CYCLE.as_us()) {
            return;
        }
        for ([motor, trailer_air, motor_air], (motors, trailers)) in
            PAIR_DEMANDS.iter().zip(self.pair_cars)
        {
            sample.set(*motor, motors.sum(&view.demands.motor_n));
            sample.set(*trailer_air, trailers.sum(&view.demands.air_n));
            sample.set(*motor_air, motors.sum(&view.demands.air_n));
        }
        sample.set(Signal::BrakeDemand, view.demands.brake_n);
        sample.set(
            Signal::MotorDemand,
            view.demands.motor_n.iter().sum::<f64>(),
        );
        let state = &self.train_state;
        sample.set(Signal::Traction, state.traction_n);
        sample.set(Signal::ElectricBrake, state.electric_brake_n);
        sample.set(Signal::AirBrake, state.air_brake_n);
    }
}

fn record_words(sample: &mut Sample, view: &TcmsView) {
    for (signal, on) in [
        (Signal::TcmsPower, view.driving.dryinp),
        (Signal::TcmsBrake, view.driving.dryinb),
        (Signal::TcmsCoast, view.driving.dryincoa),
        (Signal::TcmsFsb, view.brake.bcyinfsb),
        (Signal::TcmsMsb, view.brake.bcymsb),
        (Signal::TcmsHolding, view.holding),
    ] {
        sample.set_bit(signal, on);
    }
    for (signal, value) in [
        (Signal::TcmsMode, f64::from(view.mode.code())),
        (Signal::TcmsValue, f64::from(view.driving.drytebe)),
        (Signal::ControllerVolts, view.volts),
        (Signal::PowerCutCauses, f64::from(view.power_cuts.bits())),
        (Signal::EbSources, f64::from(view.line.sources.bits())),
        (Signal::Lamps, f64::from(view.lamps.bits())),
        (
            Signal::NotReleased,
            f64::from(view.found.not_released.bits()),
        ),
    ] {
        sample.set(signal, value);
    }
}
