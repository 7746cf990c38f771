//! The tester's session on the PTU channel: who the unit is, keep-alive, requests, event log.

use protocol::link::Link;
use protocol::message::{Identify, Identity, KeepAlive, Message, Status, StatusBits};
use protocol::{Duration, Instant};

use crate::procedure::{Refusal, UnitEvent};

use super::exchange::{Exchange, Request};
use super::log_reader::LogReader;
use super::test_signals;

/// Period of the keep-alive: the unit disarms after one second without.
const KEEP_ALIVE: Duration = Duration::from_ms(200);
/// Period in which an unanswered question for the identity is repeated.
const IDENTIFY_AGAIN: Duration = Duration::from_ms(300);
/// Period in which a known unit is asked again: its uptime tells whether it was started again.
const IDENTIFY_CHECK: Duration = Duration::from_ms(2000);
/// An uptime that falls by more than this is a wrapped counter, not a restart.
const UPTIME_WRAP_MS: u32 = 1 << 31;

/// The tester.
#[derive(Debug)]
pub struct Tester {
    session: u32,
    silent: bool,
    speaks_since: Instant,
    keep_alive_due: Instant,
    identify_due: Instant,
    identity: Option<Identity>,
    /// Count of events in the last status.
    logged: Option<u32>,
    events_at_contact: Option<u32>,
    /// Those are not read.
    leaves_old: bool,
    restarts: u32,
    exchange: Exchange,
    log: LogReader,
}

impl Tester {
    /// A tester that listens; `session` must not be 0.
    pub fn new(session: u32) -> Self {
        Self {
            session,
            silent: false,
            speaks_since: Instant::ZERO,
            keep_alive_due: Instant::ZERO,
            identify_due: Instant::ZERO,
            identity: None,
            logged: None,
            events_at_contact: None,
            leaves_old: false,
            restarts: 0,
            exchange: Exchange::new(session),
            log: LogReader::default(),
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
        self.log.step(now, link, out);
    }

    /// Takes a message of the PTU channel.
    pub fn hear(&mut self, now: Instant, message: &Message) {
        match message {
            Message::Identity(identity) => self.hear_identity(now, identity),
            Message::Status(status) => self.hear_status(now, status),
            Message::ArmChallenge(challenge) => self.exchange.hear_challenge(challenge),
            Message::ArmState(state) => self.exchange.hear_arm_state(now, state),
            Message::StimulusAnswer(answer) => self.exchange.hear_answer(answer),
            Message::LogEntry(entry) => self.log.hear_entry(now, entry),
            Message::LogEnd(end) => self.log.hear_end(end),
            _ => {}
        }
    }

    fn hear_identity(&mut self, now: Instant, identity: &Identity) {
        let before = self.identity.replace(*identity);
        let fallen = before.map_or(0, |b| b.uptime_ms.saturating_sub(identity.uptime_ms));
        if fallen > 0 && fallen < UPTIME_WRAP_MS {
            self.hear_restart(now);
        }
    }

    fn hear_status(&mut self, now: Instant, status: &Status) {
        if self.logged.is_some_and(|before| status.events < before) {
            // The identity that follows has a lower uptime, too: that is the same restart.
            self.identity = None;
            self.hear_restart(now);
        }
        self.logged = Some(status.events);
        if self.events_at_contact.is_none() && self.leaves_old {
            self.log.begin_at(status.events);
        }
        self.events_at_contact.get_or_insert(status.events);
        self.log.note_logged(status.events);
        self.exchange
            .hear_armed_bit(now, status.bits.contains(StatusBits::ARMED));
    }

    fn hear_restart(&mut self, now: Instant) {
        self.restarts += 1;
        self.logged = None;
        self.events_at_contact = Some(0);
        self.identify_due = now;
        self.exchange.hear_restart();
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
        self.exchange.push(request)
    }

    /// Falls silent, dropping what was under way, or speaks again.
    pub fn set_silent(&mut self, now: Instant, silent: bool) {
        if silent && !self.silent {
            self.exchange.replace([]);
        }
        if self.silent && !silent {
            self.speaks_since = now;
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
        match self.exchange.failure() {
            Some(refusal) => Err(refusal.clone()),
            None => Ok(self.exchange.idle()),
        }
    }

    /// The bench goes on to something else: what failed before is told.
    pub fn forget_failure(&mut self) {
        self.exchange.forget_failure();
    }

    /// Listening, not armed, nothing under way.
    pub fn safe(&self) -> bool {
        !self.silent && !self.exchange.armed() && self.exchange.idle()
    }

    /// Since when it speaks; `None` while it is silent.
    pub fn speaks_since(&self) -> Option<Instant> {
        (!self.silent).then_some(self.speaks_since)
    }

    /// Its session number.
    pub fn session(&self) -> u32 {
        self.session
    }

    /// Who the unit is, once it has said so.
    pub fn identity(&self) -> Option<&Identity> {
        self.identity.as_ref()
    }

    /// Entries the unit's log had when it was first heard.
    pub fn events_at_contact(&self) -> Option<u32> {
        self.events_at_contact
    }

    /// What the unit logged before it was first heard is not read.
    pub fn leave_log_before_contact(&mut self) {
        self.leaves_old = true;
    }

    /// Times the unit was started again.
    pub fn restarts(&self) -> u32 {
        self.restarts
    }

    /// Log entries not yet taken.
    pub fn take_events(&mut self) -> Vec<UnitEvent> {
        self.log.take()
    }

    /// The log as read so far.
    pub fn log(&self) -> &LogReader {
        &self.log
    }
}
