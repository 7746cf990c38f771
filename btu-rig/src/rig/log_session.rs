//! A tester that only listens: it reads the unit's identity and log. It gives no input, arms nothing and
//! sends no stimulus, so a unit in a train is left as it was.

use protocol::link::{End, Link};
use protocol::message::{Identity, Message, StatusBits};
use protocol::{Duration, Instant};

use super::link_watch::LinkWatch;
use super::tester::Tester;
use crate::procedure::UnitEvent;

/// Session number, for arming only: never said.
const SESSION: u32 = 1;

/// Silence before the first question: a unit refuses who speaks while it may still hear a predecessor,
/// and would log that.
const HOLD_BACK: Duration = Duration::from_ms(1_100);

/// The tester, on a link of its own.
#[derive(Debug)]
pub struct LogSession {
    link: Link,
    tester: Tester,
    watch: LinkWatch,
    status: Option<StatusBits>,
    begun: Option<Instant>,
    /// When the unit told its uptime, and what it was, ms.
    identified_at: Option<(Instant, u32)>,
}

impl Default for LogSession {
    fn default() -> Self {
        Self {
            link: Link::new(End::Bench),
            tester: Tester::new(SESSION),
            watch: LinkWatch::default(),
            status: None,
            begun: None,
            identified_at: None,
        }
    }
}

impl LogSession {
    /// Asks for what is due.
    pub fn step(&mut self, now: Instant, out: &mut Vec<u8>) {
        self.watch.step(now);
        let begun = *self.begun.get_or_insert(now);
        if now.since(begun) >= HOLD_BACK {
            self.tester.step(now, &mut self.link, out);
        }
    }

    /// Takes bytes from the unit.
    pub fn receive(&mut self, now: Instant, bytes: &[u8]) {
        self.watch.note(bytes.len());
        self.link.push(bytes);
        while let Some(received) = self.link.poll(now) {
            self.watch
                .note_frame(received.header.channel, self.link.counters());
            match &received.message {
                Message::Identity(identity) => {
                    self.identified_at = Some((now, identity.uptime_ms));
                }
                Message::Status(status) => self.status = Some(status.bits),
                Message::Taken(taken) => self.watch.note_taken(*taken),
                _ => {}
            }
            self.tester.receive(now, &received.message);
        }
    }

    /// Who the unit is, once it has said so.
    pub fn identity(&self) -> Option<&Identity> {
        self.tester.identity()
    }

    /// When the unit last told its uptime, and what it was, ms.
    pub fn uptime_ms(&self) -> Option<(Instant, u32)> {
        self.identified_at
    }

    /// The unit's states as it last told them.
    pub fn status(&self) -> Option<StatusBits> {
        self.status
    }

    /// New entries of the unit's log, in order, each once.
    pub fn take_events(&mut self) -> Vec<UnitEvent> {
        self.tester.take_events()
    }

    /// Who the unit is and all it has logged is read.
    pub fn is_complete(&self) -> bool {
        self.identity().is_some()
            && self.tester.events_at_contact().is_some()
            && self.tester.log().up_to_date()
    }

    /// Entries the unit had overwritten or cleared before they could be read.
    pub fn overwritten(&self) -> u64 {
        self.tester.log().overwritten()
    }

    /// Times the unit was started again since it was first heard.
    pub fn restarts(&self) -> u32 {
        self.tester.restarts()
    }

    /// Why the unit turned this tester away, if it did: another has it.
    pub fn turned_away(&self) -> Option<String> {
        self.watch.turned_away()
    }

    /// Entries beyond what a log can hold: counted, and not among the events.
    pub fn not_kept(&self) -> u64 {
        self.tester.log().not_kept()
    }

    /// What is wrong with the connection, with who answers or with its log, after a time allowed for first
    /// contact.
    pub fn link_error(&self, now: Instant) -> Option<String> {
        let speaks_since = self.begun.map(|begun| begun + HOLD_BACK);
        let link = self.watch.error(now, &self.link, speaks_since);
        link.or_else(|| self.tester.error(now))
    }
}
