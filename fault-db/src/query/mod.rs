//! The reading side: lists, single rows with all that belongs to them, counts, free questions.

mod daily;
mod faults;
mod filter;
mod history;
mod runs;
mod signs;
mod sql;
mod stats;
mod traces;

pub use daily::DailyCount;
pub use faults::{FaultDetail, FaultEvent, FaultFilter, FaultSummary, Occurrence};
pub use history::{LOG_SOURCE, PartHistory, PartRepair, SAME_ENTRY_US};
pub use runs::{RunDetail, RunFault, RunFilter, RunState, RunSummary, StepDetail};
pub use signs::RunOccurrence;
pub use sql::{QueryResult, SqlValue};
pub use stats::{FaultStat, StatKey, TrendPoint};
pub use traces::TraceSummary;
