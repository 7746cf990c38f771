//! A tester that only listens: it reads the unit's identity, its log and what it has stored over power-ups. It
//! gives no input, arms nothing and sends no stimulus, so a unit in a train is left as it was; but it tells the unit
//! the time, if it knows the time.

use protocol::link::{End, Link};
use protocol::message::{Identity, Message, Mode, StatusBits, StoreKind};
use protocol::{Duration, Instant};

use super::store_reader::{StoreReader, StoreState, StoredData};
use super::tester::Tester;
use super::unit_clock::TimeOfDay;
use crate::procedure::UnitEvent;
use crate::procedure::link_trouble::LinkTrouble;
use crate::rig::link::LinkWatch;

/// Session number; it is sent for arming only, so never here.
const SESSION: u32 = 1;

/// Silence before the first question: while a unit may still hear the tester before this one, it refuses any other
/// tester, and would log the refusal.
const HOLD_BACK: Duration = Duration::from_ms(1_100);

/// Stored entries asked for in a cycle: with all else that a unit says without a harness, 35 % of 115 200 baud.
const PER_CYCLE: u8 = 3;

/// The tester, on a link of its own.
#[derive(Debug)]
pub struct LogSession {
    link: Link,
    tester: Tester,
    watch: LinkWatch,
    /// The unit's states as it last reported them.
    pub status: Option<StatusBits>,
    /// Operating mode as the unit last reported it.
    pub mode: Option<Mode>,
    begun: Option<Instant>,
    events: StoreReader,
    rows: Option<StoreReader>,
    /// When the unit reported its uptime, and what it was, ms.
    identified_at: Option<(Instant, u32)>,
}

impl LogSession {
    /// Reads the log; with `rows`, the stored run record, too.
    pub fn new(rows: bool) -> Self {
        let mut tester = Tester::new(SESSION);
        tester.holds_log = true;
        Self {
            link: Link::new(End::Bench),
            tester,
            watch: LinkWatch::default(),
            status: None,
            mode: None,
            begun: None,
            events: StoreReader::new(StoreKind::Events, PER_CYCLE),
            rows: rows.then(|| StoreReader::new(StoreKind::Runs, PER_CYCLE)),
            identified_at: None,
        }
    }

    /// Tells the unit the time.
    pub fn tell_time(&mut self, time: TimeOfDay) {
        self.tester.clock.tell(time);
    }

    /// Asks for what is due.
    pub fn step(&mut self, now: Instant, out: &mut Vec<u8>) {
        self.watch.step(now);
        let begun = *self.begun.get_or_insert(now);
        if now.since(begun) >= HOLD_BACK {
            self.tester.step(now, &mut self.link, out);
            self.step_stores(now, out);
        }
    }

    /// Reads the stores one after the other, once the unit has told its identity. A unit without stores is asked for
    /// its log.
    fn step_stores(&mut self, now: Instant, out: &mut Vec<u8>) {
        if self.status.is_none() || self.identity().is_none() {
            return;
        }
        self.events.step(now, &mut self.link, out);
        match &self.events.state {
            StoreState::Missing => self.tester.holds_log = false,
            // The time is stored before the events are read to their end.
            StoreState::Read => {
                if let Some(rows) = &mut self.rows {
                    rows.step(now, &mut self.link, out);
                }
            }
            _ => {}
        }
    }

    /// Decodes bytes that came from the unit, and hands each frame on.
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
                Message::Status(status) => {
                    self.status = Some(status.bits);
                    self.mode = Some(status.mode);
                }
                Message::Taken(taken) => self.watch.note_taken(*taken),
                _ => {}
            }
            self.tester.receive(now, &received.message);
            self.events.receive(now, &received.message);
            if let Some(rows) = &mut self.rows {
                rows.receive(now, &received.message);
            }
        }
    }

    /// Identity of the unit, once the unit has told it.
    pub fn identity(&self) -> Option<&Identity> {
        self.tester.identity.as_ref()
    }

    /// When the unit last reported its uptime, and what it was, ms.
    pub fn uptime_ms(&self) -> Option<(Instant, u32)> {
        self.identified_at
    }

    /// New entries of the unit's log, in order, each once.
    pub fn take_events(&mut self) -> Vec<UnitEvent> {
        self.tester.log.take()
    }

    /// Whether the identity and all that the unit has logged or stored is read.
    pub fn is_complete(&self) -> bool {
        let stored = |reader: &StoreReader| reader.state == StoreState::Read;
        let read = match &self.events.state {
            StoreState::Missing => self.tester.log.up_to_date(),
            _ => stored(&self.events) && self.rows.as_ref().is_none_or(stored),
        };
        self.identity().is_some()
            && self.tester.events_at_contact.is_some()
            && self.tester.clock.settled()
            && read
    }

    /// What the unit has stored, as far as it is read: events with the times it was given, and rows. `None` for a
    /// unit without stored memory.
    pub fn stored(&self) -> Option<(&StoredData, Option<&StoredData>)> {
        let rows = self.rows.as_ref().map(|rows| &rows.data);
        let known = !matches!(
            &self.events.state,
            StoreState::Unknown | StoreState::Missing
        );
        known.then_some((&self.events.data, rows))
    }

    /// Stored entries that are still to come.
    pub fn left(&self) -> u32 {
        self.events.left() + self.rows.as_ref().map_or(0, StoreReader::left)
    }

    /// Entries the unit had overwritten or cleared before they could be read.
    pub fn overwritten(&self) -> u64 {
        self.tester.log.overwritten
    }

    /// Times the unit was started again since it was first heard.
    pub fn restarts(&self) -> u32 {
        self.tester.restarts
    }

    /// Why the unit turned this tester away, if it did: another tester has the unit.
    pub fn turned_away(&self) -> Option<LinkTrouble> {
        self.watch.turned_away()
    }

    /// Entries beyond what a log can hold: counted, and not among the events.
    pub fn not_kept(&self) -> u64 {
        self.tester.log.not_kept
    }

    /// What is wrong with the connection, the unit that answers or its log, once the time allowed for first contact is
    /// over.
    pub fn link_error(&self, now: Instant) -> Option<LinkTrouble> {
        let speaks_since = self.begun.map(|begun| begun + HOLD_BACK);
        let link = self.watch.error(now, &self.link, speaks_since, false);
        let stores = [Some(&self.events), self.rows.as_ref()];
        let failed = stores
            .into_iter()
            .flatten()
            .find_map(|reader| match &reader.state {
                StoreState::Failed(why) => Some(why.clone()),
                _ => None,
            });
        link.or_else(|| self.tester.error(now)).or(failed)
    }
}
