//! Procedures that an earlier run left open, to be run as a new one.

use std::collections::BTreeMap;

use fault_db::{RunDetail, Verdict};

use crate::stored::{of_procedure, outside_of};
use btu_rig::procedure::Outside;

/// Which procedures of an earlier run are run again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unfinished {
    /// Procedures without a verdict: stopped, interrupted or not begun.
    WithoutVerdict,
    /// Procedures that could not be tested.
    Errors,
}

/// Paths of the scripts whose procedures the run left in this state, in the order of its list of scripts.
///
/// No row says that a procedure came to its end; only rows of the next procedure show it. So the last procedure of a
/// run that was interrupted has no verdict, whatever verdicts its steps have.
pub fn unfinished(run: &RunDetail, which: Unfinished) -> Vec<String> {
    let mut records = BTreeMap::new();
    for records_of_one in run.steps.chunk_by(|a, b| a.procedure == b.procedure) {
        records.insert(records_of_one[0].procedure.as_str(), records_of_one);
    }
    let last = run.steps.last().map(|step| step.procedure.as_str());
    let broken_off = last.filter(|_| run.run.verdict.is_none());
    let state = |procedure: &str| {
        let records = records
            .get(procedure)
            .filter(|_| broken_off != Some(procedure))?;
        let not_begun = |r| outside_of(r) == Some(Outside::NotBegun);
        match of_procedure(records.iter(), run.run.verdict) {
            Verdict::Aborted => None,
            _ if records.iter().all(not_begun) => None,
            verdict => Some(verdict),
        }
    };
    let is_wanted = |path: &str| {
        let verdict = state(path.strip_suffix(".star").unwrap_or(path));
        match which {
            Unfinished::WithoutVerdict => verdict.is_none(),
            Unfinished::Errors => verdict == Some(Verdict::Error),
        }
    };
    let paths = run.scripts.iter().map(|script| script.path.clone());
    paths.filter(|path| is_wanted(path)).collect()
}
