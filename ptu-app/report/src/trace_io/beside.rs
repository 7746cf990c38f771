//! A file's signals beside those of a stored trace, and by which rule the two are compared.

use std::path::Path;

use fault_db::{Id, Store, TraceData};

use super::align::{Aligned, align};
use super::known::OWN;
use super::series::import;
use super::times::Columns;
use ptu_runs::failure::{Asked, Failure, Unknown, did_you_mean};
use ptu_runs::replay::{Rule, rule_between};

/// Most names of a file's signals that are told where the file has none of the trace's signals.
const SHOWN_NAMES: usize = 10;

/// Reads a file, as was `asked`, and lays it `shift_us` later beside the trace `id`, whose samples are `came`.
///
/// # Errors
/// The file cannot be read, or has no signal or no time in common with the trace; `asked` names a signal that the trace
/// has not, or a column that the file has not; or the database fails.
pub fn beside(
    store: &Store,
    (id, came): (Id, TraceData),
    file: &Path,
    shift_us: i64,
    asked: &Columns,
) -> Result<(Aligned, Rule), Failure> {
    let known: Vec<_> = came.channels.iter().map(|c| c.name.clone()).collect();
    let near = |name: &str| did_you_mean(name, known.iter().map(String::as_str));
    let import = import(file, &came.channels, asked)?;
    for (heading, signal) in &asked.names {
        if !known.contains(signal) {
            let unknown = Unknown::Signal(signal.clone(), near(signal));
            return Err(Failure::usage(unknown));
        }
        let mut has = import.tables.iter().flat_map(|table| &table.channels);
        if !has.any(|channel| channel.name == *signal) {
            let names = import.tables.iter().flat_map(|table| &table.channels);
            let names = names.map(|channel| channel.name.trim_end_matches(OWN));
            let near = did_you_mean(heading, names);
            let file = file.display().to_string();
            return Err(Failure::usage(Asked::NoColumn(file, heading.clone(), near)));
        }
    }
    let aligned = align(import, came, shift_us)?;
    // Nothing compared must not look like nothing that differs.
    if aligned.imported.channels.is_empty() {
        let more = match aligned.unknown.len().saturating_sub(SHOWN_NAMES) {
            0 => String::new(),
            more => format!(" (+{more})"),
        };
        let shown = aligned.unknown.iter().take(SHOWN_NAMES);
        let shown: Vec<_> = shown.map(|name| format!("{name}{}", near(name))).collect();
        let names = shown.join(", ") + &more;
        return Err(Failure::usage(Asked::NoneShared(
            file.display().to_string(),
            names,
        )));
    }
    let rule = if aligned.is_row_by_row {
        rule_between(store, id, id)?
    } else {
        Rule::wall_clock()
    };
    Ok((aligned, rule))
}
