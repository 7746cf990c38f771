//! The other end of the wire: answers as WIRE.md says a unit does, and loses frames on request.

use protocol::link::{End, Link};
use protocol::message::{
    Answer, ArmChallenge, ArmRefusal, ArmState, AtcToTcms, Channel, Identity, IoOutput, LogEnd,
    LogEntry, Message, Outputs, SelfTest, Status, StatusBits, StimulusAnswer, TrainState, TwcTrain,
};
use protocol::{Duration, Instant, Random};

use crate::rig::{LinkTrouble, UnitLink};

const CHALLENGE: u32 = 0x7D7E_1234;

pub struct FakeUnit {
    pub link: Link,
    pub random: Random,
    pub scan: u64,
    pub session: Option<u32>,
    pub reading: Option<u32>,
    pub log: Vec<LogEntry>,
    pub oldest: u32,
    /// Identity that the unit tells, its uptime aside.
    pub identity: Identity,
    /// Self-test bits of its status.
    pub self_test: SelfTest,
    /// Whether it answers when its log is asked for.
    pub answers_log: bool,
    /// Entries it sends in a cycle while its log is read.
    pub entries_per_cycle: usize,
    /// Share of frames lost, both ways.
    pub loss: f64,
    pub refusal: ArmRefusal,
    pub answer: Answer,
    /// Channels on which nothing is sent or heard.
    pub dead: Vec<Channel>,
    /// Share by which its clock is faster than the bench's.
    pub clock_gains: f64,
    /// Bytes it sends in each scan beside its frames.
    pub noise: &'static [u8],
    pub to_tcms: AtcToTcms,
    pub outputs: Outputs,
    /// The unit is reached at its harness, too, not at its maintenance port alone.
    pub harness: bool,
    /// The unit knows `Subscribe`.
    pub tells_train_state: bool,
    pub subscribed: bool,
    pub train_state: TrainState,
    /// Every accepted message but the cyclic ones.
    pub heard: Vec<Message>,
    pub bytes_per_scan: Vec<usize>,
    pub all_bytes: Vec<u8>,
}

impl Default for FakeUnit {
    fn default() -> Self {
        Self {
            link: Link::new(End::Unit),
            random: Random::new(99),
            scan: 0,
            session: None,
            reading: None,
            log: Vec::new(),
            oldest: 0,
            identity: Identity::default(),
            self_test: SelfTest::empty(),
            answers_log: true,
            entries_per_cycle: 2,
            loss: 0.0,
            refusal: ArmRefusal::None,
            answer: Answer::Accepted,
            dead: Vec::new(),
            clock_gains: 0.0,
            noise: b"",
            to_tcms: AtcToTcms::default(),
            outputs: Outputs::EB_RELAY,
            harness: true,
            tells_train_state: true,
            subscribed: false,
            train_state: TrainState::default(),
            heard: Vec::new(),
            bytes_per_scan: Vec::new(),
            all_bytes: Vec::new(),
        }
    }
}

impl FakeUnit {
    /// A unit as any other but for this.
    pub fn with(change: impl FnOnce(&mut Self)) -> Self {
        let mut unit = Self::default();
        change(&mut unit);
        unit
    }

    pub fn log_event(&mut self, code: u16) {
        self.log.push(LogEntry {
            index: self.next_index(),
            code,
            ..LogEntry::default()
        });
    }

    /// Power off and on again.
    pub fn restart(&mut self) {
        let heard = std::mem::take(&mut self.heard);
        *self = Self {
            heard,
            loss: self.loss,
            ..Self::default()
        };
    }

    pub fn armed(&self) -> bool {
        self.session.is_some()
    }

    fn next_index(&self) -> u32 {
        self.oldest + self.log.len() as u32
    }

    fn reply(&mut self, seq: u16, message: &Message) -> Option<Message> {
        let arm_state = |session, armed, refusal| ArmState {
            session,
            armed,
            refusal,
        };
        let reply = match *message {
            Message::Identify(_) => Identity {
                uptime_ms: self.scan as u32 * 10,
                ..self.identity
            }
            .into(),
            Message::ArmRequest(m) if self.refusal != ArmRefusal::None => {
                arm_state(m.session, 0, self.refusal).into()
            }
            Message::ArmRequest(m) => ArmChallenge {
                session: m.session,
                challenge: CHALLENGE,
            }
            .into(),
            Message::ArmConfirm(m) if m.answer == !CHALLENGE ^ m.session => {
                self.session = Some(m.session);
                arm_state(m.session, 1, ArmRefusal::None).into()
            }
            Message::ArmConfirm(m) => arm_state(m.session, 0, ArmRefusal::BadAnswer).into(),
            Message::Disarm(m) => {
                self.session = None;
                arm_state(m.session, 0, ArmRefusal::Disarmed).into()
            }
            Message::ReadLog(m) => {
                self.reading = self.answers_log.then_some(m.from_index);
                return None;
            }
            Message::TwcWayside(m) => TwcTrain {
                answered_seq: seq,
                station: m.station,
                train_number: m.train_number,
                ..TwcTrain::default()
            }
            .into(),
            Message::KeepAlive(_) | Message::IoInput(_) | Message::TcmsToAtc(_) => return None,
            Message::Subscribe(_) => {
                self.subscribed = self.tells_train_state;
                return None;
            }
            _ => StimulusAnswer {
                request_seq: seq,
                answer: if self.armed() {
                    self.answer
                } else {
                    Answer::NotArmed
                },
            }
            .into(),
        };
        Some(reply)
    }

    fn read_log(&mut self, replies: &mut Vec<Message>) {
        let Some(from) = self.reading else { return };
        let from = from.max(self.oldest);
        let rest = &self.log[(from - self.oldest) as usize..];
        let some = rest.iter().take(self.entries_per_cycle);
        replies.extend(some.map(|&entry| Message::from(entry)));
        self.reading = Some(from + self.entries_per_cycle as u32);
        if rest.len() <= self.entries_per_cycle || self.entries_per_cycle == 0 {
            let end = LogEnd {
                next_index: self.next_index(),
                oldest_index: self.oldest,
            };
            replies.push(end.into());
            self.reading = None;
        }
    }

    fn cyclic(&self, replies: &mut Vec<Message>) {
        if self.harness {
            let output = IoOutput {
                outputs: self.outputs,
                ..IoOutput::default()
            };
            replies.push(output.into());
        }
        if self.scan.is_multiple_of(5) {
            if self.harness {
                replies.push(self.to_tcms.into());
            }
            let mut status = Status {
                events: self.next_index(),
                rejected_frames: self.link.counters().rejected_total() as u16,
                self_test: self.self_test,
                ..Status::default()
            };
            status.bits.set(StatusBits::ARMED, self.armed());
            replies.push(status.into());
            if self.subscribed {
                replies.push(self.train_state.into());
            }
        }
    }
}

impl UnitLink for FakeUnit {
    fn exchange(
        &mut self,
        now: Instant,
        to_unit: &[u8],
        from_unit: &mut Vec<u8>,
    ) -> Result<(), LinkTrouble> {
        let gained = now.since(Instant::ZERO).as_secs() * self.clock_gains;
        let now = now + Duration::from_secs(gained);
        self.scan += 1;
        self.bytes_per_scan.push(to_unit.len());
        self.all_bytes.extend_from_slice(to_unit);
        self.link.push(to_unit);
        let mut replies = Vec::new();
        while let Some(received) = self.link.poll(now) {
            let cyclic = matches!(received.header.channel, Channel::Io | Channel::Tcms);
            if self.dead.contains(&received.header.channel)
                || (!cyclic && self.random.unit() < self.loss)
            {
                continue;
            }
            replies.extend(self.reply(received.header.seq, &received.message));
            if !cyclic {
                self.heard.push(received.message);
            }
        }
        if self.scan.is_multiple_of(5) {
            self.read_log(&mut replies);
        }
        self.cyclic(&mut replies);
        for message in replies {
            let mut frame = Vec::new();
            self.link.send(now, &message, &mut frame);
            let lost = self.random.unit() < self.loss || self.dead.contains(&message.channel());
            if !lost {
                from_unit.extend_from_slice(&frame);
            }
        }
        from_unit.extend_from_slice(self.noise);
        Ok(())
    }
}
