//! Failures reported to the user, each with its exit code.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use btu_rig::rig::LinkTrouble;
use fault_db::{Id, StoreError, TraceError};
use script_files::ScriptsError;

use crate::run_diagnosis::Warning;

mod near;

pub use crate::words::*;
pub use near::{Near, did_you_mean, did_you_mean_number};

/// Exit codes of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// All passed, or the question was answered.
    Passed,
    /// A check failed.
    Failed,
    /// The command or a script is wrong.
    Usage,
    /// The bench, the link or the database does not work.
    Bench,
    /// Stopped by the operator.
    Aborted,
}

impl Exit {
    /// The number the shell sees.
    pub const fn code(self) -> u8 {
        match self {
            Self::Passed => 0,
            Self::Failed => 1,
            Self::Usage => 2,
            Self::Bench => 3,
            Self::Aborted => 130,
        }
    }
}

/// What went wrong, as data where a window has words of its own for it. Its text is that of a command line.
#[derive(Clone, Debug)]
pub enum Trouble {
    /// The history.
    Store(Arc<StoreError>),
    /// The history, in a file that was not named with `--db`.
    NamedStore(Arc<StoreError>),
    /// A run that the history does not hold.
    NotStored {
        /// The run.
        run: Id,
        /// Why.
        error: Arc<StoreError>,
        /// Its last traces, which are lost.
        left_out: usize,
        /// The file that has it; none if it is lost.
        kept: Option<PathBuf>,
    },
    /// The history did not become free: what was measured since is kept in a file.
    RestKept {
        /// Why the history cannot take it.
        error: Arc<StoreError>,
        /// The file.
        rest: PathBuf,
    },
    /// The link to a unit that was there.
    Link(LinkTrouble),
    /// What of the dictionary an adaptive run must not go by.
    Stale(Vec<Warning>),
    /// What has its sentences in the tables of words.
    Refused(Box<Refusal>),
    /// The first one because of the second.
    Because(Box<[Self; 2]>),
    /// Several at once.
    All(Vec<Self>),
    /// In words of others.
    Told(String),
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Store(error) => f.write_str(&store_message(error)),
            Self::NamedStore(error) => error.fmt(f),
            Self::NotStored {
                run,
                error,
                left_out,
                kept,
            } => {
                let (run, why) = (run.short(), store_message(error));
                let Some(kept) = kept.as_ref().map(|kept| kept.display()) else {
                    return write!(f, "run {run} is not in the history, and lost: {why}");
                };
                write!(f, "run {run} is not in the history: ")?;
                if *left_out > 0 {
                    write!(f, "the last {left_out} of its traces are lost: ")?;
                }
                let again = "bring it in with `ptu db import";
                write!(f, "{why}; it is kept in {kept}: {again} {kept}`")
            }
            Self::RestKept { error, rest } => {
                let (why, rest) = (store_message(error), rest.display());
                write!(
                    f,
                    "{why}; what was measured since is kept in {rest}: bring it in with `ptu db import {rest}` when \
                     the database is free"
                )
            }
            Self::Link(why) => why.fmt(f),
            Self::Refused(what) => f.write_str(&what.say(Manner::COMMAND_LINE)),
            Self::Stale(all) => joined(f, all, "; "),
            Self::Because(both) => joined(f, &**both, ": "),
            Self::All(all) => joined(f, all, "\n"),
            Self::Told(words) => f.write_str(words),
        }
    }
}

fn joined(f: &mut fmt::Formatter<'_>, all: &[impl fmt::Display], by: &str) -> fmt::Result {
    let all: Vec<_> = all.iter().map(ToString::to_string).collect();
    f.write_str(&all.join(by))
}

/// An error for a person: what happened, to which thing, what to do next.
#[derive(Debug)]
pub struct Failure {
    /// The exit code.
    pub exit: Exit,
    /// The message.
    pub message: Trouble,
}

impl Failure {
    /// The command or a script is wrong.
    pub fn usage(message: impl Into<Trouble>) -> Self {
        Self {
            exit: Exit::Usage,
            message: message.into(),
        }
    }

    /// The bench, the link or the database does not work.
    pub fn bench(message: impl Into<Trouble>) -> Self {
        Self {
            exit: Exit::Bench,
            message: message.into(),
        }
    }
}

impl Failure {
    /// The same, with what happened before the reason for it.
    #[must_use]
    pub fn because_of(self, what: impl Into<Trouble>) -> Self {
        let message = Trouble::Because(Box::new([what.into(), self.message]));
        Self { message, ..self }
    }

    /// All that failed as one, which says each; what is to be done is done, whichever fails.
    ///
    /// # Errors
    /// At least one failed.
    pub fn of_all(done: impl IntoIterator<Item = Result<(), Self>>) -> Result<(), Self> {
        let mut failed = done.into_iter().filter_map(Result::err);
        let Some(mut first) = failed.next() else {
            return Ok(());
        };
        let others: Vec<_> = failed.map(|next| next.message).collect();
        if !others.is_empty() {
            first.message = Trouble::All([vec![first.message], others].concat());
        }
        Err(first)
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.message.fmt(f)
    }
}

impl std::error::Error for Failure {}

impl From<ScriptsError> for Failure {
    fn from(error: ScriptsError) -> Self {
        Self::usage(match error {
            ScriptsError::NotADirectory(folder) => {
                FileTrouble::NoDirectory(folder.display().to_string())
            }
            ScriptsError::Unreadable { what, why } => FileTrouble::Unread(what, Why::Said(why)),
        })
    }
}

impl From<StoreError> for Failure {
    fn from(error: StoreError) -> Self {
        if let StoreError::Trace {
            source: TraceError::UnknownChannel { channel, known },
            ..
        } = error
        {
            let near = did_you_mean(&channel, known.iter().map(String::as_str));
            return Self::usage(Unknown::Signal(channel, near));
        }
        // Asking for the wrong thing is the caller's mistake; a file that does not serve is not.
        let exit = match error {
            StoreError::NotFound { .. }
            | StoreError::TraceMissing { .. }
            | StoreError::Ambiguous { .. }
            | StoreError::BadId { .. }
            | StoreError::NoWords { .. }
            | StoreError::TextTooLong { .. }
            | StoreError::NotAFile { .. }
            | StoreError::NotAServer { .. }
            | StoreError::BadAddress { .. }
            | StoreError::Transition { .. }
            | StoreError::TargetExists { .. }
            | StoreError::SameFile { .. }
            | StoreError::QueryRefused { .. }
            | StoreError::QueryFailed { .. }
            | StoreError::QueryExceeds { .. } => Exit::Usage,
            _ => Exit::Bench,
        };
        Self {
            exit,
            message: Trouble::Store(Arc::new(error)),
        }
    }
}

/// The message of a database error. Where its next move is another database, the flag that names one is added.
pub fn store_message(error: &StoreError) -> String {
    match in_place_of(error) {
        Some(_) => format!("{error} with --db"),
        None => error.to_string(),
    }
}

/// The file in whose place an error says to choose another.
pub fn in_place_of(error: &StoreError) -> Option<&Path> {
    match error {
        StoreError::Locked { path }
        | StoreError::Full { path }
        | StoreError::ReadOnly { path }
        | StoreError::NotADatabase { path }
        | StoreError::ForeignDatabase { path, .. }
        | StoreError::NewerSchema { path, .. }
        | StoreError::Missing { path }
        | StoreError::CannotOpen { path, .. }
        | StoreError::NotAFile { path } => Some(path),
        _ => None,
    }
}
