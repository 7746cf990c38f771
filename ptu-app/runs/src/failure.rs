//! Failures reported to the user, each with its exit code.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use btu_rig::procedure::{Finding, Verdict};
use btu_rig::rig::LinkTrouble;
use fault_db::{Id, StoreError, TraceError};
use script_files::ScriptsError;

pub use crate::words::*;

/// Exit codes of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// All passed, or the question was answered.
    Passed = 0,
    Failed = 1,
    /// The command or a script is wrong.
    Usage = 2,
    /// The bench, the link or the database does not work.
    Bench = 3,
    /// Stopped by the operator.
    Aborted = 130,
}

impl Exit {
    /// The number the shell sees.
    pub const fn code(self) -> u8 {
        self as u8
    }
}

/// Exit code of a command that answers with the verdict of a run.
impl From<Verdict> for Exit {
    fn from(verdict: Verdict) -> Self {
        match verdict {
            Verdict::Passed | Verdict::Skipped => Self::Passed,
            Verdict::Failed => Self::Failed,
            // Not all steps that a verdict on the unit takes were run.
            Verdict::Error | Verdict::Inconclusive => Self::Bench,
            Verdict::Aborted => Self::Aborted,
        }
    }
}

/// Trouble as data, with sentences in both languages. Its `Display` is the text of a command line.
#[derive(Clone, Debug)]
pub enum Trouble {
    Store(Arc<StoreError>),
    /// The history, in a file that was not named with `--db`.
    NamedStore(Arc<StoreError>),
    /// A run that the history does not hold.
    NotStored {
        run: Id,
        error: Arc<StoreError>,
        /// Number of the run's last traces, which are lost.
        left_out: usize,
        /// The file that has it; none if it is lost.
        kept: Option<PathBuf>,
    },
    /// The history did not become free: what was measured since is kept in a file.
    RestKept {
        error: Arc<StoreError>,
        rest: PathBuf,
    },
    /// The link to a unit that had been reached.
    Link(LinkTrouble),
    /// Trouble with sentences in the tables of words.
    Refused(Box<Refusal>),
    /// The option, file or entry at which it happened, and what happened: said in this order.
    Because(Box<[Self; 2]>),
    /// Several at once.
    All(Vec<Self>),
    Told(String),
}

impl Trouble {
    /// What is wrong with an instrument of the bench, if that is the trouble.
    pub fn of_the_bench(&self) -> Option<&LinkTrouble> {
        match self {
            Self::Refused(what) => match &**what {
                Refusal::NoUnit(NoUnit::BadBench(_, why)) => Some(why),
                _ => None,
            },
            _ => None,
        }
    }
}

impl Say for Trouble {
    fn say(&self, how: TextStyle) -> String {
        match self {
            Self::Store(error) => error.say(how),
            Self::NamedStore(error) if how == TextStyle::COMMAND_LINE => error.to_string(),
            Self::NamedStore(error) => error.say(TextStyle {
                commands: false,
                ..how
            }),
            Self::NotStored {
                run,
                error,
                left_out,
                kept,
            } => not_stored(how, *run, (&error.say(how), *left_out), kept.as_deref()),
            Self::RestKept { error, rest } => {
                let (why, rest) = (error.say(how), rest.display());
                let kept = format!("{why}; what was measured since is kept in {rest}");
                let kept_ko = format!(
                    "{why}. 그 후의 측정은 {rest}에 보관했으니 데이터베이스를 쓸 수 있게 되면"
                );
                match how.commands {
                    true => how.choose([
                        format!("{kept}: bring it in with `ptu db import {rest}` when the database is free"),
                        format!("{kept_ko} `ptu db import {rest}`(으)로 가져오십시오"),
                    ]),
                    false => how.choose([
                        format!("{kept}: import that file when the database is free"),
                        format!("{kept_ko} 그 파일을 가져오십시오"),
                    ]),
                }
            }
            Self::Link(why) => why.say(how),
            Self::Refused(what) => what.say(how),
            Self::Because(both) => joined(how, &**both, ": "),
            Self::All(all) => joined(how, all, "\n"),
            Self::Told(words) => words.clone(),
        }
    }
}

/// A run that the history does not hold, for this reason and without so many of its traces, and the file that has it.
fn not_stored(
    how: TextStyle,
    run: Id,
    (why, left_out): (&str, usize),
    kept: Option<&Path>,
) -> String {
    let run = run.short();
    let Some(kept) = kept.map(Path::display) else {
        return how.choose([
            format!("run {run} is not in the history, and lost: {why}"),
            format!("시험 {run}이(가) 이력에 없고 보관하지도 못했습니다: {why}"),
        ]);
    };
    let cut = match left_out {
        0 => String::new(),
        n => how.choose([
            format!("the last {n} of its traces are lost: "),
            format!("마지막 기록 {n}개 없음. "),
        ]),
    };
    let english = format!("run {run} is not in the history: {cut}{why}; it is kept in {kept}");
    let korean = format!("시험 {run}이(가) 이력에 없습니다: {cut}{why}. {kept}에 보관했으니");
    match how.commands {
        true => how.choose([
            format!("{english}: bring it in with `ptu db import {kept}`"),
            format!("{korean} `ptu db import {kept}`(으)로 가져오십시오"),
        ]),
        false => how.choose([
            format!("{english}: import that file"),
            format!("{korean} 그 파일을 가져오십시오"),
        ]),
    }
}

fn joined(how: TextStyle, all: &[impl Say], by: &str) -> String {
    let all: Vec<_> = all.iter().map(|one| one.say(how)).collect();
    all.join(by)
}

/// Finding for a run that could not begin or go on for this reason.
pub fn prevented_by(why: &impl Say) -> Finding {
    let said = |korean| {
        why.say(TextStyle {
            korean,
            ..TextStyle::COMMAND_LINE
        })
    };
    Finding::Prevented {
        english: said(false),
        korean: said(true),
    }
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.say(TextStyle::COMMAND_LINE))
    }
}

/// Each refusal is trouble.
macro_rules! refusals {
    ($($area:ident),*) => {
        $(impl From<$area> for Trouble {
            fn from(of: $area) -> Self {
                Self::Refused(Box::new(Refusal::$area(of)))
            }
        })*
    };
}
with_areas!(refusals);

impl From<NoUnit> for Failure {
    fn from(why: NoUnit) -> Self {
        Self::bench(why)
    }
}

/// An error for a person: what happened, to which thing, what to do next.
#[derive(Debug)]
pub struct Failure {
    pub exit: Exit,
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
    /// This failure, said after `what`: the option, file or entry at which it happened.
    #[must_use]
    pub fn because_of(self, what: impl Into<Trouble>) -> Self {
        let message = Trouble::Because(Box::new([what.into(), self.message]));
        Self { message, ..self }
    }

    /// All failures as one, which says each: for what is all to be done, whichever fails.
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
            | StoreError::NoWords(_)
            | StoreError::TextTooLong { .. }
            | StoreError::NotAFile(_)
            | StoreError::NotAServer(_)
            | StoreError::BadAddress(_)
            | StoreError::Transition { .. }
            | StoreError::TargetExists(_)
            | StoreError::SameFile(_)
            | StoreError::QueryRefused(_)
            | StoreError::QueryFailed(_)
            | StoreError::QueryExceeds(_) => Exit::Usage,
            _ => Exit::Bench,
        };
        Self {
            exit,
            message: Trouble::Store(Arc::new(error)),
        }
    }
}
