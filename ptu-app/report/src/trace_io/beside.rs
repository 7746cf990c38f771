//! A file's signals beside those of a stored trace, and by which rule the two are compared.

use std::path::Path;

use fault_db::{Id, Store, TraceData};

use super::align::{Aligned, align};
use super::series::import;
use super::times::Columns;
use ptu_runs::failure::{Asked, Failure};
use ptu_runs::replay::{Rule, rule_between};

/// Names that are told of a file that has none of the trace's signals.
const SHOWN_NAMES: usize = 10;

/// Reads a file, as was `asked`, and lays it `shift_us` later beside the trace `id`, whose samples are `came`.
///
/// # Errors
/// The file cannot be read, or has no signal or no time in common with the trace.
pub fn beside(
    store: &Store,
    (id, came): (Id, TraceData),
    file: &Path,
    shift_us: i64,
    asked: &Columns,
) -> Result<(Aligned, Rule), Failure> {
    let import = import(file, &came.channels, asked)?;
    let aligned = align(import, came, shift_us)?;
    // Nothing compared must not look like nothing that differs.
    if aligned.imported.channels.is_empty() {
        let more = match aligned.unknown.len().saturating_sub(SHOWN_NAMES) {
            0 => String::new(),
            more => format!(" (+{more})"),
        };
        let shown: Vec<_> = (aligned.unknown.iter().take(SHOWN_NAMES))
            .map(String::as_str)
            .collect();
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
