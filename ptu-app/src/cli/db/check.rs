//! `ptu db check`: checks that the file is intact and that its content is what was recorded.

use fault_db::{CheckReport, SealHead};

use crate::cli::{Database, answered, print_json, print_out};
use ptu_bench::failure::{Exit, Failure};
use ptu_bench::table::Table;

impl Database {
    pub(super) fn check(&self, json: bool) -> Result<Exit, Failure> {
        let report = self.open_read_only()?.check()?;
        let told = if json {
            print_json(&report)
        } else if report.problems.is_empty() {
            print_out(&format!(
                "no damage; {} traces read, {} runs fit their seals{}",
                report.traces,
                report.runs,
                besides(&report)
            ))
        } else {
            print_out(&(text(&report) + &besides(&report)))
        };
        let exit = match report.problems.is_empty() {
            true => Exit::Passed,
            false => Exit::Bench,
        };
        answered(told, exit)
    }
}

/// What is to be known besides, and where the chain of seals ends.
fn besides(report: &CheckReport) -> String {
    let remarks = report.remarks.iter().map(|remark| format!("\n{remark}"));
    let head = report.head.as_ref().map(sealed);
    remarks
        .chain(head.map(|head| format!("\n{head}")))
        .collect()
}

/// Where a chain of seals ends, to be written down and compared.
pub(super) fn sealed(head: &SealHead) -> String {
    let SealHead {
        file,
        entries,
        seal,
    } = head;
    format!(
        "chain of seals: {entries} entries of database {}, the last {seal}",
        file.short()
    )
}

/// All problems, and once for each kind what to do about it.
fn text(report: &CheckReport) -> String {
    let mut table = Table::new(&["KIND", "WHAT"]);
    let mut advice: Vec<(&str, &str)> = Vec::new();
    for problem in &report.problems {
        table.row([problem.kind.into(), problem.detail.clone()]);
        let next = (problem.kind, problem.advice);
        if !advice.contains(&next) {
            advice.push(next);
        }
    }
    let lines: String = advice
        .iter()
        .map(|(kind, next)| format!("\n{kind}: {next}"))
        .collect();
    format!("{}\n{lines}", table.render())
}
