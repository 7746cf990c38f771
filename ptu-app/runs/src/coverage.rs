//! How much of what was due was run: what a verdict stands for where steps were not run.

use std::collections::BTreeSet;

use btu_rig::procedure::Findings;
use fault_db::{RunDetail, RunSummary, StepCounts, Verdict};

use crate::run::Evidence;
use crate::stored::findings;

/// The one count of a stored run: what its steps came to, of all that were due.
pub fn counts_of(run: &RunSummary) -> StepCounts {
    let evidence = run.evidence.as_deref().and_then(Evidence::of);
    let due = evidence.map_or(0, |evidence| evidence.planned);
    StepCounts {
        planned: run.recorded.planned.max(due),
        ..run.recorded
    }
}

/// Steps of scripts, and why some were not run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Coverage {
    /// How many of the steps were due, passed, failed and so on.
    pub steps: StepCounts,
    /// Steps skipped because they need the bench harness.
    pub need_bench: u32,
    /// Folders of the procedures that do.
    pub on_bench: BTreeSet<String>,
}

impl Coverage {
    /// Of a stored run.
    pub fn of_run(run: &RunDetail) -> Self {
        let steps = run.steps.iter();
        let skipped = steps.filter(|step| step.verdict == Verdict::Skipped);
        let found = skipped.map(|step| (&*step.procedure, step.place, findings(&step.findings)));
        Self::of(counts_of(&run.run), found)
    }

    /// Of these counts; `skipped` = procedure, place and reason of each step that was skipped.
    pub fn of<'a>(
        steps: StepCounts,
        skipped: impl Iterator<Item = (&'a str, Option<u32>, Findings)>,
    ) -> Self {
        let on_bench =
            skipped.filter(|(_, _, why)| why.iter().any(|why| why.finding.needs_harness()));
        let on_bench: BTreeSet<_> = on_bench
            .map(|(procedure, place, _)| (procedure, place))
            .collect();
        let folder = |procedure: &str| procedure.split('/').next().unwrap_or(procedure).to_owned();
        Self {
            steps,
            need_bench: on_bench.len() as u32,
            on_bench: on_bench
                .iter()
                .map(|(procedure, _)| folder(procedure))
                .collect(),
        }
    }
}
