//! Stored memory of the unit over power-ups: its event log with the times that testers sent, and its run record.
//!
//! Both are kept in working memory first, in the rings of `kernel`; each scan stores what is new there, a few
//! entries at most, so that a scan's time stays bounded. An entry that is not stored when the power fails is lost.
//! Events and rows have a ring each: a long service does not push the events out.

use alloc::boxed::Box;
use alloc::vec::Vec;

use protocol::Instant;
use protocol::event::Event;
use protocol::message::{
    Channel, Layout, LogEntry, Message, RunRow, SetClock, StoreKind, StoredClock, StoredEnd,
    StoredEntry, StoredRow,
};

use super::ring::{CONTENT_BYTES, Stored};
use super::{BLOCKS, BlockDevice, FlashError, LogRing, RamFlash, Slot};
use crate::kernel::{EventLog, RunRecord};

/// Blocks of the event log, 6 400 entries; the others are of the run record, 19 300 rows: 16 min of driving.
const EVENT_BLOCKS: usize = 64;
/// Entries stored in a scan: 160 bytes, and the header of a block.
const PER_SCAN: usize = 4;
/// Greatest number of testers' times that are stored in a power-up: more would push the events out.
const CLOCKS: u8 = 32;
/// The years 2000 to 2100, both included, ms since 1970: a tester that sends another time has not set its own clock.
const UTC_MS: core::ops::Range<u64> = 946_684_800_000..4_133_980_800_000;
/// Most entries looked at in a cycle while damaged ones are passed over.
const LOOKED_AT: u32 = 512;

const _: () = {
    assert!(LogEntry::SPEC.payload_len() <= CONTENT_BYTES);
    assert!(RunRow::SPEC.payload_len() <= CONTENT_BYTES);
    assert!(StoredClock::SPEC.payload_len() <= CONTENT_BYTES);
};

/// The two rings on their device.
#[derive(Debug)]
pub struct Memory {
    device: Box<dyn BlockDevice>,
    /// `None`: the device failed.
    rings: Option<Rings>,
    power_up: u32,
    /// The time that the tester sent last.
    clock: Option<StoredClock>,
    clocks: u8,
    /// Index since power-up of the next event to store.
    next_event: u32,
    /// Index since power-up of the next row to store.
    next_row: u32,
}

#[derive(Debug)]
struct Rings {
    events: LogRing,
    rows: LogRing,
}

/// Reason for which a time is not stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetClockError {
    /// The time is impossible, or too many times were sent.
    OutOfRange,
    Failed,
}

impl Memory {
    /// Mounts a device at power-up.
    pub fn power_up(device: Box<dyn BlockDevice>) -> Self {
        let mount = || {
            Ok::<_, FlashError>(Rings {
                events: LogRing::mount(&*device, StoreKind::Events.code(), 0, EVENT_BLOCKS)?,
                rows: LogRing::mount(
                    &*device,
                    StoreKind::Runs.code(),
                    EVENT_BLOCKS,
                    BLOCKS - EVENT_BLOCKS,
                )?,
            })
        };
        let rings = mount().ok();
        let last = rings.as_ref().map_or(0, |rings| {
            rings.events.last_power_up.max(rings.rows.last_power_up)
        });
        Self {
            device,
            rings,
            power_up: last.saturating_add(1),
            clock: None,
            clocks: 0,
            next_event: 0,
            next_row: 0,
        }
    }

    /// The device, for the next power-up.
    pub fn take_device(&mut self) -> Box<dyn BlockDevice> {
        self.rings = None;
        core::mem::replace(&mut self.device, Box::new(RamFlash::default()))
    }

    /// Stores what is new, as much as a scan may; true if the device fails in doing so.
    pub fn step(&mut self, log: &EventLog, record: &RunRecord) -> bool {
        self.store_new(log, record).is_err() && self.rings.take().is_some()
    }

    fn store_new(&mut self, log: &EventLog, record: &RunRecord) -> Result<(), FlashError> {
        for _ in 0..PER_SCAN {
            if let Some(entry) = log.entries().at_or_after(self.next_event) {
                self.next_event = entry.index + 1;
                self.store_clock_in_new_block()?;
                self.store(StoreKind::Events, entry)?;
            } else if let Some(row) = record.rows.at_or_after(self.next_row) {
                self.next_row = row.index + 1;
                self.store(StoreKind::Runs, row)?;
            } else {
                break;
            }
        }
        Ok(())
    }

    fn store(&mut self, store: StoreKind, content: &impl Layout) -> Result<(), FlashError> {
        let rings = self.rings.as_mut().ok_or(FlashError)?;
        let ring = match store {
            StoreKind::Runs => &mut rings.rows,
            _ => &mut rings.events,
        };
        let mut bytes = Vec::with_capacity(CONTENT_BYTES);
        content.write(&mut bytes);
        ring.append(&mut *self.device, self.power_up, &bytes)?;
        Ok(())
    }

    /// Stores the time again in each block of events, because the block that has it may be erased.
    fn store_clock_in_new_block(&mut self) -> Result<(), FlashError> {
        let next = self
            .rings
            .as_ref()
            .filter(|rings| rings.events.at_block_begin());
        let next = next.map(|rings| rings.events.next());
        let (Some(sequence), Some(clock)) = (next, self.clock) else {
            return Ok(());
        };
        self.store(StoreKind::Events, &StoredClock { sequence, ..clock })
    }

    /// Stores the time that a tester tells.
    ///
    /// # Errors
    /// The time is out of range, too many were sent, or it could not be stored.
    pub fn set_clock(&mut self, now: Instant, told: SetClock) -> Result<(), SetClockError> {
        // Beyond that number a time is stored only if it is at most half as uncertain as the best: at most 17 more.
        let best = self.clock.map_or(u16::MAX, |clock| clock.uncertainty_ms);
        let is_too_many = self.clocks >= CLOCKS && told.uncertainty_ms >= best.div_ceil(2);
        if !UTC_MS.contains(&told.utc_ms) || is_too_many {
            return Err(SetClockError::OutOfRange);
        }
        let rings = self.rings.as_ref().ok_or(SetClockError::Failed)?;
        let clock = StoredClock {
            sequence: rings.events.next(),
            power_up: self.power_up,
            at_ms: now.stamp_ms(),
            utc_ms: told.utc_ms,
            uncertainty_ms: told.uncertainty_ms,
        };
        self.clocks = self.clocks.saturating_add(1);
        let stored = self.store(StoreKind::Events, &clock);
        // The best time is written again in each block; of equally good ones the last.
        if clock.uncertainty_ms <= best {
            self.clock = Some(clock);
        }
        stored.map_err(|_| SetClockError::Failed)
    }

    /// Entries of a store from `next` on, at most `count`, which moves `next`; true when these are the last.
    pub fn read(
        &self,
        store: StoreKind,
        next: &mut u32,
        count: usize,
        replies: &mut Vec<Message>,
    ) -> bool {
        let Some(ring) = self.ring(store) else {
            return true;
        };
        *next = (*next).max(ring.oldest());
        let full = replies.len() + count;
        for _ in 0..LOOKED_AT {
            if *next >= ring.next() {
                return true;
            }
            if replies.len() >= full {
                break;
            }
            if let Ok(Slot::Entry(stored)) = ring.read(&*self.device, *next) {
                replies.extend(message(&stored));
            }
            *next += 1;
        }
        false
    }

    /// The last stored one of these events, if it is among the entries that a cycle looks at.
    pub fn last_of(&self, events: &[Event]) -> Option<Event> {
        let ring = self.ring(StoreKind::Events)?;
        let oldest = ring.oldest().max(ring.next().saturating_sub(LOOKED_AT));
        (oldest..ring.next()).rev().find_map(|sequence| {
            let Ok(Slot::Entry(stored)) = ring.read(&*self.device, sequence) else {
                return None;
            };
            let Some(Message::StoredEntry(entry)) = message(&stored) else {
                return None;
            };
            Event::from_code(entry.code).filter(|event| events.contains(event))
        })
    }

    /// Where a store begins and ends.
    pub fn end(&self, store: StoreKind) -> StoredEnd {
        let ring = self.ring(store);
        StoredEnd {
            store,
            next_sequence: ring.map_or(0, |ring| ring.next()),
            oldest_sequence: ring.map_or(0, LogRing::oldest),
            power_up: self.power_up,
            works: u8::from(ring.is_some()),
        }
    }

    fn ring(&self, store: StoreKind) -> Option<&LogRing> {
        let rings = self.rings.as_ref()?;
        Some(match store {
            StoreKind::Runs => &rings.rows,
            _ => &rings.events,
        })
    }
}

/// A stored entry as it is sent; `None` for one of a kind that this version does not know.
fn message(stored: &Stored) -> Option<Message> {
    let (sequence, power_up) = (stored.sequence, stored.power_up);
    let kinds = [LogEntry::SPEC, RunRow::SPEC, StoredClock::SPEC];
    let kind = kinds.iter().find(|kind| kind.code == stored.content[0])?;
    let content = &stored.content[..kind.payload_len()];
    Some(match Message::decode(Channel::Ptu, content).ok()? {
        Message::LogEntry(entry) => StoredEntry {
            sequence,
            power_up,
            index: entry.index,
            code: entry.code,
            at_ms: entry.at_ms,
            parameter: entry.parameter,
            speed_cms: entry.speed_cms,
            limit_cms: entry.limit_cms,
            position_cm: entry.position_cm,
            mode: entry.mode,
            eb_cause: entry.eb_cause,
        }
        .into(),
        Message::RunRow(row) => StoredRow {
            sequence,
            power_up,
            index: row.index,
            run: row.run,
            at_ms: row.at_ms,
            position_cm: row.position_cm,
            speed_cms: row.speed_cms,
            target_cms: row.target_cms,
            effort: row.effort,
            marker: row.marker,
            ato_state: row.ato_state,
        }
        .into(),
        Message::StoredClock(clock) => StoredClock {
            sequence,
            power_up,
            ..clock
        }
        .into(),
        _ => return None,
    })
}

#[cfg(test)]
mod tests;
