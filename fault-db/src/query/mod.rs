//! Queries: lists, single rows with their details, statistics, and free SQL.

mod confirmed;
mod distinct_names;
mod fault_filter;
mod faults;
mod filter;
mod filter_names;
mod history;
mod life;
mod note_filter;
mod run_occurrences;
mod runs;
mod sql;
mod stats;
mod stays;
mod trace_read;
mod traces;
mod trend;

pub use confirmed::{ConfirmedCase, ConfirmedRepairs, RepairsOf, is_practice};
pub use fault_filter::FaultFilter;
pub use faults::{FaultDetail, FaultSummary, Occurrence};
pub use filter_names::code_number;
pub use history::{PartHistory, PartRepair, SAME_ENTRY_US};
pub use life::{Life, LifeEvent, LifeFault, LifeOf, LifeRun, LifeWhat, NamedFault};
pub use run_occurrences::RunOccurrence;
pub use runs::{RunDetail, RunFault, RunFilter, RunState, RunSummary};
pub use sql::{QueryBounds, QueryResult, SqlValue};
pub use stats::{FaultStat, StatKey, StatQuery};
pub use stays::Stay;
pub use trace_read::TraceHead;
pub use traces::TraceSummary;
pub use trend::{TrendDay, TrendLimits, TrendPoint, TrendQuery, TrendStep, TrendUnit};
