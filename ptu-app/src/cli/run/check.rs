//! `ptu run --check`: what of scripts without errors is still to be done.

use std::collections::BTreeSet;
use std::sync::Arc;

use btu_rig::procedure::Procedure;

use crate::cli::print_out;
use ptu_report::without_korean;
use ptu_report::words::{Words, fill};
use ptu_runs::failure::{Exit, Failure};
use ptu_runs::stdio;

/// Limits without a source and texts without Korean as notes, and how many there are.
pub(super) fn show(procedures: &[Arc<Procedure>], data_files: usize) -> Result<Exit, Failure> {
    let steps: usize = (procedures.iter())
        .map(|procedure| procedure.steps.len())
        .sum();
    let found: Vec<_> = procedures.iter().flat_map(|p| p.without_source()).collect();
    found.iter().for_each(|finding| stdio::note(finding));
    let terminal = &Words::shown().terminal;
    let counted = |none: &str, some, n: usize| match n {
        0 => none.to_owned(),
        n => fill(some, &[("n", &n)]),
    };
    let found = counted(terminal.each_sourced, terminal.unsourced, found.len());
    let english: BTreeSet<_> = procedures.iter().flat_map(|p| without_korean(p)).collect();
    let note = |text: &String| stdio::note(&fill(terminal.no_korean, &[("text", text)]));
    english.iter().for_each(note);
    let (each, some) = (terminal.each_korean, terminal.without_korean);
    let english = counted(each, some, english.len());
    let checked = fill(
        terminal.checked,
        &[
            ("procedures", &procedures.len()),
            ("steps", &steps),
            ("files", &data_files),
        ],
    );
    print_out(&format!("{checked}; {found}; {english}"))
}
