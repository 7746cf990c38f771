//! Storage and analysis of the maintenance test unit's history: runs, measurements, faults and traces, in
//! one SQLite file, or of many laptops on a PostgreSQL server.
//!
//! Each folder uses only those before it:
//!
//! 1. `files`, `backend` (SQLite and PostgreSQL), `values` (what is recorded), [`trace`] (samples of named channels,
//!    compressed column by column), `error` (errors, and what a check finds);
//! 2. `schema` (tables of a file, SQL functions), `seal` (the chain of hashes), `signature` (of persons and benches over
//!    seals), `store` ([`Store`]: one open file or server);
//! 3. `history` writes: [`RunWriter`] records a run as it happens, people change the state of faults; `query` reads;
//! 4. `maintenance` checks, backs up and prunes files; `server` sets up a server; `exchange` brings the rows of one store
//!    into another: import, export, synchronisation.
//!
//! The crate reads no clock, starts no thread, draws no random number and opens no file but the database:
//! the caller gives times and an [`IdSource`]. Exceptions: [`read_regular_file`] and [`AtomicFile`] read and
//! replace files for the whole program; connecting to a server reads the password file and certificates
//! that the address and the environment name, on a thread that is abandoned after a time limit.
//!
//! Names ending in `at_us` are microseconds since 1970 (UTC); `bench_us` is time on the bench's own clock;
//! `bench_time_us` and `wall_time_us` are durations.

#![warn(missing_docs)]

mod backend;
mod error;
mod exchange;
mod files;
mod history;
mod id;
mod maintenance;
mod query;
mod schema;
mod seal;
mod server;
mod signature;
mod store;
pub mod trace;
mod values;

pub use error::{
    Advice, Damage, Derived, FileChange, MOST_RESULT_BYTES, ProblemKind, QueryLimit, Samples,
    SchemaObject, SealPlace, ServerReason, StoreError, WrongSignature,
};
pub use exchange::domain::{Refusals, Refused};
pub use exchange::{
    CopyOf, Difference, LastSync, MergeCounts, SyncOptions, SyncOutcome, SyncPhase, SyncProgress,
};
pub use files::databases::is_of_database;
pub use files::regular_file::{open_regular_file, read_regular_file};
pub use history::cases::CaseFault;
pub use history::conflicts::{ConflictingEvent, StateConflict};
pub use history::dictionaries::DictionaryRecord;
pub use history::insert::FaultStored;
pub use history::instruments::Instrument;
pub use history::limits;
pub use history::recording::{Recording, RecordingRecord};
pub use history::run_notes::RunNote;
pub use history::run_writer::RunWriter;
pub use history::verify::{RepairToProve, SettledFault};
pub use history::withdrawal::{ToWithdraw, Withdrawn};
pub use id::{Id, IdSource};
pub use maintenance::{CheckReport, KeyUse, Problem, PruneCounts, PruneRule, Verification};
pub use query::{
    ConfirmedCase, ConfirmedRepairs, FaultDetail, FaultFilter, FaultStat, FaultSummary, Life,
    LifeEvent, LifeFault, LifeOf, LifeRun, LifeWhat, NamedFault, Occurrence, PartHistory,
    PartRepair, QueryBounds, QueryResult, RepairsOf, RunDetail, RunFault, RunFilter, RunOccurrence,
    RunState, RunSummary, SAME_ENTRY_US, SqlValue, StatKey, StatQuery, Stay, TraceHead,
    TraceSummary, TrendDay, TrendLimits, TrendPoint, TrendQuery, TrendStep, TrendUnit, code_number,
    is_practice,
};
pub use schema::views::VIEWS_PAGE;
pub use schema::{APPLICATION_ID, SCHEMA_VERSION};
pub use seal::{RunSealed, SealHead};
pub use server::{Address, SERVER_SCHEMA_VERSION, ServerSetup};
pub use signature::{About, Places, SignatureError, Signed, Signer, Statement, canonical_json};
pub use store::Store;
pub use store::atomic_file::AtomicFile;
pub use store::open_options::{OpenOptions, Synchronous};
pub use trace::{Channel, ChannelKind, TraceData, TraceError};
pub use values::event::{Correction, FaultEvent};
pub use values::fault_state::{FaultAction, FaultState, TransitionError};
pub use values::record::{
    CauseRecord, FaultRecord, FreezeSample, LOG_SOURCE, MeasurementRecord, RepairRecord, RunEnd,
    RunRecord, ScriptRecord, StepKind, StepRecord, UnitRecord, Verdict,
};
pub use values::step_counts::{StepCounter, StepCounts, rank};
pub use values::text_enum::UnknownWord;
pub use values::trace_place::TracePlace;
pub use values::withdrawal_error::WithdrawalError;
