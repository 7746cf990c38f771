//! Storage and analysis of the maintenance test unit's history: runs, measurements, faults and traces, in
//! one SQLite file, or of many laptops on a PostgreSQL server.
//!
//! Three layers, each of which uses only those before it:
//!
//! 1. [`trace`]: equally spaced samples of named channels, compressed column by column;
//! 2. [`Store`]: one open file or server, with its schema, its checks on opening and its errors;
//! 3. operations on a store: [`RunWriter`] records a run as it happens, `query` reads, `fault_log` changes
//!    the state of faults, `maintenance` checks, backs up and prunes files, `replication` brings the rows
//!    of one store into another.
//!
//! The crate reads no clock, starts no thread, draws no random number and opens no file but the database:
//! the caller gives times and an [`IdSource`]. Exceptions: [`read_regular_file`] and [`AtomicFile`] read and
//! replace files for the whole program; connecting to a server reads the password file and certificates
//! that the address and the environment name, on a thread that is abandoned after a time limit.
//!
//! Names ending in `at_us` are microseconds since 1970 (UTC); `bench_us` is time on the bench's own clock;
//! `bench_time_us` and `wall_time_us` are durations.

mod atomic_file;
mod backend;
mod cases;
mod compression;
mod conflicts;
mod dictionaries;
mod domain;
mod error;
mod event_graph;
mod fault_event;
mod fault_log;
mod fault_state;
mod file;
mod full_text;
mod id;
mod insert;
pub mod limits;
mod lookup;
mod maintenance;
mod open_options;
mod packed;
mod platform;
mod query;
mod record;
mod recording;
mod recurrence;
mod regular_file;
mod replication;
mod run_notes;
mod run_writer;
mod schema;
mod schema_guard;
mod seal;
mod server;
mod sql_functions;
mod statistics;
mod store;
mod text_enum;
pub mod trace;
mod trace_place;
mod transaction;
mod verify;
mod views;
mod withdrawal;

pub use atomic_file::AtomicFile;
pub use cases::ChangedFault;
pub use conflicts::{ConflictingEvent, StateConflict};
pub use dictionaries::DictionaryRecord;
pub use domain::{Refusals, Refused};
pub use error::{QueryLimit, StoreError};
pub use fault_state::{FaultAction, FaultState, TransitionError};
pub use id::{Id, IdSource};
pub use maintenance::{CheckReport, Problem, PruneCounts, PruneRule};
pub use open_options::{OpenOptions, Synchronous};
pub use query::{
    ConfirmedCase, ConfirmedRepairs, DailyCount, FaultDetail, FaultEvent, FaultFilter, FaultStat,
    FaultSummary, LOG_SOURCE, Life, LifeEvent, LifeFault, LifeOf, LifeRun, LifeWhat, NamedFault,
    Occurrence, PartHistory, PartRepair, QueryBounds, QueryResult, RepairsOf, RunDetail, RunFault,
    RunFilter, RunOccurrence, RunState, RunSummary, SAME_ENTRY_US, SqlValue, StatKey, StatQuery,
    Stay, TraceHead, TraceSummary, TrendDay, TrendLimits, TrendPoint, TrendQuery, TrendStep,
    TrendUnit, code_number, is_practice,
};
pub use record::{
    CauseRecord, FaultRecord, FreezeSample, MeasurementRecord, RepairRecord, RunEnd, RunRecord,
    ScriptRecord, StepRecord, UnitRecord, Verdict,
};
pub use recording::{Recording, RecordingRecord};
pub use regular_file::{open_regular_file, read_regular_file};
pub use replication::{
    CopyOf, Difference, LastSync, MergeCounts, SyncOptions, SyncOutcome, SyncPhase, SyncProgress,
};
pub use run_notes::RunNote;
pub use run_writer::{FaultStored, RunWriter};
pub use schema::{APPLICATION_ID, SCHEMA_VERSION};
pub use seal::{RunSealed, SealHead};
pub use server::{Address, Claim, MOST_TRIES, Queue, SERVER_SCHEMA_VERSION, ServerSetup};
pub use store::Store;
pub use text_enum::UnknownWord;
pub use trace::{Channel, ChannelKind, TraceData, TraceError};
pub use trace_place::TracePlace;
pub use verify::{RepairToProve, SettledFault};
pub use views::VIEWS_PAGE;
pub use withdrawal::{Correction, ToWithdraw, WithdrawalError, Withdrawn};
