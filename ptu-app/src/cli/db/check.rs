//! `ptu db check`: checks that the file is intact and that its content is what was recorded.

use std::path::{Path, PathBuf};

use fault_db::{Advice, CheckReport, ProblemKind, Store, StoreError};

use crate::cli::{Database, Json, answered};
use ptu_report::care;
use ptu_report::words::{Language, Words, fill};
use ptu_runs::clock;
use ptu_runs::failure::{Exit, Failure, FileTrouble, Trouble};
use ptu_runs::table::Table;

pub(super) fn check(database: &Database, json: Json) -> Result<Exit, Failure> {
    let report = match database.open_read_only() {
        Err(failure) if has_older_schema(database) => check_updated_copy(database, failure)?,
        store => store?.check()?,
    };
    let found = || match report.problems.is_empty() {
        true => {
            let of = [("traces", &report.traces as _), ("runs", &report.runs as _)];
            fill(Words::shown().care.sound, &of)
        }
        false => text(&report),
    };
    let told = json.answer(|| &report, || found() + &besides(&report));
    let exit = match report.problems.is_empty() {
        true => Exit::Passed,
        false => Exit::Bench,
    };
    answered(told, exit)
}

/// Whether the database is a file of an earlier version, which can be read only once it is brought up to date.
fn has_older_schema(database: &Database) -> bool {
    let opened = database.file().map(|path| Store::open_read_only(&path));
    matches!(opened, Ok(Err(StoreError::OlderSchema { .. })))
}

/// Brings a copy of the file up to date and checks the copy; the file is not changed. Bringing up to date changes
/// nothing that the seals cover.
fn check_updated_copy(database: &Database, failure: Failure) -> Result<CheckReport, Failure> {
    let path = database.file()?;
    let cannot = |error: std::io::Error| {
        let copy = FileTrouble::NotCopied(error.to_string()).into();
        Failure::bench(Trouble::All(vec![failure.message.clone(), copy]))
    };
    let folder = tempfile::tempdir().map_err(cannot)?;
    let copy = folder.path().join("copy.db");
    std::fs::copy(&path, &copy).map_err(cannot)?;
    let beside = |path: &Path, end: &str| {
        let mut name = path.as_os_str().to_owned();
        name.push(end);
        PathBuf::from(name)
    };
    if beside(&path, "-wal").exists() {
        std::fs::copy(beside(&path, "-wal"), beside(&copy, "-wal")).map_err(cannot)?;
    }
    let store = Store::open(&copy, clock::open_options())?;
    let mut report = store.check()?;
    store.close()?;
    report.remarks.push(fill(
        Words::shown().care.older_version,
        &[("file", &path.display())],
    ));
    Ok(report)
}

/// Text below the result: remarks of the check, and the last entry of the chain of seals.
fn besides(report: &CheckReport) -> String {
    let remarks = report.remarks.iter().map(|remark| format!("\n{remark}"));
    let head = report
        .head
        .as_ref()
        .map(|head| care::chain(head, Words::shown()));
    remarks
        .chain(head.map(|head| format!("\n{head}")))
        .collect()
}

/// Table of all problems, with advice once for each kind of problem.
fn text(report: &CheckReport) -> String {
    let words = Words::shown();
    let mut table = Table::headed(&[words.terminal.kind, words.report.what]);
    let mut advice: Vec<(ProblemKind, Advice)> = Vec::new();
    for problem in &report.problems {
        let kind = words.problem_kind(problem.kind).to_owned();
        table.row([kind, words.trouble(&problem.detail)]);
        let next = (problem.kind, problem.advice);
        if !advice.contains(&next) {
            advice.push(next);
        }
    }
    let lines: String = advice
        .iter()
        .map(|(kind, next)| {
            let kind = words.problem_kind(*kind);
            let next = match words.language {
                Language::English => next.to_string(),
                Language::Korean => words.advice(*next).to_owned(),
            };
            format!("\n{kind}: {next}")
        })
        .collect();
    format!("{}\n{lines}", table.render())
}
