//! Frames in and out of the unit: requests of the tester, inputs, TCMS, and station data from the loop or the
//! TEST modem, which both pass the TWC antenna.
//! Injected faults of receivers and transmitters act here.

use alloc::boxed::Box;
use alloc::vec::Vec;

use protocol::injection::{Effect, Place};
use protocol::link::Received;
use protocol::message::{
    COIL_SAMPLES, Channel, DoorSide, Message, TcmsToAtc, TrainLines, TwcWayside,
};
use protocol::{Duration, Instant};

use super::{Unit, report};
use crate::com::{ArmConditions, Port};
use crate::receivers::Coils;
use crate::setup::Setup;
use crate::twc::{FromWayside, StationSender};

/// Bits that a damaged frame has wrong, in one byte.
const DAMAGE: u8 = 0x12;

impl Unit {
    /// Latches received inputs and answers requests of the tester.
    pub(super) fn receive_frames(&mut self, now: Instant, out: &mut Vec<u8>) {
        while let Some((port, Received { header, message })) = self.ports.poll(now) {
            if header.channel == Channel::Ptu && port != self.ports.tester_at {
                // Requests of the other port are answered there first.
                self.send_replies(now, out);
                self.ports.tester_at = port;
            }
            match message {
                Message::CoilSamples(samples) => {
                    let config = &self.setup.config;
                    let new = || Box::new(Coils::new(config));
                    self.coils.get_or_insert_with(new).take(&samples);
                }
                Message::IoInput(input) => {
                    let sampled = self.coils.as_mut().and_then(|coils| coils.end_scan(input));
                    (self.image).latch(now, header.stamp_ms, input, sampled);
                    self.hear_loop();
                }
                Message::WheelEntry(entry) => self.take_wheel_entry(now, entry),
                Message::Crosstalk(signal) => self.image.latch_crosstalk(now, signal),
                Message::TcmsToAtc(frame) => self.on_tcms(now, frame),
                Message::CabEntries(entries) => self.take_entries(now, entries),
                Message::TwcWayside(data) => {
                    let sender = StationSender::Loop(header.seq);
                    self.hear_wayside(now, FromWayside::Station(sender, data), out);
                }
                Message::TwcOrders(orders) => {
                    self.hear_wayside(now, FromWayside::Orders(header.seq, orders), out);
                }
                Message::Identify(_) => {
                    let identity = report::identity(self, now);
                    self.ports.send(now, &identity, out);
                }
                other if header.channel == Channel::Ptu => {
                    let conditions = self.arm_conditions();
                    let parts = (&mut self.board, &mut self.log, &mut self.memory);
                    let request = (header.seq, other);
                    self.maintenance
                        .handle(now, request, conditions, parts, &mut self.replies);
                }
                _ => {}
            }
        }
        while let Some(heard) = self.late.pop(now) {
            self.handle_wayside(now, heard, out);
        }
        let conditions = self.arm_conditions();
        let notice = self
            .maintenance
            .step(now, conditions, &mut self.board, &mut self.log);
        self.replies.extend(notice);
        self.follow_arming();
        self.send_replies(now, out);
    }

    /// Takes a scan of sound: of the ATP antenna, and of the TWC and marker antennas together.
    pub fn hear(&mut self, heard: &[[i16; COIL_SAMPLES]; 2]) {
        let config = &self.setup.config;
        let new = || Box::new(Coils::new(config));
        self.coils.get_or_insert_with(new).hear(heard);
    }

    /// Receives the tones of the loop as frames, like any others.
    fn hear_loop(&mut self) {
        if let Some(coils) = &mut self.coils {
            self.ports.link_mut(Port::Loop).push(&coils.twc_bytes);
            coils.forget_twc_bytes();
        }
    }

    pub(super) fn send_replies(&mut self, now: Instant, out: &mut Vec<u8>) {
        for reply in self.replies.drain(..) {
            self.ports.send(now, &reply, out);
        }
    }

    fn on_tcms(&mut self, now: Instant, frame: TcmsToAtc) {
        if !self.loses(Place::TcmsReceiver) && !self.tcms.take(now, frame) {
            self.reject_watch.count_lost(Channel::Tcms);
        }
    }

    /// Data of the wayside on their way through antenna, receiver and TWC CPU.
    pub(super) fn hear_wayside(&mut self, now: Instant, heard: FromWayside, out: &mut Vec<u8>) {
        if self.loses(Place::TwcAntenna) || self.loses(Place::FskReceiver) {
            return;
        }
        let handed_on = match heard {
            FromWayside::Station(sender, data) => self
                .hand_on(now, data)
                .map(|(due, data)| (due, FromWayside::Station(sender, data))),
            FromWayside::Orders(..) => self
                .hand_on(now, TwcWayside::default())
                .map(|(due, _)| (due, heard)),
        };
        match handed_on {
            Some((due, heard)) if due > now => self.late.push(due, heard),
            Some((_, heard)) => self.handle_wayside(now, heard, out),
            None => {}
        }
    }

    fn handle_wayside(&mut self, now: Instant, heard: FromWayside, out: &mut Vec<u8>) {
        match heard {
            FromWayside::Station(sender, data) => self.handle_station(now, sender, data, out),
            FromWayside::Orders(seq, orders) => self.handle_orders(now, seq, &orders, out),
        }
    }

    /// Station data that the TWC CPU hands on, and when; `None` = nothing.
    pub(super) fn hand_on(
        &self,
        now: Instant,
        mut data: TwcWayside,
    ) -> Option<(Instant, TwcWayside)> {
        let mut due = now;
        match self.faults.at(Place::TwcCpu) {
            Some(Effect::Dead) => return None,
            Some(Effect::Delay { ms }) => due += Duration::from_ms(u64::from(ms)),
            Some(Effect::Offset { by }) => {
                data.station = data.station.wrapping_add_signed(by as i16);
            }
            _ => {}
        }
        if let Some(Effect::Offset { by }) = self.faults.at(Place::TwcDoorSide)
            && data.door_side != DoorSide::None
        {
            let side = data.door_side.code().wrapping_add_signed(by as i8);
            data.door_side = DoorSide::from_code(side);
        }
        Some((due, data))
    }

    /// Takes station data and answers them. While the TEST modem sends, the loop is not heard; what is left of
    /// a test that is over counts no more.
    fn handle_station(
        &mut self,
        now: Instant,
        sender: StationSender,
        data: TwcWayside,
        out: &mut Vec<u8>,
    ) {
        if sender.is_test() != self.board.modem.sends() {
            return;
        }
        let Setup { line, .. } = &self.setup;
        let own = self.number.own();
        if !sender.is_test() {
            self.number.hear(data.train_number);
        }
        let guards = self.guards;
        let before = self.log.next_index();
        if let Some(mode) = &mut self.test_mode {
            let twc = &mut mode.functions.twc;
            twc.take(now, data, own, line, guards, &mut self.log);
        }
        let functions = match (sender, &mut self.test_mode) {
            (StationSender::TestModem(_), Some(mode)) => &mut mode.functions,
            (StationSender::TestModem(_), None) => return,
            (StationSender::Loop(_), _) => {
                self.log.leave_out_repeats(Some(before));
                let twc = &mut self.functions.twc;
                twc.take(now, data, own, line, guards, &mut self.log);
                self.log.leave_out_repeats(None);
                &mut self.functions
            }
        };
        let train = functions.train_state();
        let echoes = self.faults.at(Place::TwcAnswer).is_some();
        let told = if echoes { data.train_number } else { own };
        let answer = functions.twc.answer(sender, &data, told, train);
        if self.loses(Place::TwcAntenna) {
            return;
        }
        match sender {
            StationSender::Loop(_) => {
                self.send_through(Place::FskTransmitter, now, &answer.into(), out);
            }
            StationSender::TestModem(_) if !self.faults.loses(Place::FskTransmitter) => {
                self.board.modem.hear(answer);
            }
            StationSender::TestModem(_) => {}
        }
    }

    /// A frame is lost at `place`; one that arrives damaged is counted like any rejected frame.
    pub(super) fn loses(&mut self, place: Place) -> bool {
        let lost = self.faults.loses(place);
        let damaged = lost && matches!(self.faults.at(place), Some(Effect::BitErrors { .. }));
        match place {
            Place::TcmsReceiver if damaged => self.reject_watch.count_lost(Channel::Tcms),
            Place::FskReceiver | Place::TwcAntenna if damaged => {
                self.reject_watch.count_lost(Channel::Twc);
            }
            _ => {}
        }
        lost
    }

    /// Sends by a modem or line driver that may lose or damage the frame.
    pub(super) fn send_through(
        &mut self,
        place: Place,
        now: Instant,
        message: &Message,
        out: &mut Vec<u8>,
    ) {
        if self.faults.dead(place) {
            return;
        }
        let begin = out.len();
        self.ports.send(now, message, out);
        if self.faults.loses(place) {
            let middle = (begin + out.len()) / 2;
            if let Some(byte) = out.get_mut(middle) {
                *byte ^= DAMAGE;
            }
        }
    }

    fn arm_conditions(&self) -> ArmConditions {
        let tachometers = self.functions.atp.tachometers();
        let lines = self.functions.inputs.lines;
        ArmConditions {
            started: self.self_tester.finished(),
            key_on: lines.contains(TrainLines::MAINTENANCE_KEY),
            standing: !self.guards.arm_standstill
                || tachometers.standstill() && !tachometers.faulty(),
            doors_closed: self.functions.atp.doors_closed(),
            brakes_applied: self.brakes_proved(),
        }
    }

    /// The train proves that its brakes are applied: by TCMS, or by a dead EB train line as long as TCMS does not say
    /// that the train is not braked.
    pub(super) fn brakes_proved(&self) -> bool {
        let inputs = &self.functions.inputs;
        let line_dead = inputs.alive && !inputs.lines.contains(TrainLines::EB_LOOP);
        !self.guards.arm_brakes
            || self.tcms.full_service_brake_applied()
            || line_dead && self.tcms.emergency_brake_applied().unwrap_or(true)
    }
}
