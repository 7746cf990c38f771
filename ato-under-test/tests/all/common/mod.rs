//! A bench of a few lines: holds an input frame, talks to the unit through the wire.

// Each test file uses its own part of the bench.
#![allow(dead_code)]

use std::f64::consts::PI;

use ato_under_test::flash::BlockDevice;
use ato_under_test::{Setup, Unit};
use protocol::config::UnitConfig;
use protocol::injection::{Effect, FaultMode, Occurrence, Place};
use protocol::line::Line;
use protocol::link::{End, Link};
use protocol::message::{
    ArmChallenge, ArmConfirm, AtcToTcms, Channel, IoInput, IoOutput, KeepAlive, LogEntry, Message,
    ModeSwitch, Outputs, ReadLog, Status, TcmsToAtc, TcmsToAtcBits, TestTwc, TrainLines,
    TwcWayside,
};
use protocol::{Instant, SCAN};

/// A fault of some part, from power-up on.
pub fn fault(place: Place, effect: Effect) -> FaultMode {
    FaultMode {
        id: "part.mode".into(),
        lru: protocol::LruId::from_static("part"),
        mode: String::new(),
        severity: "major".into(),
        weight: 1.0,
        unsafe_: false,
        place,
        effect,
        out_of_reach: None,
        onset_s: 0.0,
        car: None,
        occurs: Occurrence::Always,
        levels: Vec::new(),
    }
}

/// A fault that sets in at this time after power-up, s.
pub fn fault_from(place: Place, effect: Effect, onset_s: f64) -> FaultMode {
    FaultMode {
        onset_s,
        ..fault(place, effect)
    }
}

pub struct Bench {
    pub unit: Unit,
    pub link: Link,
    pub now: Instant,
    pub input: IoInput,
    /// Speeds of the two wheels, m/s, negative = backward.
    pub speeds: [f64; 2],
    pub station: Option<TwcWayside>,
    pub session: u32,
    pub io: bool,
    pub keep_alive: bool,
    pub output: IoOutput,
    pub status: Status,
    /// Frame of TCMS in each cycle, its alive counter left out; `None` = none.
    pub tcms: Option<TcmsToAtc>,
    /// The unit says that it is armed.
    pub armed: bool,
    /// Last frame of the unit to TCMS.
    pub to_tcms: AtcToTcms,
    /// TCMS orders the full service brake when the unit asks for it.
    pub tcms_obeys: bool,
    /// The brake line stays energised, whatever the relay does.
    pub welded: bool,
    /// The alive counter of TCMS stands still.
    pub alive_stands: bool,
    /// The emergency brake is cut out: an open line does not apply it.
    pub eb_cut_out: bool,
    /// Something besides the unit's relay opens the emergency brake line.
    pub opens_line: bool,
    /// Bits of the tachometers' phase beside the two that have a meaning.
    pub backward_bits: u8,
    pub answers: Vec<Message>,
    pub log: Vec<LogEntry>,
    /// Bytes that the unit sent in the last scan.
    pub sent: Vec<u8>,
    turned: [f64; 2],
    scans: u64,
    alive: u8,
}

pub fn config() -> UnitConfig {
    UnitConfig::from_toml(include_str!("../../../../scripts/units/sg100.toml")).unwrap()
}

pub fn line() -> Line {
    Line::from_toml(include_str!("../../../../scripts/lines/line8.toml")).unwrap()
}

pub fn departure(section: &protocol::line::Section) -> TwcWayside {
    TwcWayside {
        route: section.route,
        section: section.section,
        station: section.from_station,
        next_station: section.to_station,
        loop_id: section.from_loop,
        fixed_speed_kmh: 255,
        train_number: config().train.number,
        ..TwcWayside::default()
    }
}

/// Station data as a request to the TEST module.
pub fn test_station(session: u32, data: TwcWayside) -> TestTwc {
    TestTwc {
        session,
        route: data.route,
        section: data.section,
        station: data.station,
        next_station: data.next_station,
        loop_id: data.loop_id,
        fixed_speed_kmh: data.fixed_speed_kmh,
        running_mode: data.running_mode,
        door_side: data.door_side,
        departure: data.departure,
        train_number: data.train_number,
    }
}

/// Carrier, Hz, and code rate, 0.01 Hz, of the code called `name`.
pub fn signal_of(name: &str) -> (u16, u16) {
    let config = config();
    let code = config.codes.iter().find(|code| code.name == name).unwrap();
    (code.carrier_hz as u16, (code.rate_hz * 100.0) as u16)
}

pub fn setup(faults: &[FaultMode]) -> Setup {
    Setup {
        serial: "T-1".into(),
        config: config(),
        config_crc: 1,
        line: line(),
        tdb_crc: 2,
        seed: 7,
        faults: faults.to_vec(),
    }
}

/// All messages of one kind.
pub fn all<T: TryFrom<Message>>(messages: &[Message]) -> Vec<T> {
    let of_kind = |message: &Message| T::try_from(*message).ok();
    messages.iter().filter_map(of_kind).collect()
}

/// What a tester confirms of a challenge.
pub fn confirm(challenge: ArmChallenge, session: u32) -> ArmConfirm {
    ArmConfirm {
        session,
        answer: !challenge.challenge ^ session,
    }
}

impl Bench {
    pub fn new(faults: &[FaultMode]) -> Self {
        let mut bench = Self::powered_up(Unit::new(setup(faults)));
        bench.run(2.0);
        bench
    }

    /// A standing train whose unit hears this code.
    pub fn hearing(code: &str, faults: &[FaultMode]) -> Self {
        let mut bench = Self::new(faults);
        bench.code(code);
        bench.run(0.6);
        bench
    }

    /// A sound unit that hears this code, and a train at this speed from now on.
    pub fn under(code: &str, speed_kmh: f64) -> Self {
        let mut bench = Self::hearing(code, &[]);
        bench.speed_kmh(speed_kmh);
        bench
    }

    /// Powered up while something else opens the emergency brake line.
    pub fn unfed(faults: &[FaultMode]) -> Self {
        let mut bench = Self::powered_up(Unit::new(setup(faults)));
        bench.opens_line = true;
        bench.run(2.0);
        bench
    }

    /// A unit that is powered up with this flash, and at whose harness there is a tester at most.
    pub fn alone(flash: Box<dyn BlockDevice>) -> Self {
        let mut bench = Self::powered_up(Unit::with_flash(setup(&[]), flash));
        bench.io = false;
        (bench.station, bench.tcms) = (None, None);
        bench
    }

    /// The unit with its flash, after its supply was off and on.
    pub fn power_cycle(self) -> Self {
        Self::alone(self.unit.power_off())
    }

    fn powered_up(unit: Unit) -> Self {
        Self {
            unit,
            link: Link::new(End::Bench),
            now: Instant::ZERO,
            input: IoInput {
                lines: TrainLines::DOORS_CLOSED | TrainLines::HCR | TrainLines::FORWARD,
                mode_switch: ModeSwitch::Manual,
                ..IoInput::default()
            },
            speeds: [0.0; 2],
            station: Some(departure(&line().sections[0])),
            session: 0,
            io: true,
            keep_alive: true,
            output: IoOutput::default(),
            status: Status::default(),
            tcms: Some(TcmsToAtc {
                bits: TcmsToAtcBits::ATO_ENABLE,
                ..TcmsToAtc::default()
            }),
            armed: false,
            to_tcms: AtcToTcms::default(),
            tcms_obeys: false,
            welded: false,
            alive_stands: false,
            opens_line: false,
            eb_cut_out: false,
            backward_bits: 0,
            answers: Vec::new(),
            log: Vec::new(),
            sent: Vec::new(),
            turned: [0.0; 2],
            scans: 0,
            alive: 0,
        }
    }

    /// Sends the code called `name`.
    pub fn code(&mut self, name: &str) {
        (self.input.carrier_hz, self.input.code_rate_chz) = signal_of(name);
        self.input.level_mv = 500;
    }

    /// A carrier that nothing modulates.
    pub fn unmodulated(&mut self) {
        self.code("0");
        self.input.code_rate_chz = 0;
    }

    /// Brings both wheels to a speed at 3 m/s².
    pub fn speed_kmh(&mut self, kmh: f64) {
        let goal = kmh / 3.6;
        while (self.speeds[0] - goal).abs() > 0.03 {
            let step = 0.03 * (goal - self.speeds[0]).signum();
            self.speeds = self.speeds.map(|speed| speed + step);
            self.scan();
        }
        self.speeds = [goal; 2];
    }

    /// Brings both wheels to a stop at 3 m/s².
    pub fn stop(&mut self) {
        while self.speeds != [0.0; 2] {
            self.speeds = self.speeds.map(|speed| speed - speed.clamp(-0.03, 0.03));
            self.scan();
        }
    }

    pub fn run(&mut self, seconds: f64) {
        for _ in 0..(seconds * 100.0).round() as u64 {
            self.scan();
        }
    }

    /// Runs until `done`, at most `seconds`; the time it took in ms.
    pub fn until(&mut self, seconds: f64, mut done: impl FnMut(&Self) -> bool) -> Option<u64> {
        let begin = self.now;
        for _ in 0..(seconds * 100.0) as u64 {
            if done(self) {
                return Some(self.now.since(begin).as_ms());
            }
            self.scan();
        }
        None
    }

    pub fn send(&mut self, message: impl Into<Message>) {
        let mut bytes = Vec::new();
        self.link.send(self.now, &message.into(), &mut bytes);
        self.unit.receive(&bytes);
    }

    pub fn scan(&mut self) {
        self.now += SCAN;
        self.scans += 1;
        let fed = !self.opens_line;
        let released = self.output.outputs.contains(Outputs::EB_RELAY);
        let eb_loop = fed && (released || self.welded);
        self.input.lines.set(TrainLines::EB_LOOP_FED, fed);
        self.input.lines.set(TrainLines::EB_LOOP, eb_loop);
        self.turn_wheels();
        if self.io {
            self.send(self.input);
        }
        if let Some(frame) = self.tcms.filter(|_| self.scans.is_multiple_of(5)) {
            if !self.alive_stands {
                self.alive = self.alive.wrapping_add(1);
            }
            let mut bits = frame.bits;
            if self.tcms_obeys && self.has(Outputs::FSB) {
                bits.insert(
                    TcmsToAtcBits::FULL_SERVICE_BRAKE | TcmsToAtcBits::SERVICE_BRAKE_APPLIED,
                );
            }
            if !eb_loop && !self.eb_cut_out {
                bits.insert(TcmsToAtcBits::EMERGENCY_BRAKE_APPLIED);
            }
            self.send(TcmsToAtc {
                alive: self.alive,
                bits,
                ..frame
            });
        }
        if self.scans.is_multiple_of(20) && self.keep_alive {
            self.send(KeepAlive {
                session: self.session,
            });
        }
        if let Some(station) = self.station.filter(|_| self.scans.is_multiple_of(25)) {
            self.send(station);
        }
        self.sent.clear();
        self.unit.step(self.now, &mut self.sent);
        self.link.push(&self.sent);
        while let Some(received) = self.link.poll(self.now) {
            match received.message {
                Message::IoOutput(output) => self.output = output,
                Message::Status(status) => self.status = status,
                Message::LogEntry(entry) => self.log.push(entry),
                Message::AtcToTcms(orders) => self.to_tcms = orders,
                Message::TwcTrain(_) | Message::LogEnd(_) => {}
                other => {
                    if let Message::ArmState(state) = other {
                        self.armed = state.armed == 1;
                    }
                    self.answers.push(other);
                }
            }
        }
    }

    /// Bytes of the maintenance channel that the unit sent in the last scan.
    pub fn ptu_bytes(&self) -> usize {
        let frames = self.sent.split(|&byte| byte == 0x7E);
        let own = frames.filter(|frame| frame.get(1) == Some(&Channel::Ptu.code()));
        own.map(|frame| frame.len() + 2).sum()
    }

    /// The last message of a kind among the answers.
    pub fn last<T: TryFrom<Message>>(&self) -> Option<T> {
        all(&self.answers).pop()
    }

    fn turn_wheels(&mut self) {
        let pulse = PI * 0.86 / 100.0;
        let mut counts = [0u16; 2];
        let mut ages = [0u16; 2];
        for i in 0..2 {
            let speed = self.speeds[i].abs();
            self.turned[i] += speed * SCAN.as_secs() / pulse;
            counts[i] = self.turned[i] as u64 as u16;
            let beyond = self.turned[i].fract() * pulse;
            ages[i] = if speed > 0.0 {
                (beyond / speed * 1e6).min(65535.0) as u16
            } else {
                65535
            };
        }
        (self.input.tacho1_count, self.input.tacho2_count) = (counts[0], counts[1]);
        (self.input.tacho1_edge_us, self.input.tacho2_edge_us) = (ages[0], ages[1]);
        self.input.tacho_backward = u8::from(self.speeds[0] < 0.0)
            | u8::from(self.speeds[1] < 0.0) << 1
            | self.backward_bits;
    }

    /// The counters jump, as when a rack is restarted.
    pub fn jump_counts(&mut self, one: u16, two: u16) {
        self.turned = [f64::from(one), f64::from(two)];
    }

    /// Back to rest: standing, key on, nothing in the rail, every brake acknowledged.
    pub fn rest(&mut self) {
        self.speeds = [0.0; 2];
        self.input.level_mv = 0;
        self.input.controller = 0;
        self.keep_alive = true;
        self.tcms_obeys = true;
        self.input.lines = TrainLines::DOORS_CLOSED
            | TrainLines::HCR
            | TrainLines::FORWARD
            | TrainLines::MAINTENANCE_KEY;
        if !matches!(self.input.mode_switch, ModeSwitch::Automatic) {
            self.input.mode_switch = ModeSwitch::Manual;
        }
        self.run(0.7);
        self.acknowledge();
    }

    pub fn marker(&mut self, marker: u8) {
        self.input.marker = marker;
        self.input.marker_edges = self.input.marker_edges.wrapping_add(1);
        self.input.marker_edge_us = 0;
        self.run(0.1);
    }

    pub fn has(&self, output: Outputs) -> bool {
        self.output.outputs.contains(output)
    }

    pub fn braking(&self) -> bool {
        !self.has(Outputs::EB_RELAY)
    }

    pub fn acknowledge(&mut self) {
        self.input.lines.insert(TrainLines::ACKNOWLEDGE);
        self.run(0.2);
        self.input.lines.remove(TrainLines::ACKNOWLEDGE);
        self.run(0.2);
    }

    /// Names of all logged events.
    pub fn events(&mut self) -> Vec<&'static str> {
        self.log.clear();
        self.send(ReadLog { from_index: 0 });
        self.run(3.0);
        let name = |entry: &LogEntry| {
            protocol::event::Event::from_code(entry.code)
                .unwrap()
                .definition()
                .name
        };
        self.log.iter().map(name).collect()
    }

    /// Parameters with which an event is logged.
    pub fn parameters(&mut self, name: &str) -> Vec<i32> {
        let events = self.events();
        let logged = events.iter().zip(&self.log);
        let of_event = logged.filter(|(event, _)| **event == name);
        of_event.map(|(_, entry)| entry.parameter).collect()
    }
}
