//! Loads check procedures: Starlark scripts in, typed plans or errors out.
//!
//! Layers, bottom up:
//! * `quantity`, `item`: the values of the script language, free of Starlark;
//! * `verb`, `param_type`, `args`, `verbs`: the verbs of the language, each a table entry with typed parameters;
//! * `context`, `amounts`, `globals`: unit configuration, line, signals: the names a script knows;
//! * `stubs`: these names and the verbs, for editors;
//! * `handle`: the values of the language inside Starlark;
//! * `nesting`, `check`: find errors without running a script, also in code that would never run;
//! * `evaluate`: runs a script once, within bounds, with no access to anything but its libraries;
//! * `assemble`: resolves names between steps and computes times;
//! * `error`: what is wrong, where, in plain words.

mod amounts;
mod args;
mod assemble;
mod check;
mod context;
mod draft;
mod error;
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

use super::plan::Procedure;
use crate::train::TrainData;
use context::Context;
use evaluate::Evaluation;

pub use error::LoadError;
pub use evaluate::is_library;
pub use stubs::stubs;

/// Script texts by path under the scripts folder, with `/` between names.
pub type Scripts = BTreeMap<String, String>;

/// Most errors reported for one file: the rest is usually a consequence.
const MOST_ERRORS: usize = 50;

/// Result of loading scripts.
#[derive(Clone, Debug, Default)]
pub struct Loaded {
    /// The procedures of all scripts without errors, by path.
    pub procedures: Vec<Arc<Procedure>>,
    /// All errors of all scripts, by path and line.
    pub errors: Vec<LoadError>,
    /// Names of the procedures that cannot test a train without cars.
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
/// Files whose names start with `_` are libraries for `load()`; every other file is one procedure. A procedure that
/// cannot be read for a train that is a point mass, but can for a train of cars, needs cars: it is no error, and
/// is listed in [`Loaded::need_cars`].
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
    let evaluates = |path: &str| on_event.borrow_mut()(LoadEvent::Evaluates(path));
    let context = Context::new(unit.clone(), line.clone(), train.clone());
    let evaluation = Evaluation::new(scripts, &context, &evaluates);
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
