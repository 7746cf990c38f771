//! A unit's own event log, read where the unit is, becomes faults in the history.
//!
//! ```text
//! unit → LogSession → read (entries, dated) → judge (which are the unit's) → store (what is new)
//! ```
//! The unit is listened to and asked for its log, over all power-ups if it stores it; it is sent the time, and given
//! no input and no stimulus, and nothing is armed.

mod date;
mod judge;
mod read;
mod reading;
mod store;

pub use date::{StoredClocks, StoredDate};
pub use judge::{ExcludedEntries, JudgedLog, judge};
pub use read::{Entry, LogRead, StoredPlace, StoredRead, read_log};
pub use reading::{AskedUnit, ImportedLog, UnitReading};
pub(crate) use store::run_record;
pub use store::{Imported, Source, against_history, import};
