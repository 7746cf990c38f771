//! Reads one of the unit's two stores: each entry once, in order, whatever frames are lost on the way.
//!
//! First only the end of the store is asked for: a unit without stored memory does not answer, any other unit says how
//! much is stored. An entry whose number is missing five times is damaged in the unit; one that is missing less often
//! was lost on the line.

use protocol::link::Link;
use protocol::message::{
    Message, ReadStored, StoreKind, StoredClock, StoredEnd, StoredEntry, StoredRow,
};
use protocol::{Duration, Instant};

use crate::procedure::link_trouble::LinkTrouble;

/// Silence after which the store is asked for again.
const TIMEOUT: Duration = Duration::from_ms(400);
/// Questions without an answer after which the unit counts as one without stored memory.
const PROBES: u32 = 3;
/// Times that a number must be missing before its entry counts as damaged, and not as lost on a bad line.
const MISSING: u32 = 5;
/// Silence after which no answer is expected any more.
const NO_ANSWER: Duration = Duration::from_ms(5_000);
/// More entries than any unit can hold.
const MOST: u32 = 200_000;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct StoredData {
    /// Events, in order.
    pub entries: Vec<StoredEntry>,
    /// Times that testers sent, in order.
    pub clocks: Vec<StoredClock>,
    /// Rows of the run record, in order.
    pub rows: Vec<StoredRow>,
    /// Numbers whose entries are damaged.
    pub damaged: u64,
    /// Numbers that were overwritten while they were read.
    pub overwritten: u64,
    /// Present power-up; 0 while it is not known.
    pub power_up: u32,
    /// The unit says that its memory failed.
    pub failed: bool,
}

/// How far a store is read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StoreState {
    /// Whether the unit has a store is not known yet.
    Unknown,
    /// The unit has no store: it is an older one.
    Missing,
    Reading,
    /// Everything is read that the store held when it was first asked for.
    Read,
    /// The reason for which the store cannot be read.
    Failed(LinkTrouble),
}

/// Number of a missing entry (`at`), number that came in its place, and how often that happened.
#[derive(Clone, Copy, Debug)]
struct Gap {
    at: u32,
    came: u32,
    times: u32,
}

#[derive(Debug)]
pub struct StoreReader {
    store: StoreKind,
    per_cycle: u8,
    pub state: StoreState,
    /// Number of the next entry to take; `until` is the first number not wanted.
    next: u32,
    until: u32,
    /// When the last question was sent or its answer went on; `None` = nothing is asked for.
    asked: Option<Instant>,
    asked_times: u32,
    heard: Instant,
    gap: Option<Gap>,
    pub data: StoredData,
}

impl StoreReader {
    /// Reads a store, `per_cycle` entries in each 50 ms.
    pub fn new(store: StoreKind, per_cycle: u8) -> Self {
        Self {
            store,
            per_cycle,
            state: StoreState::Unknown,
            next: 0,
            until: 0,
            asked: None,
            asked_times: 0,
            heard: Instant::ZERO,
            gap: None,
            data: StoredData::default(),
        }
    }

    /// Asks for what is due.
    pub fn step(&mut self, now: Instant, link: &mut Link, out: &mut Vec<u8>) {
        let from_sequence = match self.state {
            StoreState::Unknown => u32::MAX,
            StoreState::Reading => self.next,
            _ => return,
        };
        if self.asked_times == 0 {
            self.heard = now;
        }
        if self.asked.is_some_and(|asked| now.since(asked) < TIMEOUT) {
            return;
        }
        if self.state == StoreState::Unknown && self.asked_times >= PROBES {
            self.state = StoreState::Missing;
            return;
        }
        if now.since(self.heard) >= NO_ANSWER {
            self.state = StoreState::Failed(LinkTrouble::MemoryNotAnswered);
            return;
        }
        let request = ReadStored {
            store: self.store,
            from_sequence,
            per_cycle: self.per_cycle,
        };
        link.send(now, &request.into(), out);
        self.asked = Some(now);
        self.asked_times += 1;
    }

    /// Takes a message of the unit.
    pub fn receive(&mut self, now: Instant, message: &Message) {
        let sequence = match (message, self.store) {
            (Message::StoredEnd(end), _) if end.store == self.store => {
                return self.on_end(now, end);
            }
            (Message::StoredEntry(entry), StoreKind::Events) => entry.sequence,
            (Message::StoredClock(clock), StoreKind::Events) => clock.sequence,
            (Message::StoredRow(row), StoreKind::Runs) => row.sequence,
            _ => return,
        };
        if self.state != StoreState::Reading {
            return;
        }
        self.heard = now;
        self.asked = self.asked.map(|_| now);
        if self.may_take(sequence) {
            match *message {
                Message::StoredEntry(entry) => self.data.entries.push(entry),
                Message::StoredClock(clock) => self.data.clocks.push(clock),
                Message::StoredRow(row) => self.data.rows.push(row),
                _ => {}
            }
            self.next = sequence + 1;
            self.settle();
        }
    }

    /// Whether an entry is the next one, perhaps after damaged ones.
    fn may_take(&mut self, sequence: u32) -> bool {
        if sequence < self.next || (sequence > self.next && !self.is_damaged_up_to(sequence)) {
            return false;
        }
        self.gap = None;
        if sequence >= self.until {
            self.next = self.until;
            self.settle();
            return false;
        }
        true
    }

    /// Whether the entries from the next one up to `came` were missing often enough to count as damaged; if not, they
    /// are asked for again.
    fn is_damaged_up_to(&mut self, came: u32) -> bool {
        let times = match self.gap {
            // Later numbers belong to the answer before.
            Some(gap) if gap.at == self.next && came > gap.came => return false,
            Some(gap) if gap.at == self.next => gap.times + 1,
            _ => 1,
        };
        if times >= MISSING {
            self.data.damaged += u64::from(came.min(self.until) - self.next);
            return true;
        }
        self.gap = Some(Gap {
            at: self.next,
            came,
            times,
        });
        self.asked = None;
        false
    }

    fn on_end(&mut self, now: Instant, end: &StoredEnd) {
        self.heard = now;
        self.asked = None;
        self.data.power_up = end.power_up;
        self.data.failed = end.works == 0;
        if self.state == StoreState::Unknown {
            let held = end.next_sequence.saturating_sub(end.oldest_sequence);
            if held > MOST {
                self.state = StoreState::Failed(LinkTrouble::MemoryTooLarge { entries: held });
                return;
            }
            self.state = StoreState::Reading;
            self.next = end.oldest_sequence;
            self.until = end.next_sequence;
        } else if self.state == StoreState::Reading {
            if end.next_sequence < self.until {
                self.state = StoreState::Failed(LinkTrouble::MemoryExchanged);
                return;
            }
            if end.oldest_sequence > self.next {
                self.data.overwritten += u64::from(end.oldest_sequence - self.next);
                self.next = end.oldest_sequence.min(self.until);
                self.gap = None;
            } else if self.next < self.until && self.is_damaged_up_to(u32::MAX) {
                self.next = self.until;
            }
        }
        self.settle();
    }

    fn settle(&mut self) {
        if self.state == StoreState::Reading && self.next >= self.until {
            self.state = StoreState::Read;
        }
    }

    /// Entries that are still to come.
    pub fn left(&self) -> u32 {
        self.until.saturating_sub(self.next)
    }
}

#[cfg(test)]
mod tests {
    use protocol::link::End;

    use super::*;

    /// Reads a store with the numbers up to `next`, of which only `whole` are undamaged; one frame in `lost` is lost.
    fn read(whole: &[u32], oldest: u32, next: u32, lost: u32) -> StoreReader {
        let mut reader = StoreReader::new(StoreKind::Events, 3);
        let (mut tester, mut unit) = (Link::new(End::Bench), Link::new(End::Unit));
        let mut under_way = None;
        let mut frames = 0;
        let end = StoredEnd {
            store: StoreKind::Events,
            next_sequence: next,
            oldest_sequence: oldest,
            power_up: 4,
            works: 1,
        };
        for now in (0..60_000).step_by(50).map(Instant::from_ms) {
            let mut out = Vec::new();
            reader.step(now, &mut tester, &mut out);
            unit.push(&out);
            while let Some(received) = unit.poll(now) {
                if let Message::ReadStored(asked) = received.message {
                    under_way = Some(asked.from_sequence);
                }
            }
            let Some(from) = under_way else { continue };
            let wanted: Vec<_> = whole.iter().copied().filter(|s| *s >= from).collect();
            let mut answer: Vec<Message> = Vec::new();
            for sequence in wanted.iter().take(3) {
                under_way = Some(sequence + 1);
                answer.push(
                    StoredEntry {
                        sequence: *sequence,
                        ..StoredEntry::default()
                    }
                    .into(),
                );
            }
            if wanted.len() <= 3 {
                under_way = None;
                answer.push(end.into());
            }
            for message in answer {
                frames += 1;
                // Lost frames are scattered: in step with the answers it would always be the same entry.
                let drawn = u32::wrapping_mul(frames, 2_654_435_761) >> 16;
                if lost == 0 || drawn % lost != 0 {
                    reader.receive(now, &message);
                }
            }
        }
        reader
    }

    fn numbers(reader: &StoreReader) -> Vec<u32> {
        reader
            .data
            .entries
            .iter()
            .map(|entry| entry.sequence)
            .collect()
    }

    #[test]
    fn entries_lost_on_the_line_are_read_again_and_damaged_ones_are_counted() {
        let all: Vec<u32> = (40..160).collect();
        let whole: Vec<u32> = all
            .iter()
            .copied()
            .filter(|s| !(70..75).contains(s) && *s != 159)
            .collect();
        for lost in [0, 4, 7, 50] {
            let reader = read(&all, 40, 160, lost);
            assert_eq!(numbers(&reader), all, "{lost}");
            assert_eq!(
                (&reader.state, reader.data.damaged),
                (&StoreState::Read, 0),
                "{lost}"
            );
        }
        let reader = read(&whole, 40, 160, 0);
        assert_eq!(numbers(&reader), whole);
        assert_eq!((&reader.state, reader.data.damaged), (&StoreState::Read, 6));
    }

    #[test]
    fn a_store_that_is_empty_or_all_damaged_is_read_to_its_end() {
        assert_eq!(&read(&[], 0, 0, 0).state, &StoreState::Read);
        let reader = read(&[], 10, 30, 0);
        assert_eq!(
            (&reader.state, reader.data.damaged),
            (&StoreState::Read, 20)
        );
    }

    #[test]
    fn a_unit_that_does_not_know_the_question_has_no_store() {
        let mut reader = StoreReader::new(StoreKind::Events, 3);
        let mut link = Link::new(End::Bench);
        for now in (0..3_000).step_by(10).map(Instant::from_ms) {
            reader.step(now, &mut link, &mut Vec::new());
        }
        assert_eq!(&reader.state, &StoreState::Missing);
    }

    #[test]
    fn a_store_that_cannot_be_is_refused() {
        let absurd = read(&[], 0, u32::MAX, 0);
        assert_eq!(
            absurd.state,
            StoreState::Failed(LinkTrouble::MemoryTooLarge { entries: u32::MAX })
        );
    }
}
