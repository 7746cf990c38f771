//! Errors of the store: each names the file or server and what to do next. A message that tells to choose another file
//! does not say how: the caller adds that.

mod damage;
mod file_change;
mod query_limit;
mod server;
mod sqlite;

use std::path::PathBuf;

use crate::id::{Id, list};
use crate::trace::TraceError;
use crate::values::fault_state::TransitionError;
use crate::values::withdrawal_error::WithdrawalError;
pub(crate) use damage::time;
pub use damage::{
    Advice, Damage, Derived, ProblemKind, Samples, SchemaObject, SealPlace, WrongSignature,
};
pub use file_change::FileChange;
pub use query_limit::{MOST_RESULT_BYTES, QueryLimit};
pub use server::ServerReason;

/// An error of the store. What was committed before is kept.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// Another connection holds the file for longer than the busy timeout.
    #[error("database busy: {} is locked by another program; close it or choose another file", .0.display())]
    Locked(PathBuf),
    /// The caller stopped the work; nothing of it is kept.
    #[error("stopped before its end")]
    Stopped,
    /// No room for the write; what was committed before remains.
    #[error("no room left to write {} (all that was recorded before is kept); free some space or choose another disk", .0.display())]
    Full(PathBuf),
    /// The file or its directory is write-protected.
    #[error("{} is read-only; make it and its directory writable or choose another file", .0.display())]
    ReadOnly(PathBuf),
    /// The file is something else than a SQLite database.
    #[error("{} is not a database; choose another file", .0.display())]
    NotADatabase(PathBuf),
    /// A SQLite database of another program.
    #[error("{} is a database of another program (application id {application_id:#010x}); choose another file", .path.display())]
    ForeignDatabase {
        /// The file.
        path: PathBuf,
        /// Application id of the file.
        application_id: i32,
    },
    /// Written by a later version of this program.
    #[error("{} was written by a newer version (schema {found}, this one knows {known}); update the program or choose another file", .path.display())]
    NewerSchema {
        /// The database file.
        path: PathBuf,
        /// Schema version of the file.
        found: i32,
        /// The newest schema version that this crate knows.
        known: i32,
    },
    /// The file holds a table, index, view or trigger that this program did not make, or an altered one.
    #[error("{} was altered by hand: {what}{}; nothing is written to it. Look at it with `db check` and `db query`, keep a copy of it as it is, then go on with a backup, or take out by hand what is not of this program and check it again", .path.display(), and_more(*.more))]
    Altered {
        /// The database file.
        path: PathBuf,
        /// The first finding.
        what: Box<Damage>,
        /// Number of further findings.
        more: usize,
    },
    /// The file is no longer the one that was opened, or another name leads to it, too.
    #[error("the database {} {what}", .path.display())]
    FileChanged {
        /// The database file.
        path: PathBuf,
        /// Change of the file.
        what: FileChange,
    },
    /// The file is an older copy: a longer version of its chain of seals is known elsewhere.
    #[error("{} is a copy from before: it ends with entry {here} of its chain of seals, and {there} are known there; if it is a backup that is to be gone on with, give it a name of its own with `db sync --as-copy`, else go on with the file itself", .path.display())]
    EarlierCopy {
        /// The database file.
        path: PathBuf,
        /// Entries in the file.
        here: i64,
        /// Entries known elsewhere.
        there: i64,
    },
    /// The file and the copy known elsewhere have forked: each has entries that the other lacks.
    #[error("{} is a copy that went on by itself after entry {after} of its chain of seals: what is known there of it after that is not in it; bring what is new in it into the file itself with `db import`, or give it a name of its own with `db sync --as-copy`", .path.display())]
    ForkedCopy {
        /// The database file.
        path: PathBuf,
        /// Number of the last entry that both copies have.
        after: i64,
    },
    /// An entry of the chain differs from the one known elsewhere.
    #[error("the history in {} was rewritten after entry {after} of its chain of seals: {what} {id} is not what it was sealed as; nothing of it is taken. Keep the file as it is, and go on with a backup or a new file", .path.display())]
    Rewritten {
        /// The database file.
        path: PathBuf,
        /// Number of the last entry that is equal in both copies.
        after: i64,
        /// run, event or note.
        what: String,
        /// Id of that run, event or note.
        id: Id,
    },
    /// The file has an earlier schema, which a read-only opening may not migrate.
    #[error("{} has the older schema {found} (this version reads {known}); open it once for writing to bring it up to date", .path.display())]
    OlderSchema {
        /// The database file.
        path: PathBuf,
        /// Schema version of the file.
        found: i32,
        /// The schema version that this crate reads.
        known: i32,
    },
    /// There is no such file; reading does not create one.
    #[error("there is no database {}; a first run creates it, or choose another file", .0.display())]
    Missing(PathBuf),
    /// The file cannot be opened at all.
    #[error("cannot open {}: {reason}; check the path and its directory or choose another file", .path.display())]
    CannotOpen {
        /// The file asked for.
        path: PathBuf,
        /// Message of the system.
        reason: String,
    },
    /// The disk or the system failed a read or a write.
    #[error("reading or writing {} failed ({reason}); check the disk, then the file with `db check`", .path.display())]
    Io {
        /// The database file.
        path: PathBuf,
        /// The error of the system.
        reason: String,
    },
    /// SQLite cannot follow the file's pages.
    #[error("{} is damaged; run `db check`, then go on with a backup", .0.display())]
    Malformed(PathBuf),
    /// The file's content contradicts itself.
    #[error("{} is damaged ({detail}); run `db check`, then go on with a backup", .path.display())]
    Corrupt {
        /// The database file.
        path: PathBuf,
        /// Damage, and its place.
        detail: String,
    },
    /// No row has the id or name.
    #[error("no {what} {asked:?}; list them to see what there is")]
    NotFound {
        /// run, fault, trace or measurement.
        what: &'static str,
        /// The name that was asked for.
        asked: String,
    },
    /// A run names the trace, which is not here.
    #[error(
        "trace {asked:?} of run {run} is not here: it was pruned, taken out, or refused by an import because it did \
         not fit its seal; importing a whole copy of the file that recorded it brings it"
    )]
    TraceMissing {
        /// The trace that was asked for.
        asked: String,
        /// The run.
        run: Id,
    },
    /// A partial id fits several rows.
    #[error("{asked:?} fits more than one {what}: {}; give more digits", list(.matches))]
    Ambiguous {
        /// run, fault or trace.
        what: &'static str,
        /// The name that was asked for.
        asked: String,
        /// A few rows that fit.
        matches: Vec<Id>,
    },
    /// A search text has no word.
    #[error("{0:?} has no word to search for; give letters or digits")]
    NoWords(String),
    /// The text is neither an id, nor a part of one, nor `latest`.
    #[error(
        "{asked:?} is no {what} id: give `latest`, a full id, or at least four hex digits of its beginning or end"
    )]
    BadId {
        /// run, fault or trace.
        what: &'static str,
        /// The id that was asked for.
        asked: String,
    },
    /// A text exceeds its limit.
    #[error("{what} has {length} characters, and at most {most} are kept; shorten it")]
    TextTooLong {
        /// Name of the text, as "the note".
        what: &'static str,
        /// Length of the text, characters.
        length: usize,
        /// The limit.
        most: usize,
    },
    /// The fault's state does not allow the action.
    #[error("fault {fault}: {source}")]
    Transition {
        /// The fault.
        fault: Id,
        /// The refused transition.
        source: TransitionError,
    },
    /// A withdrawal is refused.
    #[error("fault {0}: {1}")]
    Withdrawal(Id, #[source] WithdrawalError),
    /// Steps of a run must have rising indexes.
    #[error("step {index} recorded after step {last}: step indexes must rise")]
    StepOrder {
        /// The index given.
        index: u32,
        /// The last one recorded.
        last: u32,
    },
    /// The run already has its verdict.
    #[error("run {0} is finished; begin a new run to record more")]
    RunFinished(Id),
    /// Writing has failed for so long that no more steps can be buffered.
    #[error("{waiting} steps wait in memory because {} cannot be written; stop the run", .path.display())]
    StepsWaiting {
        /// The database file.
        path: PathBuf,
        /// Buffered steps.
        waiting: usize,
    },
    /// The trace cannot be encoded or decoded.
    #[error("trace {trace}: {source}")]
    Trace {
        /// The trace.
        trace: Id,
        /// Error of the trace.
        source: TraceError,
    },
    /// A backup or export never overwrites.
    #[error("{} exists already; name a file that does not", .0.display())]
    TargetExists(PathBuf),
    /// A backup or export cannot be made where it was asked for.
    #[error("cannot write {}: {reason}; name another target", .path.display())]
    CannotWrite {
        /// The target asked for.
        path: PathBuf,
        /// What is missing, or the system's message.
        reason: String,
    },
    /// One file is both source and target.
    #[error("{} cannot be merged into itself; name another file", .0.display())]
    SameFile(PathBuf),
    /// The SQL of a query does more than read.
    #[error("only one reading statement is allowed here ({0}); write a single SELECT")]
    QueryRefused(String),
    /// SQLite rejected the SQL of a query.
    #[error("the query failed: {0}")]
    QueryFailed(String),
    /// The query exceeds a limit.
    #[error("the query was given up: {0}")]
    QueryExceeds(QueryLimit),
    /// The operation needs a file, and this is a server.
    #[error("{} is a server, and this needs a database file, which `db sync` brings to the server; name one", .0.display())]
    NotAFile(PathBuf),
    /// The operation needs a server, and this is a file.
    #[error("{} is a file, and this needs a server; name one as postgres://USER@HOST/DATABASE", .0.display())]
    NotAServer(PathBuf),
    /// The text is no address of a server.
    #[error("bad server address: {0}; write postgres://USER@HOST/DATABASE")]
    BadAddress(String),
    /// The server does not answer, or no longer.
    #[error("{} is away ({doing}: {reason}); look at the network and the server, then try again (nothing is lost: the laptop's file has everything)", .path.display())]
    ServerUnreachable {
        /// The server.
        path: PathBuf,
        /// Work during which the error came.
        doing: &'static str,
        /// Reason of the error.
        reason: ServerReason,
    },
    /// The server refuses the connection or the right.
    #[error("{} refuses: {reason}; ask who looks after the server", .path.display())]
    ServerRefuses {
        /// The server.
        path: PathBuf,
        /// The server's message.
        reason: ServerReason,
    },
    /// The server's certificate is not trusted.
    #[error("{} is not trusted: {reason}", .path.display())]
    ServerNotTrusted {
        /// The server.
        path: PathBuf,
        /// Missing thing, and the remedy.
        reason: ServerReason,
    },
    /// Other sessions keep the server busy for too long.
    #[error("{} is busy ({doing}: {reason}); try again later", .path.display())]
    ServerBusy {
        /// The server.
        path: PathBuf,
        /// Work during which the error came.
        doing: &'static str,
        /// The server's message.
        reason: String,
    },
    /// There are no tables on the server yet.
    #[error("there is no history on {} yet; who looks after the server makes its tables once: `ptu db server init ADDRESS`, as their owner", .0.display())]
    ServerEmpty(PathBuf),
    /// The server's tables or rights cannot be set up.
    #[error("{} was not set up: {reason}", .path.display())]
    ServerSetup {
        /// The server.
        path: PathBuf,
        /// Missing thing, and the remedy.
        reason: String,
    },
    /// The database on the server holds something else.
    #[error("the database of {} holds tables of another program; make one of its own with createdb", .0.display())]
    ServerForeign(PathBuf),
    /// The server's tables are of an earlier version.
    #[error("{} has the older schema {found} (this program knows {known}); who looks after the server brings it up to date: `ptu db server init ADDRESS` of this program, as the owner of its tables", .path.display())]
    ServerOlderSchema {
        /// The server.
        path: PathBuf,
        /// Schema version of the server.
        found: i32,
        /// The schema version that this crate knows.
        known: i32,
    },
    /// The server's tables are of a later version.
    #[error("this program knows schema {known}, {} has schema {found}; update ptu", .path.display())]
    ServerNewerSchema {
        /// The server.
        path: PathBuf,
        /// Schema version of the server.
        found: i32,
        /// The schema version that this crate supports.
        known: i32,
    },
    /// Any other error of a server.
    #[error("{doing} at {}: {}", .path.display(), server::message(.source))]
    Server {
        /// The server.
        path: PathBuf,
        /// Work during which the error came.
        doing: &'static str,
        /// The server's error.
        source: postgres::Error,
    },
    /// Any other error of SQLite: a bug of this program.
    #[error("{doing} in {}: {source}", .path.display())]
    Sqlite {
        /// The database file.
        path: PathBuf,
        /// Work during which the error came.
        doing: &'static str,
        /// SQLite's error.
        source: rusqlite::Error,
    },
}

impl StoreError {
    /// Error for an id without a row.
    pub(crate) fn not_found(what: &'static str, id: Id) -> Self {
        Self::NotFound {
            what,
            asked: id.to_string(),
        }
    }
}

/// Two errors are the same if they say the same.
impl PartialEq for StoreError {
    fn eq(&self, other: &Self) -> bool {
        self.to_string() == other.to_string()
    }
}

fn and_more(more: usize) -> String {
    match more {
        0 => String::new(),
        more => format!(", and {more} more"),
    }
}
