//! The event log: a bounded ring whose indices are never reused, each entry with a freeze frame.

use protocol::Instant;
use protocol::event::Event;
use protocol::message::LogEntry;

use super::Ring;

/// Entries kept; older ones fall off and their indices stay used.
pub const LOG_CAPACITY: usize = protocol::event::LOG_ENTRIES;

/// A value in hundredths of its unit, as events and messages carry it.
pub fn hundredths(value: f64) -> i32 {
    libm::round(value * 100.0) as i32
}

/// A share in hundredths of a percent, as events carry it.
pub fn hundredths_of_percent(share: f64) -> i32 {
    libm::round(share * 1e4) as i32
}

#[derive(Debug, Default)]
pub struct EventLog {
    entries: Ring<LogEntry, LOG_CAPACITY>,
    /// State of the unit that each entry freezes.
    frame: LogEntry,
    /// Events that were logged from this index on are not logged again.
    once_since: Option<u32>,
}

impl EventLog {
    /// Sets the state the next entries freeze; index, event and time of each are its own.
    pub fn freeze(&mut self, frame: LogEntry) {
        self.frame = frame;
    }

    /// From here on leaves out events logged since index `since` with the same parameter; `None` = nothing is left out.
    /// What two instances of a function see alike is one event.
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
            speed_cms: self.frame.speed_cms,
            limit_cms: self.frame.limit_cms,
            position_cm: self.frame.position_cm,
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
