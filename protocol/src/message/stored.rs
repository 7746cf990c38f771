//! PTU channel: event log and run record over all power-ups, and the clock that dates them.

use super::enums::{AtoState, EbCause, Mode, StoreKind};
use super::layout::layout;
use super::log::LogEntry;

layout! {
    /// Asks for what the unit has stored over power-ups, from a sequence number on; answered by `StoredEntry` and
    /// `StoredClock`, or by `StoredRow`, then `StoredEnd`.
    ReadStored, Ptu, 0x23 {
        /// Store to read from.
        store: StoreKind,
        /// First entry wanted; 4294967295 asks for the end alone.
        from_sequence: u32,
        /// Entries that the unit sends in each 50 ms, 1 to 4.
        per_cycle: u8,
    }
}
layout! {
    /// Tells the unit the time, which the unit stores with its own time; answered.
    SetClock, Ptu, 0x24 {
        /// Time since 1970 without leap seconds, UTC, ms; from the year 2000 to the year 2100.
        utc_ms: u64,
        /// Greatest error of the time, ms.
        uncertainty_ms: u16,
    }
}
layout! {
    /// One stored entry of the event log.
    StoredEntry, Ptu, 0xA4 {
        /// Sequence number in the store, over all power-ups; never reused.
        sequence: u32,
        /// Power-up that it was made in, from 1.
        power_up: u32,
        /// Index since that power-up, from 0.
        index: u32,
        /// Event code of the event dictionary.
        code: u16,
        /// Time since that power-up, ms.
        at_ms: u32,
        /// Event's parameter, its meaning given by the dictionary.
        parameter: i32,
        /// Freeze frame: measured speed, cm/s.
        speed_cms: u16,
        /// Freeze frame: speed limit, cm/s.
        limit_cms: u16,
        /// Freeze frame: position, cm.
        position_cm: i32,
        /// Freeze frame: operating mode.
        mode: Mode,
        /// Freeze frame: emergency brake's cause.
        eb_cause: EbCause,
    }
}
layout! {
    /// The time as a tester told it, among the stored entries of the event log.
    StoredClock, Ptu, 0xA5 {
        /// Sequence number in the store of events.
        sequence: u32,
        /// Power-up that it was told in, from 1.
        power_up: u32,
        /// Time since that power-up, ms.
        at_ms: u32,
        /// Time since 1970, UTC, ms.
        utc_ms: u64,
        /// Greatest error of the time, ms.
        uncertainty_ms: u16,
    }
}
layout! {
    /// One stored row of the run record.
    StoredRow, Ptu, 0xA6 {
        /// Sequence number in the store, over all power-ups; never reused.
        sequence: u32,
        /// Power-up that it was made in, from 1.
        power_up: u32,
        /// Index since that power-up, from 0.
        index: u32,
        /// Run since that power-up, from 1, wrapping.
        run: u16,
        /// Time since that power-up, ms.
        at_ms: u32,
        /// Position from the section's start, cm.
        position_cm: i32,
        /// Speed ATO goes by, wheel correction applied, cm/s.
        speed_cms: u16,
        /// Target speed, cm/s.
        target_cms: u16,
        /// Effort, -1024..1023.
        effort: i16,
        /// Marker detected since the last row, 1 to 4 = PSM1 to PSM4; 0 = none.
        marker: u8,
        /// Operating state of ATO.
        ato_state: AtoState,
    }
}
layout! {
    /// End of a store as it stands.
    StoredEnd, Ptu, 0xA7 {
        /// Store that was read.
        store: StoreKind,
        /// Sequence number that the next entry will get.
        next_sequence: u32,
        /// Sequence number of the oldest entry still kept.
        oldest_sequence: u32,
        /// Present power-up, from 1.
        power_up: u32,
        /// 1 = entries are stored; 0 = the memory failed, and nothing is.
        works: u8,
    }
}

impl StoredEntry {
    /// The entry as the log of its own power-up has it.
    pub const fn log_entry(&self) -> LogEntry {
        LogEntry {
            index: self.index,
            code: self.code,
            at_ms: self.at_ms,
            parameter: self.parameter,
            speed_cms: self.speed_cms,
            limit_cms: self.limit_cms,
            position_cm: self.position_cm,
            mode: self.mode,
            eb_cause: self.eb_cause,
        }
    }
}
