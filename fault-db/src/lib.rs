//! Runs, measurements, faults and traces of the maintenance test unit, in one SQLite file.
//!
//! Three layers, each knowing only those before it:
//!
//! 1. [`trace`]: equally spaced samples of named channels, packed column by column;
//! 2. [`Store`]: one open file — opening and its checks, the schema, what can go wrong;
//! 3. the verbs: [`RunWriter`] records a run as it happens, `query` reads, `fault_log` moves
//!    faults through their life, `care` checks, backs up, prunes and merges files.
//!
//! No clock, no thread, no randomness and no file but the database: the caller gives times and an
//! [`IdSource`]. Names ending in `at_us` are microseconds since 1970 (UTC), `bench_us` is the
//! bench's own clock, `bench_time_us` and `wall_time_us` are lengths of time.

mod care;
pub mod diagnosis;
mod dictionaries;
mod error;
mod fault_log;
mod fault_state;
mod id;
mod insert;
mod lookup;
mod packed;
mod query;
mod record;
mod recording;
mod run_notes;
mod run_writer;
mod schema;
mod store;
mod text_enum;
pub mod trace;

pub use care::{CheckReport, MergeCounts, Problem, PruneCounts, PruneRule};
pub use error::StoreError;
pub use fault_state::{FaultAction, FaultState, TransitionError};
pub use id::{Id, IdSource};
pub use query::{
    DailyCount, FaultDetail, FaultEvent, FaultFilter, FaultStat, FaultSummary, LOG_SOURCE,
    Occurrence, PartHistory, PartRepair, QueryResult, RunDetail, RunFault, RunFilter,
    RunOccurrence, RunState, RunSummary, SAME_ENTRY_US, SqlValue, StatKey, StepDetail,
    TraceSummary, TrendPoint,
};
pub use record::{
    FaultRecord, FreezeSample, MeasurementRecord, RepairRecord, RunEnd, RunRecord, ScriptRecord,
    StepRecord, UnitRecord, Verdict,
};
pub use recording::{Recording, RecordingRecord};
pub use run_notes::RunNote;
pub use run_writer::{FaultStored, RunWriter};
pub use schema::{APPLICATION_ID, SCHEMA_VERSION};
pub use store::{OpenOptions, Store, Synchronous};
pub use text_enum::UnknownWord;
pub use trace::{Channel, ChannelKind, TraceData, TraceError};
