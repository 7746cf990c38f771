//! What is wrong with a script: where, and in words that a technician understands.

use serde::{Deserialize, Serialize};
use starlark::ErrorKind;
use starlark::codemap::FileSpan;
use thiserror::Error;

/// Longest text of an error or a printed line, characters: a script may make the text as long as it likes.
const LONGEST_TEXT: usize = 2000;

/// What is wrong with a script, and where.
#[derive(Clone, Debug, PartialEq, Eq, Error, Serialize, Deserialize)]
#[error("{file}:{line}:{column}: {message}")]
pub struct LoadError {
    /// Path under the scripts folder.
    pub file: String,
    /// Line, from 1.
    pub line: u32,
    /// Column, from 1.
    pub column: u32,
    /// What is wrong, with a hint where there is one.
    pub message: String,
}

impl LoadError {
    pub(super) fn new(file: &str, line: u32, column: u32, message: &str) -> Self {
        Self {
            file: file.to_owned(),
            line,
            column,
            message: cut(message),
        }
    }

    /// An error of the whole script, told at its beginning.
    pub(super) fn at_top(file: &str, message: &str) -> Self {
        Self::new(file, 1, 1, message)
    }

    pub(super) fn at(place: &FileSpan, message: &str) -> Self {
        let begin = place.resolve_span().begin;
        let (line, column) = (begin.line as u32 + 1, begin.column as u32 + 1);
        Self::new(place.filename(), line, column, message)
    }

    /// An error that Starlark found in the script at `path`, or in a library that the script calls.
    pub(super) fn of_starlark(path: &str, error: &starlark::Error) -> Self {
        let words = match error.kind() {
            ErrorKind::StackOverflow(_) => {
                "functions call each other too deeply; does one call itself?".to_owned()
            }
            _ => plain_words(&error.without_diagnostic().to_string()),
        };
        let message = words + &caller(path, error).unwrap_or_default();
        match error.span() {
            Some(span) => Self::at(span, &message),
            None => Self::at_top(path, &message),
        }
    }
}

/// The text, or its beginning.
pub(super) fn cut(text: &str) -> String {
    match text.char_indices().nth(LONGEST_TEXT) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// Where the script calls the library in which the error is.
fn caller(path: &str, error: &starlark::Error) -> Option<String> {
    if error.span()?.filename() == path {
        return None;
    }
    let mut frames = error.call_stack().frames.iter().rev();
    frames.find_map(|frame| {
        let at = frame.location.as_ref().filter(|at| at.filename() == path)?;
        let begin = at.resolve_span().begin;
        let (line, column) = (begin.line + 1, begin.column + 1);
        Some(format!(
            " — {}() is called at {path}:{line}:{column}",
            frame.name
        ))
    })
}

/// Says in plain words Starlark's messages about limits, which have no error kind of their own.
fn plain_words(message: &str) -> String {
    let first = message.lines().next().unwrap_or_default();
    if first.starts_with("Heap memory limit") {
        "needs too much memory while it is loaded; does a loop go too far?".into()
    } else if first.contains("tick") && first.contains("limit") {
        "does too much while it is loaded; does a loop go too far?".into()
    } else {
        first.to_owned()
    }
}
