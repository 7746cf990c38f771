//! Findings of a check and their remedies, as data; as text they go to a terminal and into JSON.

use std::fmt;
use std::sync::Arc;

use chrono::DateTime;
use serde::{Serialize, Serializer};

use super::StoreError;
use crate::id::Id;
use crate::signature::SignatureError;
use crate::values::text_enum::text_enum;

/// Where something is wrong, and what.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Damage {
    /// Damage in the words of SQLite or of a decoder.
    #[error("{0}")]
    Told(String),
    /// Number of further findings of this kind, which are not listed.
    #[error("and {0} more of this kind")]
    More(u32),
    /// Reading broke off; the rest was not checked.
    #[error("the rest could not be looked at: {0}")]
    Rest(Arc<StoreError>),
    /// A trace cannot be read.
    #[error("{0}")]
    Unread(Arc<StoreError>),
    /// A row refers to a missing row: the row's number if it has one, its table, and the other table.
    #[error("{} of {} points at a missing row of {}", row(*.0), .1, .2)]
    NoParent(Option<i64>, String, String),
    /// An object that no version of this program makes.
    #[error("the {0} is not of this program")]
    Foreign(SchemaObject),
    /// An object that was altered.
    #[error("the {0} is not as this program made it")]
    Remade(SchemaObject),
    /// An object that is not there.
    #[error("the {0} is missing")]
    NoObject(SchemaObject),
    /// The file has no id.
    #[error("the file's own name was taken out of it")]
    NoName,
    /// Seals before this one are missing: their numbers.
    #[error("{0}: before it seals were taken out, number {1}")]
    NoSeals(SealPlace, String),
    /// The hash of a seal does not follow from the seal before: kind and id of what it covers.
    #[error("{0} ({1} {2}) does not fit the one before: it was changed")]
    Unchained(SealPlace, String, Id),
    /// A run, event or note that a seal covers is missing.
    #[error("{0}: its {1} was taken out")]
    Unsealed(SealPlace, String),
    /// The statement that a seal holds was changed.
    #[error("{0} was changed")]
    SealChanged(SealPlace),
    /// A run, event or note differs from its seal.
    #[error("{0} {1} was changed after it was sealed")]
    Changed(&'static str, Id),
    /// A signature does not hold.
    #[error("the signature at {0}: {1}")]
    Signature(SealPlace, WrongSignature),
    /// The derived rows were recomputed: when, and what had differed, as sentences.
    #[error("counted again at {}; before, {}", time(*.0), .1.join("; "))]
    Recounted(i64, Vec<String>),
    /// A trace differs from the digest in the seal of its run.
    #[error("trace {0} was changed after its run was sealed")]
    TraceChanged(Id),
    /// A trace is not listed in the seal of its run: trace, run.
    #[error("trace {0} was put into run {1} after it was sealed")]
    TraceAdded(Id, Id),
    /// A recording differs from the digest in the seal of its run: recording, run.
    #[error("recording {0} of run {1} was changed after it was sealed")]
    RecordingChanged(i64, Id),
    /// A recording is not listed in the seal of its run: recording, run.
    #[error("recording {0} was put into run {1} after it was sealed")]
    RecordingAdded(i64, Id),
    /// Samples that a seal of this file names are not there.
    #[error("{0} was taken out: no seal says that it was pruned")]
    NoSamples(Samples),
    /// Samples that a seal of another file names are not there.
    #[error(
        "{0} is missing: it was refused when its run came from another file, or taken out, and no seal says that it was pruned; import a whole copy of that file, which brings it"
    )]
    SamplesLeft(Samples),
    /// The file's own chain of seals has no first entry.
    #[error("the beginning of this file's own chain of seals is not there: it was taken out")]
    NoBeginning,
    /// An entry of a file's chain is not the one known before: file, entry, and when it was known (µs since 1970; 0: in
    /// this file).
    #[error("the chain of file {} was rewritten: entry {} is not the one that was known {}", (.0).short(), .1, at(*.2))]
    Rewritten(Id, i64, i64),
    /// An entry of a file's chain is missing: file, entry, and when it was known (µs since 1970; 0: in this file).
    #[error("the chain of file {} was cut: entry {}, which was known {}, is not there", (.0).short(), .1, at(*.2))]
    Cut(Id, i64, i64),
    /// An event or a note has no seal: the word for its table, and its id.
    #[error("one of the {0}, {1}, has no seal: it was put in by hand, or its seal was taken out")]
    NoSeal(&'static str, Id),
    /// A finished run has no seal.
    #[error(
        "run {0} was finished and has no seal: its seal was taken out, or it was put in by hand"
    )]
    NoSealOfRun(Id),
    /// A sealed run has no verdict.
    #[error("run {0} has a seal and no verdict: the verdict was taken away")]
    NoVerdict(Id),
    /// Number of runs that were recorded here and are missing.
    #[error("{0} runs that were recorded here are not there any more")]
    NoRuns(i64),
    /// Number of differing rows in a derived table.
    #[error("{0} {1} are not what the history says")]
    Miscounted(i64, Derived),
    /// A fault has a name or severity that none of its occurrences has.
    #[error("fault {0} has a name or a severity that no occurrence of it says")]
    FaultNamed(String),
    /// An occurrence has another unit, code or part than its fault.
    #[error("occurrence {0} is of another unit, code or part than its fault")]
    OtherFault(String),
    /// An occurrence has another unit or line than its run.
    #[error("occurrence {0} is of another unit or line than its run")]
    OtherRun(String),
    /// No run found the unit as its row says: the serial number.
    #[error("unit {0} is what no run found it to be")]
    UnitNamed(String),
    /// A fault's derived columns do not follow from its occurrences and events.
    #[error("fault {0} is not as its occurrences and events say: state, times, line or counts")]
    FaultDerived(String),
    /// A trigger that guards a server's table is off or missing: the trigger and the table.
    #[error("trigger {0} of table {1} is off or gone: its rows can be changed")]
    NoGuard(String, String),
}

/// Reason for which a signature does not hold.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WrongSignature {
    /// The signature cannot be read, or does not fit its document.
    #[error(transparent)]
    Document(SignatureError),
    /// The signed document is no statement about a seal.
    #[error("it is no statement about a seal")]
    NoStatement,
    /// The statement names no seal.
    #[error("it names no seal")]
    NoSeal,
    /// The signature is stored at the wrong place: kind and id of what it signs.
    #[error("it is of another: it signs {0} {1}")]
    Other(String, Id),
    /// A thing of this kind cannot be signed at that place.
    #[error("a \"{0}\" is not signed there")]
    NotThere(String),
    /// The signed seal is missing: kind and id of what it covered.
    #[error("the seal of {0} {1} was taken out")]
    SealGone(String, Id),
    /// The seal is not the one that was signed: kind and id of what it covers, and its place.
    #[error("the seal of {} {}, entry {} of file {}, is not the one that was signed", .0, .1, (.2).entry, (.2).file.short())]
    OtherSeal(String, Id, SealPlace),
}

text_enum! {
    /// The part of a history that has a problem.
    ProblemKind {
        /// Damage that SQLite itself finds.
        Integrity = "integrity",
        /// Tables, indexes, views or triggers were altered.
        Schema = "schema",
        /// A row refers to a missing row.
        ForeignKey = "foreign_key",
        /// Derived columns do not follow from the other rows.
        Count = "count",
        /// Faults, occurrences and units contradict each other.
        Fault = "fault",
        /// A trace cannot be read.
        Trace = "trace",
        /// A recording cannot be read.
        Recording = "recording",
        /// Seals or signatures are broken.
        Seal = "seal",
        /// Derived tables do not follow from the other rows.
        Derived = "derived",
    }
}

text_enum! {
    /// Derived tables, which are recomputed from the other rows.
    Derived {
        /// Repairs.
        Repairs = "rows of the table of repairs",
        /// Sums by day.
        Days = "sums of measured values by day",
        /// Sums by month.
        Months = "sums of measured values by month",
        /// Packed faults.
        Packed = "blocks of packed faults",
        /// Words of notes on faults.
        FaultNotes = "notes on faults that a search does not find, or finds and are not there",
        /// Words of notes on runs.
        RunNotes = "notes on runs that a search does not find, or finds and are not there",
    }
}

text_enum! {
    /// The next step of a person whose file has a problem.
    Advice {
        /// The file is damaged.
        FromBackup = "keep this file as it is and go on with a backup; other laptops and the server may have what was recorded since",
        /// Samples are damaged.
        Lost = "it cannot be brought back here; a backup, another laptop or the server may have it",
        /// Seals are broken.
        Altered = "somebody has changed the file by hand: what no line names can still be trusted as far as its seal is the one on a test sheet, in a backup or on the server; no command takes this finding away",
        /// Objects are foreign.
        ForeignObject = "nothing is written to such a file; keep a copy of it as it is, then go on with a backup, or take out by hand what is not of this program and check it again",
        /// Derived rows differ.
        Rebuild = "a row may have been changed by hand: hold the file against a backup or the server first; then `db rebuild` derives it again from the other rows, and what differed stays on record",
        /// Seals of a server are broken.
        SealsOfServer = "hold it against the test sheet or the laptop that recorded it; who owns the tables has changed them by hand",
        /// A server's tables are not guarded.
        GuardsOfServer = "let who looks after the server find out who took them off, and put them back from a backup",
    }
}

/// A table, index, view or trigger.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SchemaObject {
    /// Kind of the object, as SQLite says.
    pub kind: String,
    /// Name of the object.
    pub name: String,
    /// The table that an index, view or trigger belongs to; `None` for a table or view.
    pub on: Option<String>,
}

impl fmt::Display for SchemaObject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} \"{}\"", self.kind, self.name)?;
        (self.on.iter()).try_for_each(|on| write!(f, " on {on}"))
    }
}

/// Where a seal is: the chain of which file, and which entry of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SealPlace {
    /// The file.
    pub file: Id,
    /// Number of the entry in the file's chain, from 1.
    pub entry: i64,
}

impl fmt::Display for SealPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "seal {} of file {}", self.entry, self.file.short())
    }
}

/// Samples of a run: a trace, or a recording by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Samples {
    /// A trace.
    Trace(Id),
    /// Number of the recording in its run, and the run.
    Recording(i64, Id),
}

impl From<(Id, Option<i64>)> for Samples {
    fn from((id, recording): (Id, Option<i64>)) -> Self {
        recording.map_or(Self::Trace(id), |number| Self::Recording(number, id))
    }
}

impl fmt::Display for Samples {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Trace(id) => write!(f, "trace {id}"),
            Self::Recording(number, run) => write!(f, "recording {number} of run {run}"),
        }
    }
}

impl Serialize for Damage {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

fn row(number: Option<i64>) -> String {
    number.map_or("a row".to_owned(), |number| format!("row {number}"))
}

/// UTC time as text; `at_us` is µs since 1970.
pub(crate) fn time(at_us: i64) -> String {
    let at = DateTime::from_timestamp_micros(at_us).unwrap_or_default();
    at.format("%Y-%m-%d %H:%M:%S UTC").to_string()
}

fn at(seen_at_us: i64) -> String {
    match seen_at_us {
        0 => "here".to_owned(),
        at_us => format!("at {}", time(at_us)),
    }
}
