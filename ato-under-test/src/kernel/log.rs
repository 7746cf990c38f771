//! The event log: a bounded ring whose indices are never reused, each entry with a freeze frame.

use protocol::event::Event;
use protocol::message::{EbCause, LogEntry, Mode};
use protocol::{Instant, Speed};

use super::Ring;

/// Entries kept; older ones fall off and their indices stay used.
pub const LOG_CAPACITY: usize = protocol::event::LOG_ENTRIES;

/// State of the unit that each entry freezes.
#[derive(Clone, Copy, Debug, Default)]
pub struct FreezeFrame {
    pub speed: Speed,
    /// Speed limit in force.
    pub limit: Speed,
    /// Position in the section, m.
    pub position_m: f64,
    pub mode: Mode,
    /// Emergency brake's cause.
    pub eb_cause: EbCause,
}

#[derive(Debug, Default)]
pub struct EventLog {
    entries: Ring<LogEntry, LOG_CAPACITY>,
    frame: FreezeFrame,
    /// Events that were logged from this index on are not logged again.
    once_since: Option<u32>,
}

impl EventLog {
    /// Sets the state the next entries freeze.
    pub fn freeze(&mut self, frame: FreezeFrame) {
        self.frame = frame;
    }

    /// From here on leaves out what was logged since index `since` with the same parameter; `None` = nothing is left
    /// out. Two instances of a function that see the same are one event.
    pub fn leave_out_repeats(&mut self, since: Option<u32>) {
        self.once_since = since;
    }

    pub fn push(&mut self, now: Instant, event: Event, parameter: i32) {
        if self.was_logged(event, parameter) {
            return;
        }
        self.entries.push(LogEntry {
            index: self.entries.next_index(),
            code: event.definition().code,
            at_ms: now.stamp_ms(),
            parameter,
            speed_cms: self.frame.speed.to_cms(),
            limit_cms: self.frame.limit.to_cms(),
            position_cm: libm::round(self.frame.position_m * 100.0) as i32,
            mode: self.frame.mode,
            eb_cause: self.frame.eb_cause,
        });
    }

    fn was_logged(&self, event: Event, parameter: i32) -> bool {
        let Some(since) = self.once_since else {
            return false;
        };
        let code = event.definition().code;
        (since..self.next_index())
            .filter_map(|index| self.entries.at_or_after(index))
            .any(|entry| entry.code == code && entry.parameter == parameter)
    }

    pub fn entries(&self) -> &Ring<LogEntry, LOG_CAPACITY> {
        &self.entries
    }

    /// Index the next event will get.
    pub fn next_index(&self) -> u32 {
        self.entries.next_index()
    }

    /// Forgets all entries; indices go on.
    pub fn clear(&mut self) {
        self.entries.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_entries_fall_off_and_indices_go_on() {
        let mut log = EventLog::default();
        for _ in 0..LOG_CAPACITY + 5 {
            log.push(Instant::ZERO, Event::PowerUp, 0);
        }
        assert_eq!(log.entries().oldest_index(), 5);
        assert_eq!(log.entries().at_or_after(0).unwrap().index, 5);
        assert_eq!(log.entries().at_or_after(7).unwrap().index, 7);
        log.clear();
        assert!(log.entries().at_or_after(0).is_none());
        assert_eq!(log.entries().oldest_index(), LOG_CAPACITY as u32 + 5);
    }
}
