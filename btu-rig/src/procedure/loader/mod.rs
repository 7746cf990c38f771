//! Loads check procedures: Starlark scripts in, typed plans or errors out.
//!
//! Layers, bottom up:
//! * `quantity`, `item`: the values of the script language, free of Starlark;
//! * `verb`, `param_type`, `args`, `verbs`: its verbs, each a table entry with typed parameters;
//! * `context`, `amounts`, `globals`: unit configuration, line, signals: the names a script knows; `stubs`: the same for editors;
//! * `handle`: those values inside Starlark;
//! * `nesting`, `check`: find errors without running a script, also where it would never run;
//! * `evaluate`: runs it once, within bounds, with no access to anything but its libraries;
//! * `assemble`: resolves names between steps and computes times.

mod amounts;
mod args;
mod assemble;
mod check;
mod context;
mod draft;
mod evaluate;
mod globals;
mod handle;
mod item;
mod nesting;
mod param_type;
mod quantity;
mod stubs;
mod suggest;
mod verb;
mod verbs;

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use protocol::config::UnitConfig;
use protocol::line::Line;
use serde::{Deserialize, Serialize};
use starlark::ErrorKind;
use starlark::codemap::FileSpan;
use thiserror::Error;

use super::plan::Procedure;
use crate::train::TrainData;
use context::Context;
use evaluate::Evaluation;

pub use stubs::stubs;

/// Script texts by path under the scripts folder, with `/` between names.
pub type Scripts = BTreeMap<String, String>;

/// Most steps one script may declare.
pub const MOST_STEPS: usize = 10_000;
/// Most errors reported for one file: the rest is usually a consequence.
const MOST_ERRORS: usize = 50;
/// Longest text of an error or a printed line, characters: a script may make it of anything.
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

/// Result of loading scripts.
#[derive(Clone, Debug, Default)]
pub struct Loaded {
    /// The procedures of all scripts without errors, by path.
    pub procedures: Vec<Arc<Procedure>>,
    /// All errors of all scripts, by path and line.
    pub errors: Vec<LoadError>,
    /// Procedures, by name, that a train without cars cannot be tested by.
    pub need_cars: Vec<String>,
    pub printed: Vec<String>,
}

/// Progress while scripts are loaded.
#[derive(Debug)]
pub enum LoadEvent<'a> {
    /// The script of this path is being evaluated from now on.
    Evaluates(&'a str),
    Loaded(Box<Procedure>),
}

/// Loads all `scripts` for a unit of type `unit` on `line` in `train`.
///
/// Files whose names start with `_` are libraries for `load()`; every other is one procedure. One that
/// cannot be read for a train that is a point mass, and can for a train of cars, needs cars: it is no error
/// but is set apart.
///
/// Calls, loops and small values are bounded here; what one built-in word of the language makes of a few
/// characters (`[0] * 10**9`) is not. Scripts that may be hostile are loaded in a process with limits.
pub fn load(scripts: &Scripts, unit: &UnitConfig, line: &Line, train: &TrainData) -> Loaded {
    let mut procedures = Vec::new();
    let loaded = load_each(scripts, unit, line, train, &mut |event| {
        if let LoadEvent::Loaded(procedure) = event {
            procedures.push(Arc::new(*procedure));
        }
    });
    Loaded {
        procedures,
        ..loaded
    }
}

/// As [`load`], but each procedure is passed on as soon as it is loaded: many scripts take no more
/// memory than one.
pub fn load_each(
    scripts: &Scripts,
    unit: &UnitConfig,
    line: &Line,
    train: &TrainData,
    on_event: &mut dyn FnMut(LoadEvent<'_>),
) -> Loaded {
    let mut loaded = load_for(scripts, unit, line, train, on_event);
    if matches!(train, TrainData::Ideal(_)) && !loaded.errors.is_empty() {
        let mut readable = Vec::new();
        let with_cars = load_for(
            scripts,
            unit,
            line,
            &TrainData::line6(),
            &mut |event| match event {
                LoadEvent::Evaluates(_) => on_event(event),
                LoadEvent::Loaded(procedure) => readable.push((procedure.path, procedure.id)),
            },
        );
        let wrong: BTreeSet<_> = with_cars.errors.iter().map(|e| e.file.as_str()).collect();
        let (errors, only_here): (Vec<_>, Vec<_>) = std::mem::take(&mut loaded.errors)
            .into_iter()
            .partition(|error| wrong.contains(error.file.as_str()));
        loaded.errors = errors;
        let files: BTreeSet<_> = only_here.into_iter().map(|error| error.file).collect();
        loaded.need_cars = (readable.into_iter())
            .filter(|(path, _)| files.contains(path))
            .map(|(_, id)| id)
            .collect();
    }
    loaded
}

fn load_for(
    scripts: &Scripts,
    unit: &UnitConfig,
    line: &Line,
    train: &TrainData,
    on_event: &mut dyn FnMut(LoadEvent<'_>),
) -> Loaded {
    let on_event = RefCell::new(on_event);
    let context = Context::new(unit.clone(), line.clone(), train.clone());
    let predeclared = globals::predeclared(&context);
    let globals = globals::build(&predeclared);
    let names = globals::names(&globals);
    let evaluates = |path: &str| on_event.borrow_mut()(LoadEvent::Evaluates(path));
    let evaluation = Evaluation::new(
        scripts,
        &context,
        &predeclared,
        &names,
        &globals,
        &evaluates,
    );
    let mut loaded = Loaded::default();
    for (path, text) in scripts {
        if is_library(path) {
            // Errors of a library are kept aside, so that each is reported once.
            let _ = evaluation.library(path);
            continue;
        }
        let procedure = evaluation
            .procedure(path, text)
            .and_then(|declared| assemble::assemble(path, text, declared));
        match procedure {
            Ok(procedure) => on_event.borrow_mut()(LoadEvent::Loaded(Box::new(procedure))),
            Err(errors) => loaded.errors.extend(errors.into_iter().take(MOST_ERRORS)),
        }
    }
    let (library_errors, printed) = evaluation.finish();
    loaded.errors.extend(library_errors);
    loaded.errors.sort_by(|a, b| {
        (&a.file, a.line, a.column, &a.message).cmp(&(&b.file, b.line, b.column, &b.message))
    });
    loaded.errors.dedup();
    loaded.printed = printed;
    loaded
}

/// Whether the script of this path is a library for `load()` and no procedure.
pub fn is_library(path: &str) -> bool {
    path.rsplit('/')
        .next()
        .is_some_and(|name| name.starts_with('_'))
}

fn error_at(place: &FileSpan, message: String) -> LoadError {
    let begin = place.resolve_span().begin;
    LoadError {
        file: place.filename().to_owned(),
        line: begin.line as u32 + 1,
        column: begin.column as u32 + 1,
        message: cut(&message),
    }
}

/// The text, or its beginning.
fn cut(text: &str) -> String {
    match text.char_indices().nth(LONGEST_TEXT) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

fn error_from(path: &str, error: &starlark::Error) -> LoadError {
    let words = match error.kind() {
        ErrorKind::StackOverflow(_) => {
            "functions call each other too deeply; does one call itself?".to_owned()
        }
        _ => plain_words(&error.without_diagnostic().to_string()),
    };
    let caller = caller(path, error).unwrap_or_default();
    let message = cut(&format!("{words}{caller}"));
    match error.span() {
        Some(span) => error_at(span, message),
        None => LoadError {
            file: path.to_owned(),
            line: 1,
            column: 1,
            message,
        },
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

/// Starlark's messages are for programmers; those of limits, which have no kind of their own, are said in plain words.
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
