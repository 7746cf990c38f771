//! `ptu run --check`: what of scripts without errors is still to be done.

use std::collections::BTreeSet;
use std::sync::Arc;

use btu_rig::procedure::Procedure;

use crate::cli::print_out;
use ptu_report::without_korean;
use ptu_runs::failure::{Exit, Failure};
use ptu_runs::stdio;

/// Limits without a source and texts without Korean as notes, and how many there are.
pub(super) fn show(procedures: &[Arc<Procedure>], data_files: usize) -> Result<Exit, Failure> {
    let steps: usize = (procedures.iter())
        .map(|procedure| procedure.steps.len())
        .sum();
    let found: Vec<_> = procedures.iter().flat_map(|p| p.without_source()).collect();
    found.iter().for_each(|finding| stdio::note(finding));
    let found = match found.len() {
        0 => "each limit names its source".to_owned(),
        n => format!("{n} limits name no source"),
    };
    let english: BTreeSet<_> = procedures.iter().flat_map(|p| without_korean(p)).collect();
    let note = |text: &String| stdio::note(&format!("no Korean in korean.toml: \"{text}\""));
    english.iter().for_each(note);
    let english = match english.len() {
        0 => "each text has its Korean".to_owned(),
        1 => "1 text has no Korean".to_owned(),
        n => format!("{n} texts have no Korean"),
    };
    print_out(&format!(
        "{} procedures, {steps} steps, {data_files} data files, no errors; {found}; {english}",
        procedures.len()
    ))
}
