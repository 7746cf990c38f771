//! The tester's session on the PTU channel: who the unit is, keep-alive, requests, event log.

use protocol::event::Event;
use protocol::link::Link;
use protocol::message::{
    ArmRefusal, Identify, Identity, KeepAlive, LogEnd, Message, SelfTest, Status, StatusBits,
};
use protocol::{Duration, Instant};

use crate::procedure::link_trouble::{Changed, LinkTrouble, Property};
use crate::procedure::{LogState, Refusal};

use super::exchange::Exchange;
use super::identity::bytes_of;
use super::log_reader::LogReader;
use super::request::Request;
use super::test_signals;
use super::unit_clock::UnitClock;

/// Period of the keep-alive: the unit disarms after one second without a keep-alive.
const KEEP_ALIVE: Duration = Duration::from_ms(200);
/// Period in which an unanswered question for the identity is repeated.
const IDENTIFY_AGAIN: Duration = Duration::from_ms(300);
/// Period in which a known unit is asked again: its uptime tells whether it was started again.
const IDENTIFY_CHECK: Duration = Duration::from_ms(2000);
/// An uptime that falls by more than this is a wrapped counter, not a restart.
const UPTIME_WRAP_MS: u32 = 1 << 31;

#[derive(Debug, Default)]
pub struct Tester {
    pub session: u32,
    silent: bool,
    speaks_since: Instant,
    keep_alive_due: Instant,
    identify_due: Instant,
    pub identity: Option<Identity>,
    /// Identity of the unit when it was first asked.
    first: Option<Identity>,
    /// First difference between the unit that answered first and one that answered later.
    changed: Option<LinkTrouble>,
    /// Self-test items that failed, as the unit has said since it was started.
    pub self_test: SelfTest,
    /// Count of events in the last status.
    logged: Option<u32>,
    /// Entries the unit's log had when it was first heard.
    pub events_at_contact: Option<u32>,
    /// Events from before the contact are not read.
    pub leaves_old: bool,
    /// Times the unit was started again.
    pub restarts: u32,
    /// The log says that the unit restarted by itself after it was started.
    restarted_itself: bool,
    pub exchange: Exchange,
    pub log: LogReader,
    /// The log is not read: the unit's store of events is read instead.
    pub holds_log: bool,
    pub clock: UnitClock,
    /// A request to clear the log was made: entries that are gone after it are not missed.
    clears_log: bool,
    /// Entries logged since contact that were gone before they could be read.
    missed: u64,
}

impl Tester {
    /// A tester that listens; `session` must not be 0.
    pub fn new(session: u32) -> Self {
        Self {
            session,
            exchange: Exchange::new(session),
            ..Self::default()
        }
    }

    /// Sends what is due.
    pub fn step(&mut self, now: Instant, link: &mut Link, out: &mut Vec<u8>) {
        if self.silent {
            return;
        }
        if now >= self.identify_due {
            let again = if self.identity.is_some() {
                IDENTIFY_CHECK
            } else {
                IDENTIFY_AGAIN
            };
            self.identify_due = now + again;
            link.send(now, &Identify {}.into(), out);
        }
        if now >= self.keep_alive_due {
            self.keep_alive_due = now + KEEP_ALIVE;
            let session = if self.exchange.armed() {
                self.session
            } else {
                0
            };
            link.send(now, &KeepAlive { session }.into(), out);
        }
        self.exchange.step(now, link, out);
        if self.identity.is_some() {
            self.clock.step(now, link, out);
        }
        if !self.holds_log {
            self.log.step(now, link, out);
        }
    }

    /// Takes a message of the PTU channel.
    pub fn receive(&mut self, now: Instant, message: &Message) {
        match message {
            Message::Identity(identity) => self.on_identity(now, identity),
            Message::Status(status) => self.on_status(now, status),
            Message::ArmChallenge(challenge) => self.exchange.on_challenge(challenge),
            Message::ArmState(state) => self.exchange.on_arm_state(now, state),
            Message::StimulusAnswer(answer) => {
                self.clock.on_answer(answer);
                self.exchange.on_answer(now, answer);
            }
            Message::SelfTestItem(item) => self.exchange.on_self_test_item(item),
            Message::SelfTestEnd(end) => self.exchange.on_self_test_end(end),
            // Nobody asked: what answers unasked is not believed to be the log.
            Message::LogEntry(_) | Message::LogEnd(_) if self.holds_log => {}
            Message::LogEntry(entry) => {
                let event = Event::from_code(entry.code);
                self.restarted_itself |= event.is_some_and(Event::restarts_unit);
                self.log.on_entry(now, entry);
            }
            Message::LogEnd(end) => self.on_log_end(now, end),
            _ => {}
        }
    }

    fn on_log_end(&mut self, now: Instant, end: &LogEnd) {
        let wanted = self.log.next_index();
        self.log.on_end(now, end);
        let since_contact = self.events_at_contact.unwrap_or(u32::MAX).max(wanted);
        if !self.clears_log {
            self.missed += u64::from(end.oldest_index.saturating_sub(since_contact));
        }
    }

    fn on_identity(&mut self, now: Instant, identity: &Identity) {
        let first = self.first.get_or_insert(*identity);
        if self.changed.is_none() {
            self.changed = difference(first, identity);
        }
        let before = self.identity.replace(*identity);
        let fallen = before.map_or(0, |b| b.uptime_ms.saturating_sub(identity.uptime_ms));
        if fallen > 0 && fallen < UPTIME_WRAP_MS {
            self.on_restart(now);
        }
        self.self_test |= identity.self_test;
    }

    fn on_status(&mut self, now: Instant, status: &Status) {
        if self.logged.is_some_and(|before| status.events < before) {
            // The identity that follows has a lower uptime, too: that is the same restart.
            self.identity = None;
            self.on_restart(now);
        }
        self.self_test |= status.self_test;
        self.logged = Some(status.events);
        if self.events_at_contact.is_none() && self.leaves_old {
            self.log.begin_at(status.events);
        }
        self.events_at_contact.get_or_insert(status.events);
        self.log.note_logged(status.events);
        self.exchange
            .on_armed_bit(now, status.bits.contains(StatusBits::ARMED));
    }

    fn on_restart(&mut self, now: Instant) {
        self.restarts += 1;
        self.restarted_itself = false;
        self.logged = None;
        self.events_at_contact = Some(0);
        self.identify_due = now;
        self.self_test = SelfTest::empty();
        self.exchange.on_restart();
        self.clock.restart();
        self.log.restart();
    }

    /// Asks something of the unit.
    ///
    /// # Errors
    /// While the tester is silent, or when too much waits for an answer.
    pub fn request(&mut self, request: Request) -> Result<(), Refusal> {
        if self.silent {
            return Err(Refusal(
                "the tester is silent: let it speak first".to_owned(),
            ));
        }
        if let Request::Stimulus { message, .. } = &request {
            self.clears_log |= matches!(message, Message::ClearLog(_));
        }
        self.exchange.push(request)
    }

    /// Stops sending, dropping requests in progress, or starts again.
    pub fn set_silent(&mut self, now: Instant, silent: bool) {
        if silent && !self.silent {
            self.exchange.replace([]);
        }
        if self.silent && !silent {
            self.speaks_since = now;
            self.log.pause();
        }
        self.silent = silent;
    }

    /// Listens, and disarms if there is anything to disarm.
    pub fn make_safe(&mut self, now: Instant) {
        self.set_silent(now, false);
        if !self.exchange.may_be_armed() {
            self.exchange.replace([]);
        } else if !self.exchange.disarming() {
            let release = test_signals::release(self.session);
            self.exchange.replace([release, Request::Disarm]);
        }
    }

    /// Every request has its outcome.
    ///
    /// # Errors
    /// What the unit refused or did not answer, until it is forgotten.
    pub fn settled(&self) -> Result<bool, Refusal> {
        match self.exchange.failure.as_ref() {
            Some(refusal) => Err(refusal.clone()),
            None => Ok(self.exchange.idle()),
        }
    }

    /// Listening, not armed, nothing under way.
    pub fn safe(&self) -> bool {
        !self.silent && !self.exchange.armed() && self.exchange.idle()
    }

    /// Since when the tester sends; `None` while it is silent.
    pub fn speaks_since(&self) -> Option<Instant> {
        (!self.silent).then_some(self.speaks_since)
    }

    /// Why the unit ended the session by itself, once; not while this tester is silent on purpose.
    pub fn take_session_ended(&mut self) -> Option<ArmRefusal> {
        self.exchange.ended.take().filter(|_| !self.silent)
    }

    /// Whether the unit's last restart came from the unit itself, as its log says; `None` until the log is read.
    pub fn restarted_itself(&self, now: Instant) -> Option<bool> {
        let read = self.logged.is_some() && self.log.state(now) == LogState::Read;
        read.then_some(self.restarted_itself)
    }

    /// How far the log is read.
    pub fn log_state(&self, now: Instant) -> LogState {
        match self.log.state(now) {
            // The silent tester does not ask for the log.
            LogState::Unanswered if self.silent => LogState::Behind,
            state => state,
        }
    }

    /// Why nothing that is heard can be judged: another unit answers, or the log cannot be read.
    pub fn error(&self, now: Instant) -> Option<LinkTrouble> {
        let unread = || self.log.error(now).filter(|_| !self.silent);
        self.changed.clone().or_else(unread)
    }

    /// Entries logged since contact that cannot be read any more.
    pub fn missed(&self) -> Option<LinkTrouble> {
        let entries = self.missed;
        (entries > 0).then_some(LinkTrouble::Overwritten { entries })
    }
}

/// First property in which a unit that answers now differs from the one that answered first.
fn difference(first: &Identity, now: &Identity) -> Option<LinkTrouble> {
    let name = |field: &[u8; 16]| format!("\"{}\"", bytes_of(field).escape_ascii());
    type Read<'a> = &'a dyn Fn(&Identity) -> String;
    let properties: [(Property, Read<'_>); 4] = [
        (Property::Serial, &|of| name(&of.serial)),
        (Property::Configuration, &|of| name(&of.config)),
        (Property::ConfigurationChecksum, &|of| {
            format!("{:08x}", of.config_crc)
        }),
        (Property::TrackChecksum, &|of| format!("{:08x}", of.tdb_crc)),
    ];
    let changed = properties.into_iter().filter_map(|(property, read)| {
        let (was, is) = (read(first), read(now));
        (was != is).then_some(Changed { property, was, is })
    });
    let changed: Vec<_> = changed.collect();
    (!changed.is_empty()).then_some(LinkTrouble::OtherUnit(changed))
}
