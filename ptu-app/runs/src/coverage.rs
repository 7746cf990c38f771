//! Coverage of a run: the due steps that were run. It qualifies a verdict where steps were not run.

use std::collections::BTreeSet;

use fault_db::{RunDetail, RunSummary, StepCounts, Verdict};

use crate::run::Evidence;
use crate::stored::findings;

/// The counts of a stored run: its steps by verdict, and all that were due.
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
    /// Folders of the procedures with such steps.
    pub on_bench: BTreeSet<String>,
}

impl Coverage {
    pub fn of_run(run: &RunDetail) -> Self {
        let skipped = run
            .steps
            .iter()
            .filter(|step| step.verdict == Verdict::Skipped);
        let on_bench = skipped.filter(|step| findings(&step.findings).need_harness());
        let on_bench = on_bench.map(|step| (&*step.procedure, step.place));
        Self::of(counts_of(&run.run), on_bench)
    }

    /// Coverage of a run with these counts; `on_bench` = procedure and place of each step that was skipped because
    /// it needs the bench harness.
    pub fn of<'a>(
        steps: StepCounts,
        on_bench: impl Iterator<Item = (&'a str, Option<u32>)>,
    ) -> Self {
        let on_bench: BTreeSet<_> = on_bench.collect();
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
