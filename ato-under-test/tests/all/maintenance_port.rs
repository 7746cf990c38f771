//! Promises of the unit on the maintenance port, where a laptop is connected aboard a train.

use ato_under_test::Port;
use protocol::link::{End, Link};
use protocol::message::{
    ArmRefusal, ArmRequest, ArmState, Channel, Identify, IoInput, KeepAlive, LogEntry, Message,
    ModeSwitch, TcmsToAtc, TrainLines,
};

use crate::common::{Bench, all, confirm, departure, line};

/// A tester on the maintenance port of a bench's unit.
pub struct Laptop {
    link: Link,
    pub heard: Vec<Message>,
}

impl Laptop {
    pub fn new() -> Self {
        Self {
            link: Link::new(End::Bench),
            heard: Vec::new(),
        }
    }

    /// Sends a message; its bytes.
    pub fn send(&mut self, bench: &mut Bench, message: impl Into<Message>) -> usize {
        let mut bytes = Vec::new();
        self.link.send(bench.now, &message.into(), &mut bytes);
        bench.unit.receive_at(Port::Maintenance, &bytes);
        bytes.len()
    }

    /// One scan of all; what came at the maintenance port.
    pub fn scan(&mut self, bench: &mut Bench) -> usize {
        bench.scan();
        let mut bytes = Vec::new();
        bench.unit.take_maintenance(&mut bytes);
        self.link.push(&bytes);
        while let Some(received) = self.link.poll(bench.now) {
            assert_eq!(received.header.channel, Channel::Ptu);
            self.heard.push(received.message);
        }
        assert_eq!(self.link.counters().rejected_total(), 0);
        bytes.len()
    }

    fn run(&mut self, bench: &mut Bench, scans: usize) -> usize {
        (0..scans).map(|_| self.scan(bench)).sum()
    }

    /// Keeps the unit talking, for a second.
    fn listen(&mut self, bench: &mut Bench) -> usize {
        let mut bytes = 0;
        for _ in 0..5 {
            self.send(bench, KeepAlive { session: 0 });
            bytes += self.run(bench, 20);
        }
        bytes
    }

    fn arm_states(&mut self) -> Vec<(u8, ArmRefusal)> {
        let states = all::<ArmState>(&std::mem::take(&mut self.heard));
        let told = states.iter().map(|state| (state.armed, state.refusal));
        told.collect()
    }
}

/// A unit that stands with the key on, its bench without a tester.
fn aboard() -> (Bench, Laptop) {
    let mut bench = Bench::new(&[]);
    bench.input.lines.insert(TrainLines::MAINTENANCE_KEY);
    bench.keep_alive = false;
    bench.tcms_obeys = true;
    bench.run(1.1);
    bench.answers.clear();
    (bench, Laptop::new())
}

fn arm(laptop: &mut Laptop, bench: &mut Bench, session: u32) {
    laptop.send(bench, ArmRequest { session });
    laptop.run(bench, 2);
    let challenge = all(&laptop.heard).pop().expect("a challenge");
    laptop.send(bench, confirm(challenge, session));
    laptop.run(bench, 2);
    assert_eq!(laptop.arm_states(), [(1, ArmRefusal::None)]);
}

/// Goal: a laptop is answered where it is, and the harness hears nothing of it. Method: identity and a second of
/// status; 20 of them are 1200 bytes, stuffing not counted.
#[test]
fn a_tester_on_the_maintenance_port_is_answered_there_alone() {
    let (mut bench, mut laptop) = aboard();
    assert_eq!(laptop.run(&mut bench, 100), 0, "no tester was heard there");
    let status = bench.status;
    laptop.send(&mut bench, Identify {});
    laptop.scan(&mut bench);
    assert!(matches!(laptop.heard[..], [Message::Identity(_)]));
    let bytes = laptop.listen(&mut bench);
    assert_eq!(laptop.heard.len(), 1 + 20);
    assert!((1200..1400).contains(&bytes), "{bytes} bytes in a second");
    assert!(bench.answers.is_empty(), "{:?}", bench.answers);
    assert_eq!(bench.status, status, "none came at the harness");
    assert!(bench.output.outputs.bits() != 0, "outputs still do");
}

/// Goal: no laptop plays the train. Method: inputs that would change the mode, good TCMS frames and station data at
/// the maintenance port, at the pace of a harness, while the harness says otherwise.
#[test]
fn inputs_at_the_maintenance_port_are_rejected_counted_and_change_nothing() {
    let (mut bench, mut laptop) = aboard();
    bench.tcms = None;
    bench.station = None;
    bench.run(1.5);
    laptop.listen(&mut bench);
    let last = |laptop: &Laptop| match laptop.heard.last() {
        Some(Message::Status(status)) => *status,
        other => panic!("{other:?}"),
    };
    let before = last(&laptop);
    let station = departure(&line().sections[0]);
    for i in 0..100 {
        laptop.send(
            &mut bench,
            IoInput {
                lines: TrainLines::all(),
                mode_switch: ModeSwitch::Yard,
                tacho1_count: 100 * i,
                ..IoInput::default()
            },
        );
        laptop.send(
            &mut bench,
            TcmsToAtc {
                alive: i as u8,
                ..TcmsToAtc::default()
            },
        );
        laptop.send(&mut bench, station);
        laptop.scan(&mut bench);
    }
    laptop.listen(&mut bench);
    let mut after = last(&laptop);
    assert_eq!(after.rejected_frames, before.rejected_frames + 300);
    after.rejected_frames = before.rejected_frames;
    assert_eq!(after, before);
}

/// Goal: one session, whichever port asks, and each is answered at its own. Method: the second tester asks in the
/// same scan in which the first one is at work.
#[test]
fn a_second_tester_on_the_other_port_is_refused_as_busy_at_its_own_port() {
    let (mut bench, mut laptop) = aboard();
    arm(&mut laptop, &mut bench, 7);
    laptop.send(&mut bench, ArmRequest { session: 7 });
    bench.send(ArmRequest { session: 8 });
    laptop.scan(&mut bench);
    let challenged = |m: &Message| matches!(m, Message::ArmChallenge(c) if c.session == 7);
    assert!(laptop.heard.iter().any(challenged), "{:?}", laptop.heard);
    match bench.answers[..] {
        [Message::ArmState(state)] => assert_eq!(
            (state.session, state.armed, state.refusal),
            (8, 0, ArmRefusal::Busy)
        ),
        ref other => panic!("{other:?}"),
    }
}

/// A pulled cable: the notice goes where the tester was.
#[test]
fn arming_lapses_when_the_laptop_falls_silent() {
    let (mut bench, mut laptop) = aboard();
    arm(&mut laptop, &mut bench, 7);
    laptop.run(&mut bench, 110);
    assert_eq!(laptop.arm_states(), [(0, ArmRefusal::TesterSilent)]);
    assert!(bench.answers.is_empty());
    assert!(bench.events().contains(&"arming_lapsed"));
}

/// Goal: damaged frames of a laptop are the maintenance channel's, and logged as such. Method: as many as the unit's
/// configuration allows, half of them at each port.
#[test]
fn rejected_frames_of_both_ports_are_watched_together() {
    let (mut bench, mut laptop) = aboard();
    let most = crate::common::config().link.rejected_per_10s;
    for _ in 0..most.div_ceil(2) {
        for port in [Port::Harness, Port::Maintenance] {
            let mut bytes = Vec::new();
            let mut link = Link::new(End::Bench);
            link.send(bench.now, &Identify {}.into(), &mut bytes);
            let last = bytes.len() - 2;
            bytes[last] ^= 1;
            bench.unit.receive_at(port, &bytes);
        }
        laptop.scan(&mut bench);
    }
    bench.run(0.1);
    bench.keep_alive = true;
    assert!(bench.events().contains(&"frames_rejected"));
    let of_maintenance = |entry: &LogEntry| (entry.code, entry.parameter) == (112, 1);
    assert!(bench.log.iter().any(of_maintenance), "{:?}", bench.log);
}
