//! PTU channel: event log and run record since power-up.

use super::enums::{AtoState, EbCause, Mode};
use super::layout::layout;

layout! {
    /// Asks for the event log from an index on; answered by entries, then `LogEnd`.
    ReadLog, Ptu, 0x20 {
        /// First entry wanted.
        from_index: u32,
    }
}
layout! {
    /// Asks for the record of automatic runs from an index on; answered by rows, then `RunEnd`.
    ReadRun, Ptu, 0x22 {
        /// First row wanted.
        from_index: u32,
    }
}
layout! {
    /// Clears the event log; answered.
    ClearLog, Ptu, 0x21 {
        /// Session number.
        session: u32,
    }
}
layout! {
    /// One entry of the event log.
    LogEntry, Ptu, 0xA0 {
        /// Index since power-up, from 0; never reused.
        index: u32,
        /// Event code of the event dictionary.
        code: u16,
        /// Time since power-up, ms.
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
    /// End of the log as it stands.
    LogEnd, Ptu, 0xA1 {
        /// Index the next event will get.
        next_index: u32,
        /// Oldest index still kept.
        oldest_index: u32,
    }
}
layout! {
    /// One cycle of an automatic run as ATO recorded it [S0 §2, §3.1].
    RunRow, Ptu, 0xA2 {
        /// Index since power-up, from 0; never reused.
        index: u32,
        /// Run since power-up, from 1, wrapping.
        run: u16,
        /// Time since power-up, ms.
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
    /// End of the run record as it stands.
    RunEnd, Ptu, 0xA3 {
        /// Index the next row will get.
        next_index: u32,
        /// Oldest index still kept.
        oldest_index: u32,
    }
}
