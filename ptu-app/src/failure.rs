//! What goes wrong at the edge, told to a person, with the exit code that goes with it.

use std::fmt;

use fault_db::{StoreError, TraceError};

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

/// An error for a person: what happened, to which thing, what to do next.
#[derive(Debug)]
pub struct Failure {
    /// The exit code.
    pub exit: Exit,
    /// The message.
    pub message: String,
}

impl Failure {
    /// The command or a script is wrong.
    pub fn usage(message: impl Into<String>) -> Self {
        Self {
            exit: Exit::Usage,
            message: message.into(),
        }
    }

    /// The bench, the link or the database does not work.
    pub fn bench(message: impl Into<String>) -> Self {
        Self {
            exit: Exit::Bench,
            message: message.into(),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Failure {}

impl From<StoreError> for Failure {
    fn from(error: StoreError) -> Self {
        // Asking for the wrong thing is the caller's mistake; a file that does not serve is not.
        let exit = match error {
            StoreError::NotFound { .. }
            | StoreError::Ambiguous { .. }
            | StoreError::BadId { .. }
            | StoreError::NoWords { .. }
            | StoreError::NotAFile { .. }
            | StoreError::NotAServer { .. }
            | StoreError::BadAddress { .. }
            | StoreError::Transition { .. }
            | StoreError::TargetExists { .. }
            | StoreError::SameFile { .. }
            | StoreError::QueryRefused { .. }
            | StoreError::QueryFailed { .. }
            | StoreError::Trace {
                source: TraceError::UnknownChannel { .. },
                ..
            } => Exit::Usage,
            _ => Exit::Bench,
        };
        Self {
            exit,
            message: error.to_string(),
        }
    }
}

/// ` (did you mean "x"?)` for the known name nearest to `asked`, or nothing.
pub fn did_you_mean<'a>(asked: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    known
        .into_iter()
        .map(|name| (strsim::jaro_winkler(asked, name), name))
        .filter(|(score, _)| *score > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| format!(" (did you mean \"{name}\"?)"))
        .unwrap_or_default()
}
