//! What a tester reads, a part in each cycle: the log, the run record, stored entries.

use alloc::vec::Vec;

use protocol::message::{LogEnd, Message, RunEnd};

use super::Maintenance;
use crate::flash::Memory;
use crate::kernel::{EventLog, Ring, RunRecord};

/// Log entries sent in one cycle, so that the cycle's byte budget holds.
const ENTRIES_PER_CYCLE: usize = 2;
/// Rows of the run record sent in a cycle without log entries, for the same reason.
const ROWS_PER_CYCLE: usize = 2;

impl Maintenance {
    /// Log entries to send in this cycle.
    pub fn read_log(&mut self, log: &EventLog, replies: &mut Vec<Message>) {
        let per_cycle = ENTRIES_PER_CYCLE;
        if send(
            &mut self.reader,
            log.entries(),
            per_cycle,
            |e| e.index,
            replies,
        ) {
            let end = LogEnd {
                next_index: log.next_index(),
                oldest_index: log.entries().oldest_index(),
            };
            replies.push(end.into());
        }
    }

    /// Rows of the run record to send in this cycle.
    pub fn read_run(&mut self, record: &RunRecord, replies: &mut Vec<Message>) {
        let (rows, per_cycle) = (&record.rows, ROWS_PER_CYCLE);
        if send(
            &mut self.run_reader,
            rows,
            per_cycle,
            |row| row.index,
            replies,
        ) {
            let end = RunEnd {
                next_index: rows.next_index(),
                oldest_index: rows.oldest_index(),
            };
            replies.push(end.into());
        }
    }

    /// Stored entries to send in this cycle.
    pub fn read_stored(&mut self, memory: &Memory, replies: &mut Vec<Message>) {
        let Some((store, next, per_cycle)) = &mut self.stored_reader else {
            return;
        };
        if memory.read(*store, next, *per_cycle, replies) {
            replies.push(memory.end(*store).into());
            self.stored_reader = None;
        }
    }
}

/// Sends entries that a reader has not had yet, at most `per_cycle`; true when the last one was
/// sent.
fn send<T: Copy + Into<Message>, const N: usize>(
    reader: &mut Option<u32>,
    ring: &Ring<T, N>,
    per_cycle: usize,
    index: fn(&T) -> u32,
    replies: &mut Vec<Message>,
) -> bool {
    let Some(next) = reader else {
        return false;
    };
    for _ in 0..per_cycle {
        let Some(entry) = ring.at_or_after(*next) else {
            break;
        };
        *next = index(entry) + 1;
        replies.push((*entry).into());
    }
    let ends = ring.at_or_after(*next).is_none();
    if ends {
        *reader = None;
    }
    ends
}
