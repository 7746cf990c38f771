//! Orders of the wayside and entries of the cab: whether the train is in the state for them, and what becomes of them.

use alloc::vec::Vec;

use protocol::Instant;
use protocol::event::Event;
use protocol::injection::Place;
use protocol::message::{
    CabEntries, Mode, ModeSwitch, OrderLacks, OrderState, TrainLines, TrainOrder, TwcOrders,
    TwcReport, WheelEntry,
};

use super::Unit;
use super::functions::{Functions, Surroundings};
use crate::driverless::{CabInputs, StablingInputs};
use crate::kernel::EventLog;
use crate::timer::ms;
use crate::twc::departs;

impl Unit {
    /// Takes orders and reports what became of them. While the TEST modem sends, the loop is not heard.
    pub(super) fn handle_orders(
        &mut self,
        now: Instant,
        seq: u16,
        orders: &TwcOrders,
        out: &mut Vec<u8>,
    ) {
        if self.board.modem.sends() {
            return;
        }
        let setup = &self.setup;
        let own = self.number.own();
        self.number.hear(orders.train_number);
        let functions = &mut self.functions;
        let known = (&setup.line, &setup.config.orders);
        let order = functions
            .twc
            .take_orders(now, orders, own, known, self.guards, &mut self.log);
        if let Some(order) = order {
            let armed = self.test_mode.is_some();
            functions.obey(now, order, armed, &mut self.log);
        }
        let (received, refused, others) = functions.twc.counts();
        let report = TwcReport {
            answered_seq: seq,
            train_number: own,
            number_state: self.number.state(),
            destination: functions.twc.destination(),
            order_state: functions.order_state(),
            received,
            refused,
            others,
        };
        if !self.loses(Place::TwcAntenna) {
            self.send_through(Place::FskTransmitter, now, &report.into(), out);
        }
    }

    /// Takes what is keyed in at the cab: it counts at standstill, outside an automatic run and with no tester armed.
    pub(super) fn take_entries(&mut self, now: Instant, entries: CabEntries) {
        if !self.guards.cab_entries {
            return;
        }
        let may_change = self.takes_entries();
        let frames = self.setup.config.orders.entry_frames;
        self.number
            .key_in(now, entries.train_number, frames, may_change, &mut self.log);
    }

    fn takes_entries(&self) -> bool {
        let atp = &self.functions.atp;
        atp.tachometers().standstill()
            && atp.sequence().mode() != Mode::AutomaticRun
            && self.test_mode.is_none()
    }

    /// Takes a wheel diameter that is keyed in: it sets the way per pulse from now on, and what markers showed of the
    /// wheels before counts no more. A diameter that no wheel of the train has is refused.
    pub(super) fn take_wheel_entry(&mut self, now: Instant, entry: WheelEntry) {
        let frames = self.setup.config.orders.entry_frames;
        if !self.wheel_entry.hear(now, entry.diameter_01mm, frames) {
            return;
        }
        let tacho = &self.setup.config.tacho;
        let (least_mm, most_mm) = (
            self.configured_wheel_mm - tacho.worn_mm,
            self.configured_wheel_mm + tacho.over_mm,
        );
        let diameter_mm = match entry.diameter_01mm {
            0 => self.configured_wheel_mm,
            keyed_01mm => f64::from(keyed_01mm) / 10.0,
        };
        let in_range = (least_mm..=most_mm).contains(&diameter_mm) || !self.guards.wheel;
        let parameter = i32::from(entry.diameter_01mm);
        if !in_range || !self.takes_entries() {
            self.log.push(now, Event::WheelRefused, parameter);
            return;
        }
        if diameter_mm == tacho.wheel_diameter_mm {
            return;
        }
        self.setup.config.tacho.wheel_diameter_mm = diameter_mm;
        let pulse_m = self.setup.config.metres_per_pulse();
        self.functions.atp.set_pulse(pulse_m);
        self.functions.locator.set_pulse(pulse_m);
        self.board.set_pulse(pulse_m);
        self.log.push(now, Event::WheelEntered, parameter);
    }
}

impl Functions {
    /// Begins what the wayside orders, if the train is in the state for it. What is under way already is no new order.
    fn obey(&mut self, now: Instant, order: TrainOrder, armed: bool, log: &mut EventLog) {
        let done = match order {
            TrainOrder::TurnBack => self.cabs.asks() || self.cabs.handed_over(),
            TrainOrder::PutAway => self.stabling.state() == Some(OrderState::PutAway),
            TrainOrder::WakeUp => self.order_state() == OrderState::Waking,
            TrainOrder::None | TrainOrder::Unknown(_) => true,
        };
        if done {
            return;
        }
        let lacks = self.lacks(order, armed);
        if !lacks.is_empty() {
            log.push(now, Event::OrderRefused, i32::from(lacks.bits()));
            return;
        }
        match order {
            TrainOrder::TurnBack => self.cabs.turn_back(now, self.twc.destination()),
            TrainOrder::PutAway => self.stabling.put_away(now, log),
            _ => self.stabling.wake_up(),
        }
    }

    /// Conditions of an order that the train lacks.
    fn lacks(&self, order: TrainOrder, armed: bool) -> OrderLacks {
        let mut lacks = OrderLacks::empty();
        lacks.set(OrderLacks::DISARMED, armed);
        if order == TrainOrder::WakeUp {
            lacks.set(OrderLacks::PUT_AWAY, !self.stabling.can_wake());
            return lacks;
        }
        let lines = self.inputs.lines;
        let standstill = self.atp.tachometers().standstill();
        lacks.set(OrderLacks::STANDSTILL, !standstill);
        lacks.set(OrderLacks::DOORS_CLOSED, !self.atp.doors_closed());
        lacks.set(OrderLacks::DRIVERLESS, !self.driverless());
        lacks.set(OrderLacks::CAB_ACTIVE, !lines.contains(TrainLines::HCR));
        let running = self.atp.sequence().mode() == Mode::AutomaticRun;
        lacks.set(OrderLacks::RUN_ENDED, running);
        let busy = self.cabs.busy() || self.stabling.asleep();
        lacks.set(OrderLacks::FREE, busy);
        if order == TrainOrder::TurnBack {
            let here = self.twc.data.as_ref().map(|data| data.station);
            let arrived = here == Some(self.twc.destination()) && self.at_platform();
            let aligned = standstill && self.locator.aligned();
            lacks.set(OrderLacks::AT_DESTINATION, !(arrived && aligned));
        }
        lacks
    }

    /// One cycle of turn-back and put-away.
    pub(super) fn carry_out(
        &mut self,
        now: Instant,
        around: &Surroundings<'_>,
        log: &mut EventLog,
    ) {
        let setup = around.setup;
        let data = self.station_data();
        let departure = data.is_some_and(|data| data.departure == 1);
        let running = self.atp.sequence().mode() == Mode::AutomaticRun;
        let begins = data.filter(|data| {
            let section = setup.line.section(data.section);
            section.is_some_and(|section| departs(data, section))
        });
        let hcr = self.inputs.lines.contains(TrainLines::HCR);
        let cabs = CabInputs {
            hcr: self.inputs.alive.then_some(hcr),
            dropped_by_tcms: around.tcms.reads_cab_unmanned(),
            driverless: !self.inputs.alive || self.driverless(),
            standstill: self.atp.tachometers().standstill(),
            running,
            departs_from: begins.map(|data| data.station),
            departure,
        };
        self.cabs
            .step(now, cabs, ms(setup.config.orders.cab_change_ms), log);
        let tester = around.self_tester;
        let stabling = StablingInputs {
            driverless: self.inputs.alive.then_some(self.driverless()),
            tested: tester.finished().then_some(tester.failed()),
            departure,
            running,
        };
        self.stabling.step(now, stabling, log);
    }

    pub(super) fn driverless(&self) -> bool {
        self.inputs.mode_switch == ModeSwitch::Driverless
    }

    pub(super) fn order_state(&self) -> OrderState {
        match (self.stabling.state(), self.cabs.state()) {
            // A train that is ready for a departure may have changed its cabs meanwhile.
            (None | Some(OrderState::Ready), cabs) if cabs != OrderState::Idle => cabs,
            (stabling, _) => stabling.unwrap_or(OrderState::Idle),
        }
    }

    /// An order holds the train: no run may begin.
    pub(super) fn ordered_to_stay(&self) -> bool {
        self.cabs.bars_run() || self.stabling.sleeps()
    }
}
