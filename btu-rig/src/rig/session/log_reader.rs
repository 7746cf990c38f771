//! Reads the unit's event log: each entry once, in order, whatever frames are lost on the way.
//!
//! A unit may also be broken, or no unit at all: it may not answer, answer with anything but what was
//! asked for, or log without end. Each of these ends in an error that says so. What is kept of a log is
//! bounded by what a unit can hold and by the pace at which one may send it; the rest is counted.

use std::collections::VecDeque;

use protocol::event::LOG_ENTRIES;
use protocol::link::Link;
use protocol::message::{LogEnd, LogEntry, ReadLog};
use protocol::{Duration, Instant};

use crate::procedure::link_trouble::LinkTrouble;
use crate::procedure::{LogState, UnitEvent};

/// Entries kept until they are taken; reading pauses beyond, and the unit keeps the rest.
pub const MAX_EVENTS: usize = 512;
/// Times an entry may be lost on a bad line before it counts as gone in the unit.
const PROBES: u32 = 4;
/// Silence after which the log is asked for again.
const TIMEOUT: Duration = Duration::from_ms(300);
/// Silence after which the log counts as not answered so far: two questions are unanswered.
const IN_VAIN: Duration = Duration::from_us(2 * TIMEOUT.as_us());
/// Silence after which no answer is expected any more.
const NO_ANSWER: Duration = Duration::from_ms(5_000);
/// Longest time for the next entry to come while other entries come: longer than a whole log takes that has to be
/// waited out, at half the pace at which a unit sends.
const NO_ENTRY: Duration = Duration::from_ms(30_000);
/// Entries a unit sends in a second, two in a cycle, as the budget of the wire has it.
const ENTRIES_PER_S: u64 = 40;

/// Number of entries that may still be kept: as many as a unit can hold, and then as many as it can have sent since.
#[derive(Debug)]
struct LogBudget {
    left: u64,
    filled: Instant,
}

impl LogBudget {
    /// One entry more, if it may be kept.
    fn take(&mut self, now: Instant) -> bool {
        let more = now.since(self.filled).as_us() * ENTRIES_PER_S / 1_000_000;
        self.left = (self.left + more).min(LOG_ENTRIES as u64);
        self.filled += Duration::from_us(more * 1_000_000 / ENTRIES_PER_S);
        let may = self.left > 0;
        self.left -= u64::from(may);
        may
    }
}

impl Default for LogBudget {
    fn default() -> Self {
        Self {
            left: LOG_ENTRIES as u64,
            filled: Instant::ZERO,
        }
    }
}

#[derive(Debug, Default)]
pub struct LogReader {
    /// Index of the next entry to take.
    next: u32,
    /// Entries the unit says it has logged.
    logged: u32,
    /// When the last question was sent or its answer went on; `None` = nothing is asked for.
    asked: Option<Instant>,
    /// Index at which an entry was missed and asked for again.
    gap_at: Option<u32>,
    /// The entry was missed again: the reader asks only where the log begins.
    probing: bool,
    /// Times the missed entry was asked for since.
    probes: u32,
    /// Since when the next entry is wanted; `None` = none is, or there is no room for it.
    wanted_since: Option<Instant>,
    /// The unit has said how much it has logged.
    contact: bool,
    /// When the unit last sent anything of its log; `None` = nothing yet proves that the unit sends its log.
    heard: Option<Instant>,
    /// Questions to the unit since the next entry is wanted.
    asked_times: u32,
    events: VecDeque<UnitEvent>,
    /// Entries the unit had overwritten or cleared before they could be read.
    pub overwritten: u64,
    allowance: LogBudget,
    /// Entries that were read and not kept.
    pub not_kept: u64,
}

impl LogReader {
    /// Starts over, as after a restart of the unit.
    pub fn restart(&mut self) {
        *self = Self {
            events: std::mem::take(&mut self.events),
            overwritten: self.overwritten,
            allowance: std::mem::take(&mut self.allowance),
            not_kept: self.not_kept,
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
        self.contact = true;
    }

    /// Nothing was asked for a while: what has not come by now is not overdue.
    pub fn pause(&mut self) {
        self.wanted_since = None;
        self.asked_times = 0;
    }

    pub fn step(&mut self, now: Instant, link: &mut Link, out: &mut Vec<u8>) {
        if !self.wants_answer() || self.events.len() >= MAX_EVENTS {
            self.pause();
            return;
        }
        self.wanted_since.get_or_insert(now);
        if self.asked.is_some_and(|asked| now.since(asked) < TIMEOUT) {
            return;
        }
        link.send(
            now,
            &ReadLog {
                from_index: self.next,
            }
            .into(),
            out,
        );
        self.asked = Some(now);
        self.asked_times += 1;
        self.probes += u32::from(self.probing);
    }

    pub fn on_entry(&mut self, now: Instant, entry: &LogEntry) {
        self.heard = Some(now);
        if entry.index > self.next && !self.probing {
            // Lost on the wire, or overwritten in the unit: asking again tells which.
            self.probing = self.gap_at.replace(self.next) == Some(self.next);
            self.asked = None;
        }
        if self.probes > PROBES {
            // The line is not at fault: the reader waits for the rest of the answer, which the unit would begin again if asked
            // again.
            self.asked = self.asked.map(|_| now);
        }
        if entry.index == self.next && self.events.len() < MAX_EVENTS {
            self.next = self.next.saturating_add(1);
            self.probes = 0;
            self.pause();
            self.asked = self.asked.map(|_| now);
            if self.allowance.take(now) {
                self.events.push_back(UnitEvent::of_log(entry));
            } else {
                self.not_kept += 1;
            }
        }
    }

    /// Takes the end of an answer.
    pub fn on_end(&mut self, now: Instant, end: &LogEnd) {
        self.heard = Some(now);
        self.asked = None;
        self.probing = false;
        self.probes = 0;
        self.logged = self.logged.max(end.next_index);
        if end.oldest_index > self.next {
            self.overwritten += u64::from(end.oldest_index - self.next);
            self.next = end.oldest_index;
            self.pause();
        }
    }

    /// Entries not yet taken, in order.
    pub fn take(&mut self) -> Vec<UnitEvent> {
        self.events.drain(..).collect()
    }

    /// Index of the next entry to take.
    pub fn next_index(&self) -> u32 {
        self.next
    }

    /// Something is to be asked for: new entries, or once whether the log is answered at all.
    fn wants_answer(&self) -> bool {
        !self.up_to_date() || (self.contact && self.heard.is_none())
    }

    /// Everything the unit says it has logged is read.
    pub fn up_to_date(&self) -> bool {
        self.next >= self.logged
    }

    /// How far the log is read.
    pub fn state(&self, now: Instant) -> LogState {
        if !self.wants_answer() {
            LogState::Read
        } else if self.silence(now) >= IN_VAIN {
            LogState::Unanswered
        } else {
            LogState::Behind
        }
    }

    /// Why the log cannot be read, if it cannot.
    pub fn error(&self, now: Instant) -> Option<LinkTrouble> {
        let times = self.asked_times;
        let waited = self.wanted_since.map_or(Duration::ZERO, |at| now.since(at));
        if self.not_kept >= LOG_ENTRIES as u64 {
            return Some(LinkTrouble::LogWithoutEnd {
                entries: self.not_kept,
            });
        }
        if self.silence(now) >= NO_ANSWER {
            return Some(LinkTrouble::LogNotAnswered { times });
        }
        (waited >= NO_ENTRY).then_some(LinkTrouble::EntryNeverCame {
            times,
            entry: self.next,
            of: self.logged,
        })
    }

    /// Time for which an entry is wanted and nothing of the log comes.
    fn silence(&self, now: Instant) -> Duration {
        let since = self.wanted_since.max(self.heard);
        let since = since.filter(|_| self.wanted_since.is_some());
        since.map_or(Duration::ZERO, |at| now.since(at))
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
    /// sends an entry every 50 ms and begins from the start when it is asked again.
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
                    reader.on_end(
                        now,
                        &LogEnd {
                            next_index: 256,
                            oldest_index: 56,
                        },
                    );
                }
                Some(index) => {
                    under_way = Some(index + 1);
                    reader.on_entry(now, &entry(index));
                }
                None => {}
            }
            taken.extend(indices(&mut reader));
        }
        assert_eq!(taken, (56..256).collect::<Vec<_>>());
        assert_eq!(reader.overwritten, 56);
    }

    fn indices(reader: &mut LogReader) -> Vec<u32> {
        reader.take().iter().map(|e| e.index).collect()
    }

    #[test]
    fn doubles_and_gaps_do_not_disturb_the_order() {
        let mut reader = LogReader::default();
        reader.note_logged(4);
        for index in [0, 0, 1, 3, 2, 1, 3] {
            reader.on_entry(Instant::ZERO, &entry(index));
        }
        assert_eq!(indices(&mut reader), [0, 1, 2, 3]);
        assert!(reader.up_to_date());
    }

    #[test]
    fn overwritten_entries_are_skipped_and_counted() {
        let mut reader = LogReader::default();
        reader.note_logged(12);
        reader.on_entry(Instant::ZERO, &entry(10));
        reader.on_end(
            Instant::ZERO,
            &LogEnd {
                next_index: 12,
                oldest_index: 10,
            },
        );
        for index in [10, 11] {
            reader.on_entry(Instant::ZERO, &entry(index));
        }
        assert_eq!(indices(&mut reader), [10, 11]);
        assert_eq!(reader.overwritten, 10);
    }
}
