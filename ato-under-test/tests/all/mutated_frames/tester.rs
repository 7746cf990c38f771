//! A tester with rack, TCMS and wayside on one connection: what it says in each scan of the unit.

use std::time::{Duration, Instant};

use protocol::frame::FLAG;
use protocol::message::{
    ArmRequest, Identify, IoInput, KeepAlive, Message, ModeSwitch, ReadLog, StatusBits, Subscribe,
    TcmsToAtc, TcmsToAtcBits, TestCode, TrainLines, TwcWayside,
};

use super::damage::{Damager, Kind};
use super::watch::Watch;
use crate::common::{all, confirm, departure, line};
use crate::maintenance::{CODE_75, SESSION};
use crate::served::{Client, Unit};

/// The unit scans every 10 ms; one that does not for so long is gone.
const GONE: Duration = Duration::from_secs(20);
/// Sound frames that are kept to be said again: the first ones, and the newest.
const FIRST: usize = 40;
const KEPT: usize = 400;

/// Outcome of a connection.
pub struct Ended {
    /// Frames that the unit counts as refused.
    pub refused: u64,
    pub sound: u64,
    pub answered: u64,
    /// Longest time to an answer, and in which this program said nothing.
    pub slowest: Duration,
    pub silent: Duration,
    /// Acts of the unit that no frame may bring about.
    pub faults: Vec<String>,
}

pub struct Tester {
    client: Client,
    watch: Watch,
    station: TwcWayside,
    session: u32,
    scans: u64,
    /// Number of frames sent, as the unit must count them; and whether more of the last one comes.
    frames: u64,
    under_way: bool,
    /// Sound frames, and some of them.
    sound: u64,
    older: Vec<Vec<u8>>,
    said_at: Instant,
    silent: Duration,
    pub bytes: u64,
}

impl Tester {
    /// Connects, and arms the unit if `armed`; from then on it must hold its state.
    pub fn begin(unit: &Unit, armed: bool) -> Self {
        let mut tester = Self {
            client: Client::connect(unit),
            watch: Watch::new(),
            station: departure(&line().sections[0]),
            session: 0,
            scans: 0,
            frames: 0,
            under_way: false,
            sound: 0,
            older: Vec::new(),
            said_at: Instant::now(),
            silent: Duration::ZERO,
            bytes: 0,
        };
        let started = |tester: &Self| tester.watch.is(StatusBits::STARTED);
        assert!(tester.until(500, started), "the unit starts");
        if armed {
            tester.arm();
        }
        // Arming by the connection before has lapsed, and the code is detected.
        tester.quiet(120);
        let answered = tester.until(100, |tester| tester.watch.due.is_empty());
        assert!(answered, "not answered: {:?}", tester.watch.due);
        assert_eq!(tester.watch.is(StatusBits::ARMED), armed);
        tester.watch.hold();
        (tester.frames, tester.sound, tester.silent) = (0, 0, Duration::ZERO);
        tester
    }

    fn arm(&mut self) {
        let session = SESSION;
        self.scan(|tester, out| tester.add(ArmRequest { session }, out));
        for _ in 0..100 {
            let heard = self.hear();
            self.speak(|tester, out| {
                for challenge in all(&heard) {
                    tester.add(confirm(challenge, session), out);
                }
            });
            if self.watch.is(StatusBits::ARMED) {
                self.session = session;
                return;
            }
        }
        panic!("the unit was not armed");
    }

    /// Scans in which nothing but what is due is said.
    pub fn quiet(&mut self, scans: u32) {
        for _ in 0..scans {
            self.scan(|_, _| {});
        }
    }

    /// Sends only what is due until the condition holds, for at most this number of scans.
    fn until(&mut self, scans: u32, so: impl Fn(&Self) -> bool) -> bool {
        for _ in 0..scans {
            if so(self) {
                return true;
            }
            self.quiet(1);
        }
        so(self)
    }

    /// One scan: hears what the unit says in it, then says what is due and what `more` adds.
    pub fn scan(&mut self, more: impl FnOnce(&mut Self, &mut Vec<u8>)) {
        self.hear();
        self.speak(more);
    }

    /// Appends a damaged frame.
    pub fn damage(&mut self, damager: &mut Damager, out: &mut Vec<u8>) -> Kind {
        let now = self.client.now();
        damager.add(&mut self.client.link, now, &self.older, out)
    }

    /// Appends a sound frame that is counted as a damaged one.
    pub fn pass_for_damaged(&mut self, message: impl Into<Message>, out: &mut Vec<u8>) {
        self.add(message, out);
        self.sound -= 1;
    }

    fn speak(&mut self, more: impl FnOnce(&mut Self, &mut Vec<u8>)) {
        let mut bytes = Vec::new();
        self.say_due(&mut bytes);
        more(self, &mut bytes);
        for &byte in &bytes {
            self.frames += u64::from(byte == FLAG && self.under_way);
            self.under_way = byte != FLAG;
        }
        self.bytes += bytes.len() as u64;
        self.silent = self.silent.max(self.said_at.elapsed());
        self.said_at = Instant::now();
        self.client.write(&bytes);
        self.scans += 1;
    }

    fn say_due(&mut self, out: &mut Vec<u8>) {
        let every = |scans| self.scans.is_multiple_of(scans);
        let [cycle, station, asks, subscribes, tests, reads] = [5, 25, 10, 20, 50, 100].map(every);
        let session = self.session;
        self.add(self.inputs(), out);
        self.add(KeepAlive { session }, out);
        if cycle {
            let frame = TcmsToAtc {
                bits: TcmsToAtcBits::FULL_SERVICE_BRAKE | TcmsToAtcBits::SERVICE_BRAKE_APPLIED,
                alive: (self.scans / 5) as u8,
                ..TcmsToAtc::default()
            };
            self.add(frame, out);
        }
        if station {
            let seq = self.say(self.station, out);
            self.watch.due.stations.push(seq);
        }
        if subscribes {
            self.add(Subscribe { changes: 1 }, out);
        }
        if asks {
            self.watch.asked_at = Instant::now();
            self.watch.due.identities += 1;
            self.add(Identify {}, out);
        }
        if tests {
            let code = TestCode {
                code_rate_chz: 1500,
                ..CODE_75
            };
            let seq = self.say(code, out);
            self.watch.due.stimuli.push(seq);
        }
        if reads && self.watch.holds() && self.watch.due.log_ends == 0 {
            let from_index = self.watch.next_index;
            self.watch.due.log_ends += 1;
            self.add(ReadLog { from_index }, out);
        }
    }

    /// A cab with the key turned; the brake line follows the relay.
    fn inputs(&self) -> IoInput {
        let mut lines = TrainLines::DOORS_CLOSED
            | TrainLines::HCR
            | TrainLines::FORWARD
            | TrainLines::MAINTENANCE_KEY
            | TrainLines::EB_LOOP_FED;
        lines.set(TrainLines::EB_LOOP, self.watch.brake_released());
        IoInput {
            lines,
            mode_switch: ModeSwitch::Manual,
            tacho1_edge_us: u16::MAX,
            tacho2_edge_us: u16::MAX,
            marker_edge_us: u16::MAX,
            ..IoInput::default()
        }
    }

    fn add(&mut self, message: impl Into<Message>, out: &mut Vec<u8>) {
        self.say(message, out);
    }

    /// Appends a sound frame; gives its sequence number.
    fn say(&mut self, message: impl Into<Message>, out: &mut Vec<u8>) -> u16 {
        let mut frame = Vec::new();
        let now = self.client.now();
        let seq = self.client.link.send(now, &message.into(), &mut frame);
        out.extend(&frame);
        if self.older.len() < KEPT {
            self.older.push(frame);
        } else {
            let newest = FIRST + self.sound as usize % (KEPT - FIRST);
            self.older[newest] = frame;
        }
        self.sound += 1;
        seq
    }

    /// Waits for a scan of the unit; gives what was heard.
    fn hear(&mut self) -> Vec<Message> {
        let (mut all, began) = (Vec::new(), Instant::now());
        loop {
            let heard = self.client.hear();
            heard.iter().for_each(|message| self.watch.take(message));
            let scanned = heard.iter().any(|m| matches!(m, Message::IoOutput(_)));
            all.extend(heard);
            if scanned {
                return all;
            }
            assert!(!self.client.closed, "the unit let the tester go");
            assert!(began.elapsed() < GONE, "the unit scans no more");
        }
    }

    /// Waits until everything is answered that was asked, and what the last frames did would show.
    pub fn end(mut self) -> Ended {
        let all_heard = |tester: &Self| {
            tester.watch.due.is_empty() && tester.watch.refused >= tester.frames - tester.sound
        };
        self.until(150, all_heard);
        self.quiet(25);
        self.until(50, |tester| tester.watch.due.is_empty());
        let (due, sent) = (&self.watch.due, self.frames - self.sound);
        let link = &self.client.link.counters();
        let mut faults = self.watch.faults;
        if self.watch.refused != sent {
            faults.push(format!(
                "refused {} of {sent} damaged frames",
                self.watch.refused
            ));
        }
        if !due.is_empty() {
            faults.push(format!("not answered: {due:?}"));
        }
        if link.rejected_total() > 0 {
            faults.push(format!("the unit sends damaged frames: {link:?}"));
        }
        Ended {
            refused: self.watch.refused,
            sound: self.sound,
            answered: self.watch.answered,
            slowest: self.watch.slowest,
            silent: self.silent,
            faults,
        }
    }
}
