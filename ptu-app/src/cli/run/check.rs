//! `ptu run --check`: what scripts without errors still lack.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use btu_rig::procedure::Procedure;

use crate::cli::print_out;
use ptu_report::without_korean;
use ptu_report::words::{Words, fill};
use ptu_runs::failure::{Exit, Failure};
use ptu_runs::places::Places;
use ptu_runs::stdio;

/// Prints limits without a source and texts without Korean as notes, and the number of each.
pub(super) fn show(
    procedures: &[Arc<Procedure>],
    data_files: usize,
    fitted: Option<(&Places, Vec<Arc<Procedure>>)>,
) -> Result<Exit, Failure> {
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
    let of = [
        ("procedures", &procedures.len() as _),
        ("steps", &steps as _),
        ("files", &data_files as _),
    ];
    let checked = fill(terminal.checked, &of);
    let bench = fitted.map_or_else(String::new, |(bench, fitted)| {
        format!("\n{}", of_bench(bench, &fitted))
    });
    print_out(&format!("{checked}; {found}; {english}{bench}"))
}

/// Prints the steps that a bench cannot do as notes, and returns a sentence with the number it can do.
fn of_bench(bench: &Places, fitted: &[Arc<Procedure>]) -> String {
    let terminal = &Words::shown().terminal;
    let (mut all, mut left_out) = (0, 0);
    for procedure in fitted {
        let mut reasons: BTreeMap<_, usize> = BTreeMap::new();
        for step in &procedure.steps {
            if let Some(why) = procedure.lacks.as_ref().or(step.lacks.as_ref()) {
                *reasons.entry(why).or_default() += 1;
            }
        }
        let of = procedure.steps.len();
        for (why, n) in reasons {
            left_out += n;
            let said = [
                ("procedure", &procedure.id as _),
                ("n", &n as _),
                ("of", &of as _),
                ("why", why as _),
            ];
            stdio::note(&fill(terminal.bench_leaves_out, &said));
        }
        all += of;
    }
    let does = all - left_out;
    let said = [
        ("bench", &bench.name as _),
        ("n", &does as _),
        ("of", &all as _),
    ];
    fill(terminal.bench_checked, &said)
}
