//! Runs, measurements, faults and traces of the maintenance test unit, in one SQLite file; of many
//! laptops, on a PostgreSQL server.
//!
//! Three layers, each knowing only those before it:
//!
//! 1. [`trace`]: equally spaced samples of named channels, packed column by column;
//! 2. [`Store`]: one open file or server — opening and its checks, the schema, what can go wrong;
//! 3. the verbs: [`RunWriter`] records a run as it happens, `query` reads, `fault_log` moves
//!    faults through their life, `care` checks, backs up, prunes and merges files, `sync` brings
//!    a file and a server together.
//!
//! No clock, no thread, no randomness and no file but the database: the caller gives times and an
//! [`IdSource`]. How files that people name are read ([`read_given`]) and replaced ([`Part`]) is here for all
//! programs. Connecting to a server is the exception: it reads the password file and certificates
//! that the address and the environment name, and gives up on a thread that takes too long.
//!
//! Names ending in `at_us` are microseconds since 1970 (UTC), `bench_us` is the bench's own clock,
//! `bench_time_us` and `wall_time_us` are lengths of time.

mod base;
mod care;
mod conflicts;
pub mod diagnosis;
mod dictionaries;
mod domain;
mod error;
mod fault_log;
mod fault_state;
mod file;
mod functions;
mod given;
mod guard;
mod id;
mod insert;
pub mod limits;
mod lookup;
mod packed;
mod part;
pub mod process;
mod query;
mod record;
mod recording;
mod run_notes;
mod run_writer;
mod schema;
mod seal;
mod seen_again;
mod server;
mod settle;
mod store;
mod sync;
mod text_enum;
mod together;
pub mod trace;
mod units;
mod verify;
mod views;
mod words;

pub use care::{CheckReport, CopyOf, MergeCounts, Problem, PruneCounts, PruneRule};
pub use conflicts::{RivalEvent, StateConflict};
pub use domain::{Refusals, Refused};
pub use error::StoreError;
pub use fault_state::{FaultAction, FaultState, TransitionError};
pub use given::{open_given, read_given};
pub use id::{Id, IdSource};
pub use part::Part;
pub use query::{
    DailyCount, FaultDetail, FaultEvent, FaultFilter, FaultStat, FaultSummary, LOG_SOURCE,
    Occurrence, PartHistory, PartRepair, QueryBounds, QueryLimit, QueryResult, RunDetail, RunFault,
    RunFilter, RunOccurrence, RunState, RunSummary, SAME_ENTRY_US, SqlValue, StatKey, StatQuery,
    StepDetail, TraceHead, TraceSummary, TrendDay, TrendLimits, TrendPoint, TrendQuery, TrendUnit,
    code_number,
};
pub use record::{
    FaultRecord, FreezeSample, MeasurementRecord, RepairRecord, RunEnd, RunRecord, ScriptRecord,
    StepRecord, UnitRecord, Verdict,
};
pub use recording::{Recording, RecordingRecord};
pub use run_notes::RunNote;
pub use run_writer::{FaultStored, RunWriter};
pub use schema::{APPLICATION_ID, SCHEMA_VERSION};
pub use seal::{RunSealed, SealHead};
pub use server::{Address, SERVER_SCHEMA_VERSION, ServerSetup};
pub use store::{OpenOptions, Store, Synchronous};
pub use sync::{Different, SyncOptions, SyncOutcome, SyncPhase, SyncProgress};
pub use text_enum::UnknownWord;
pub use trace::{Channel, ChannelKind, TraceData, TraceError};
pub use views::VIEWS_PAGE;
