//! Reads the unit's event log: each entry once, in order, whatever frames are lost on the way.

use std::collections::VecDeque;

use protocol::link::Link;
use protocol::message::{LogEnd, LogEntry, ReadLog};
use protocol::{Duration, Instant, Speed};

use crate::procedure::{EventSource, UnitEvent};

/// Entries kept until they are taken; reading pauses beyond, and the unit keeps the rest.
pub const MAX_EVENTS: usize = 512;
/// Times an entry may be lost on a bad line before it counts as gone in the unit.
const PROBES: u32 = 4;
/// Silence after which reading is asked for again.
const TIMEOUT: Duration = Duration::from_ms(300);

/// The reader.
#[derive(Debug, Default)]
pub struct LogReader {
    /// Index of the next entry to take.
    next: u32,
    /// Entries the unit says it has logged.
    logged: u32,
    /// Last sign of the answer being under way; `None` = nothing asked.
    asked: Option<Instant>,
    /// Index at which an entry was missed and asked for again.
    gap_at: Option<u32>,
    /// It was missed again: ask only where the log begins.
    probing: bool,
    /// Times it was asked for since.
    probes: u32,
    events: VecDeque<UnitEvent>,
    overwritten: u64,
}

impl LogReader {
    /// Begins anew, as with a unit that was started again.
    pub fn restart(&mut self) {
        let events = std::mem::take(&mut self.events);
        *self = Self {
            events,
            overwritten: self.overwritten,
            ..Self::default()
        };
    }

    /// Entries before this index are not wanted.
    pub fn begin_at(&mut self, index: u32) {
        self.next = self.next.max(index);
    }

    /// Takes the count from the unit's status.
    pub fn note_logged(&mut self, events: u32) {
        self.logged = events;
    }

    /// Asks for what is new.
    pub fn step(&mut self, now: Instant, link: &mut Link, out: &mut Vec<u8>) {
        let wanting = self.next < self.logged && self.events.len() < MAX_EVENTS;
        let waiting = self.asked.is_some_and(|asked| now.since(asked) < TIMEOUT);
        if wanting && !waiting {
            link.send(
                now,
                &ReadLog {
                    from_index: self.next,
                }
                .into(),
                out,
            );
            self.asked = Some(now);
            self.probes += u32::from(self.probing);
        }
    }

    /// Takes an entry.
    pub fn hear_entry(&mut self, now: Instant, entry: &LogEntry) {
        if entry.index > self.next && !self.probing {
            // Lost on the wire, or overwritten in the unit: asking again tells which.
            self.probing = self.gap_at.replace(self.next) == Some(self.next);
            self.asked = None;
        }
        if self.probes > PROBES {
            // Not the line: the answer is waited out, asked again the unit would begin it anew.
            self.asked = self.asked.map(|_| now);
        }
        if entry.index == self.next && self.events.len() < MAX_EVENTS {
            self.next += 1;
            self.probes = 0;
            self.asked = self.asked.map(|_| now);
            self.events.push_back(unit_event(entry));
        }
    }

    /// Takes the end of an answer.
    pub fn hear_end(&mut self, end: &LogEnd) {
        self.asked = None;
        self.probing = false;
        self.probes = 0;
        self.logged = self.logged.max(end.next_index);
        if end.oldest_index > self.next {
            self.overwritten += u64::from(end.oldest_index - self.next);
            self.next = end.oldest_index;
        }
    }

    /// Entries not yet taken, in order.
    pub fn take(&mut self) -> Vec<UnitEvent> {
        self.events.drain(..).collect()
    }

    /// Everything the unit says it has logged is read.
    pub fn up_to_date(&self) -> bool {
        self.next >= self.logged
    }

    /// Entries the unit had overwritten or cleared before they could be read.
    pub fn overwritten(&self) -> u64 {
        self.overwritten
    }
}

fn unit_event(entry: &LogEntry) -> UnitEvent {
    UnitEvent {
        source: EventSource::Unit,
        index: entry.index,
        code: entry.code,
        at_ms: entry.at_ms,
        parameter: entry.parameter,
        speed: Speed::from_cms(entry.speed_cms),
        limit: Speed::from_cms(entry.limit_cms),
        position_m: f64::from(entry.position_cm) / 100.0,
        mode: entry.mode,
        eb_cause: entry.eb_cause,
    }
}

#[cfg(test)]
mod tests {
    use protocol::link::End;
    use protocol::message::Message;

    use super::*;

    fn entry(index: u32) -> LogEntry {
        LogEntry {
            index,
            ..LogEntry::default()
        }
    }

    /// Goal: a log that lost its beginning is read, however long the answer takes. Method: a unit that
    /// sends an entry every 50 ms and begins anew when it is asked again.
    #[test]
    fn a_long_log_that_lost_its_beginning_is_read_to_its_end() {
        let mut reader = LogReader::default();
        let (mut tester, mut unit) = (Link::new(End::Bench), Link::new(End::Unit));
        reader.note_logged(256);
        let mut under_way = None;
        let mut taken = Vec::new();
        for now in (0..60_000).step_by(50).map(Instant::from_ms) {
            let mut frames = Vec::new();
            reader.step(now, &mut tester, &mut frames);
            unit.push(&frames);
            while let Some(received) = unit.poll(now) {
                if let Message::ReadLog(asked) = received.message {
                    under_way = Some(asked.from_index.max(56));
                }
            }
            match under_way {
                Some(256) => {
                    under_way = None;
                    reader.hear_end(&LogEnd {
                        next_index: 256,
                        oldest_index: 56,
                    });
                }
                Some(index) => {
                    under_way = Some(index + 1);
                    reader.hear_entry(now, &entry(index));
                }
                None => {}
            }
            taken.extend(indices(&mut reader));
        }
        assert_eq!(taken, (56..256).collect::<Vec<_>>());
        assert_eq!(reader.overwritten(), 56);
    }

    fn indices(reader: &mut LogReader) -> Vec<u32> {
        reader.take().iter().map(|e| e.index).collect()
    }

    #[test]
    fn doubles_and_gaps_do_not_disturb_the_order() {
        let mut reader = LogReader::default();
        reader.note_logged(4);
        for index in [0, 0, 1, 3, 2, 1, 3] {
            reader.hear_entry(Instant::ZERO, &entry(index));
        }
        assert_eq!(indices(&mut reader), [0, 1, 2, 3]);
        assert!(reader.up_to_date());
    }

    #[test]
    fn overwritten_entries_are_skipped_and_counted() {
        let mut reader = LogReader::default();
        reader.note_logged(12);
        reader.hear_entry(Instant::ZERO, &entry(10));
        reader.hear_end(&LogEnd {
            next_index: 12,
            oldest_index: 10,
        });
        for index in [10, 11] {
            reader.hear_entry(Instant::ZERO, &entry(index));
        }
        assert_eq!(indices(&mut reader), [10, 11]);
        assert_eq!(reader.overwritten(), 10);
    }
}
