//! Queries: lists, single rows with their details, statistics, and free SQL.

mod daily;
mod fault_filter;
mod faults;
mod filter;
mod history;
mod known;
mod note_filter;
mod runs;
mod signs;
mod sql;
mod stats;
mod trace_read;
mod traces;
mod trend;

pub use daily::DailyCount;
pub use fault_filter::{FaultFilter, code_number};
pub use faults::{FaultDetail, FaultEvent, FaultSummary, Occurrence};
pub use history::{LOG_SOURCE, PartHistory, PartRepair, SAME_ENTRY_US};
pub use runs::{RunDetail, RunFault, RunFilter, RunState, RunSummary};
pub use signs::RunOccurrence;
pub use sql::{QueryBounds, QueryResult, SqlValue};
pub use stats::{FaultStat, StatKey, StatQuery};
pub use trace_read::TraceHead;
pub use traces::TraceSummary;
pub use trend::{TrendDay, TrendLimits, TrendPoint, TrendQuery, TrendUnit};
