//! `ptu run --list`: what would be run, in words or as JSON.

use btu_rig::procedure::plan::Connection;
use btu_rig::procedure::{Finding, Procedure};
use btu_rig::rig::Harness;
use serde_json::json;

use super::{print_json, print_out};
use ptu_report::words::{Words, fill};
use ptu_runs::failure::{Exit, Failure};
use ptu_runs::run::Task;
use ptu_runs::table::Table;

/// Prints what would be run.
pub fn show(tasks: &[Task], harness: Harness, json: bool, whole: bool) -> Result<Exit, Failure> {
    if json {
        let listed = |task| listed(task, harness);
        return print_json(&tasks.iter().map(listed).collect::<Vec<_>>());
    }
    if !whole {
        return print_out(&overview(tasks, harness));
    }
    let described = |task| described(task, harness);
    let lines: Vec<String> = tasks.iter().flat_map(described).collect();
    print_out(&lines.join("\n"))
}

/// Reason why a procedure will be skipped, as far as the reason is known before the unit is reached.
fn skipped(procedure: &Procedure, harness: Harness) -> Option<Finding> {
    match harness {
        Harness::None => procedure.needs.lacks(Connection::Ptu),
        Harness::Auto | Harness::Bench => None,
    }
}

/// Table with a line for each procedure.
fn overview(tasks: &[Task], harness: Harness) -> String {
    let words = Words::shown();
    let terminal = &words.terminal;
    let (procedure, title) = (words.common.procedure, terminal.title);
    let mut table =
        Table::headed(&[procedure, terminal.steps, terminal.at_most, title]).right([1, 2]);
    for Task { procedure, options } in tasks {
        let steps = options
            .chosen
            .as_ref()
            .map_or(procedure.steps.len(), |chosen| chosen.len());
        let title = match skipped(procedure, harness) {
            Some(why) => fill(terminal.skipped, &[("why", &words.short_finding(&why))]),
            None => words.title(procedure).to_owned(),
        };
        let most = format!("{:.0} s", procedure.worst_case().as_secs());
        table.row([procedure.id.clone(), steps.to_string(), most, title]);
    }
    table.render()
}

/// The plan in words, with the chosen steps only.
fn described(task: &Task, harness: Harness) -> Vec<String> {
    if let Some(why) = skipped(&task.procedure, harness) {
        return vec![format!("{}: skipped, {why}", task.procedure.id)];
    }
    let mut procedure = (*task.procedure).clone();
    if let Some(chosen) = &task.options.chosen {
        let steps = std::mem::take(&mut procedure.steps).into_iter().enumerate();
        procedure.steps = steps
            .filter(|(index, _)| chosen.contains(index))
            .map(|(_, step)| step)
            .collect();
    }
    procedure.describe()
}

fn listed(task: &Task, harness: Harness) -> serde_json::Value {
    let procedure = &task.procedure;
    let chosen = |index: &usize| {
        task.options
            .chosen
            .as_ref()
            .is_none_or(|chosen| chosen.contains(index))
    };
    let steps: Vec<_> = procedure
        .steps
        .iter()
        .enumerate()
        .filter(|(index, _)| chosen(index))
        .map(|(_, step)| {
            json!({
                "name": step.name, "line": step.line, "repeat": step.repeat,
                "worst_case_s": step.worst_case.as_secs(), "note": step.note,
                "limit_source": step.origin.text(),
                "measurements": step.measures.iter().map(|measure| json!({
                    "name": measure.name, "limit_source": measure.origin.text(),
                })).collect::<Vec<_>>(),
            })
        })
        .collect();
    json!({
        "procedure": procedure.id, "title": procedure.title, "title_ko": procedure.title_ko,
        "needs": procedure.needs.word(), "skipped": skipped(procedure, harness).map(|why| why.to_string()),
        "on_request": procedure.on_request, "sha256": procedure.sha256, "worst_case_s": procedure.worst_case().as_secs(),
        "steps": steps,
    })
}
