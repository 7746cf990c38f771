//! Failures reported to the user, each with its exit code.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use btu_rig::rig::LinkTrouble;
use fault_db::{Id, StoreError, TraceError};
use script_files::ScriptsError;

use crate::link::NoUnit;
use crate::stdio;

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
    /// A unit on a port.
    NoUnit(NoUnit),
    /// The link to a unit that was there.
    Link(LinkTrouble),
    /// An instrument of the bench whose calibration does not hold, and nothing was driven.
    Uncalibrated {
        /// Its kind, as "tachometer".
        kind: String,
        /// Which.
        serial_no: String,
        /// The day it was due; none: it was never calibrated.
        due: Option<String>,
    },
    /// In words.
    Told(String),
}

impl<T: Into<String>> From<T> for Trouble {
    fn from(words: T) -> Self {
        Self::Told(words.into())
    }
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Store(error) => f.write_str(&store_message(error)),
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
            Self::Uncalibrated {
                kind,
                serial_no,
                due,
            } => {
                match due {
                    Some(due) => {
                        write!(f, "the calibration of {kind} {serial_no} was due on {due}")
                    }
                    None => write!(f, "{kind} {serial_no} was never calibrated"),
                }?;
                write!(
                    f,
                    "; nothing was driven. `ptu instrument calibrate {serial_no}` states a new calibration, \
                     --uncalibrated goes on without one, and the sheet says so"
                )
            }
            Self::NoUnit(why) => why.fmt(f),
            Self::Link(why) => why.fmt(f),
            Self::Told(words) => f.write_str(words),
        }
    }
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
    /// All that failed as one, which says each; what is to be done is done, whichever fails.
    ///
    /// # Errors
    /// At least one failed.
    pub fn of_all(done: impl IntoIterator<Item = Result<(), Self>>) -> Result<(), Self> {
        let failed = done.into_iter().filter_map(Result::err);
        let all = failed.reduce(|first, next| Self {
            exit: first.exit,
            message: format!("{first}\n{next}").into(),
        });
        all.map_or(Ok(()), Err)
    }

    /// Prints the failure on stderr.
    pub fn tell(&self) {
        stdio::note(&format!("ptu: {self}"));
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
        Self::usage(error.to_string())
    }
}

impl From<StoreError> for Failure {
    fn from(error: StoreError) -> Self {
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
            | StoreError::QueryExceeds { .. }
            | StoreError::Trace {
                source: TraceError::UnknownChannel { .. },
                ..
            } => Exit::Usage,
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

/// ` (did you mean "x"?)` for the known name nearest to `asked`, in capitals or not; or nothing.
pub fn did_you_mean<'a>(asked: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let asked = asked.to_lowercase();
    let near = known
        .into_iter()
        .map(|name| (strsim::jaro_winkler(&asked, &name.to_lowercase()), name))
        .filter(|(score, _)| *score > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0));
    meant(near.map(|(_, name)| name))
}

/// The same for serial numbers: those of a fleet are all alike, and one with another digit is another
/// unit's. What is near differs in capitals or signs, or is a slip of one key.
pub fn did_you_mean_number<'a>(asked: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let plain = |text: &str| -> String {
        let letters = text.chars().filter(|letter| letter.is_alphanumeric());
        letters.flat_map(char::to_lowercase).collect()
    };
    let asked = plain(asked);
    let near = known
        .into_iter()
        .map(|name| (slips(&asked, &plain(name)), name))
        .filter(|(slips, _)| *slips < 2)
        .min_by_key(|(slips, _)| *slips);
    meant(near.map(|(_, name)| name))
}

/// Keys pressed wrong, where another digit is none.
fn slips(asked: &str, name: &str) -> usize {
    let both = || asked.chars().zip(name.chars());
    let other_digits = both().filter(|(a, b)| a != b && a.is_ascii_digit() && b.is_ascii_digit());
    let same_length = asked.chars().count() == name.chars().count();
    match other_digits.count() {
        1 if same_length => usize::MAX,
        _ => strsim::osa_distance(asked, name),
    }
}

fn meant(name: Option<&str>) -> String {
    name.map(|name| format!(" (did you mean \"{name}\"?)"))
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_serial_number_is_suggested_only_if_it_is_similar() {
        let known = ["ATC-1001", "ATC-1002", "SG-0142"];
        for (asked, near) in [
            ("atc-1001", " (did you mean \"ATC-1001\"?)"),
            ("ATC 1002", " (did you mean \"ATC-1002\"?)"),
            ("SG-142", " (did you mean \"SG-0142\"?)"),
            ("SG-0412", " (did you mean \"SG-0142\"?)"),
            ("ATV-1001", " (did you mean \"ATC-1001\"?)"),
            ("ATC-1003", ""),
            ("BTC-1004", ""),
            ("99", ""),
            ("", ""),
        ] {
            assert_eq!(did_you_mean_number(asked, known), near, "{asked}");
        }
    }

    #[test]
    fn a_name_is_suggested_whatever_its_case() {
        let hint = did_you_mean("EB_RELY", ["tacho_a", "eb_relay"]);
        assert_eq!(hint, " (did you mean \"eb_relay\"?)");
        assert_eq!(did_you_mean("xyz", ["eb_relay"]), "");
    }
}
