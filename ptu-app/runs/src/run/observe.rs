//! Gathers the observations for a diagnosis, from a live stream of events or from a stored run, with the same
//! result.

use std::collections::BTreeSet;

use btu_rig::procedure::{RunEvent, StepResult};
use diagnosis::{CheckName, Observation, ObservedStep, Sign, is_observed};
use fault_db::{RunDetail, RunOccurrence, StepRecord};
use protocol::{Verdict, lru};

use super::event::SessionEvent;
use super::fault_watch::{CHECK_FAILED, FaultSeen};
use crate::stored::{findings, from_stored, outside_of};

/// Gathers the steps of a procedure, each with the signs that showed since the one before.
#[derive(Debug)]
pub struct ObservationBuilder {
    procedure: String,
    waiting: BTreeSet<Sign>,
    steps: Vec<ObservedStep>,
}

impl ObservationBuilder {
    /// Observation of the procedure called `procedure`.
    pub fn new(procedure: &str) -> Self {
        Self {
            procedure: procedure.to_owned(),
            waiting: BTreeSet::new(),
            steps: Vec::new(),
        }
    }

    /// Takes one event; returns the step that the event ends.
    pub fn take(&mut self, event: &SessionEvent) -> Option<&ObservedStep> {
        match event {
            SessionEvent::Fault(fault) => {
                self.waiting.extend(sign_of(fault));
                None
            }
            SessionEvent::Run(RunEvent::StepFinished(result)) => self.step(result),
            _ => None,
        }
    }

    fn step(&mut self, result: &StepResult) -> Option<&ObservedStep> {
        let spoilt = result.verdict == Verdict::Error && result.findings.of_the_bench();
        if !is_observed(result.verdict) || spoilt {
            return None;
        }
        let values = result.measurements.iter();
        self.steps.push(ObservedStep {
            check: CheckName {
                procedure: self.procedure.clone(),
                step: result.name.clone(),
            },
            result: result.verdict,
            time_s: result.bench_time.as_secs(),
            values: values.map(|m| (m.name.clone(), m.value)).collect(),
            signs: std::mem::take(&mut self.waiting),
        });
        self.steps.last()
    }

    /// All steps; signs that showed after the last step belong to it.
    pub fn finish(mut self) -> Vec<ObservedStep> {
        if let Some(last) = self.steps.last_mut() {
            last.signs.append(&mut self.waiting);
        }
        self.steps
    }
}

/// A check that failed is no sign beside the step itself.
fn sign_of(fault: &FaultSeen) -> Option<Sign> {
    (fault.code != CHECK_FAILED).then(|| Sign {
        fault: fault.name.clone(),
        lru: fault.lru.clone(),
    })
}

/// Observation of a stored run. Signs go with the step in which they showed or, before a procedure's first step, with
/// this first step; a run without steps, as an imported log is, has nothing but signs.
pub fn of_run(run: &RunDetail, occurrences: &[RunOccurrence]) -> Observation {
    let mut seen = Observation::default();
    let steps = run
        .steps
        .iter()
        .filter_map(|step| Some((step, of_step(step)?)));
    let mut steps: Vec<_> = steps.collect();
    for occurrence in occurrences {
        if occurrence.code == i64::from(CHECK_FAILED) {
            continue;
        }
        let sign = Sign {
            fault: occurrence.code_name.clone(),
            lru: lru::from_stored(&occurrence.lru),
        };
        let after = |step: &StepRecord| match occurrence.step_index {
            Some(index) => step.index >= index,
            None => step.started_bench_us >= occurrence.bench_us,
        };
        let place = steps.iter().position(|(step, _)| after(step));
        match place.or(steps.len().checked_sub(1)) {
            Some(place) => drop(steps[place].1.signs.insert(sign)),
            None => drop(seen.signs.insert(sign)),
        }
    }
    seen.steps = steps.into_iter().map(|(_, step)| step).collect();
    seen
}

fn of_step(step: &StepRecord) -> Option<ObservedStep> {
    let result = Some(from_stored(step.verdict)).filter(|verdict| is_observed(*verdict))?;
    // A step that the bench spoilt shows nothing of the unit.
    let spoilt = result == Verdict::Error && findings(&step.findings).of_the_bench();
    if outside_of(step).is_some() || spoilt {
        return None;
    }
    let values = step.measurements.iter();
    Some(ObservedStep {
        check: CheckName {
            procedure: step.procedure.clone(),
            step: step.name.clone(),
        },
        result,
        time_s: step.bench_time_us as f64 / 1e6,
        values: values.map(|m| (m.name.clone(), m.value)).collect(),
        signs: BTreeSet::new(),
    })
}

#[cfg(test)]
mod tests {
    use btu_rig::procedure::{Finding, Findings};
    use protocol::Duration;

    use super::*;

    /// Goal: what the bench or the tester's computer did is no evidence of the unit. Method: a step that ended in an error,
    /// for a time limit and for a tester that stood still.
    #[test]
    fn a_step_that_the_bench_spoilt_is_no_evidence() {
        let by = Duration::from_ms(400);
        let limit = Finding::TimeLimit {
            limit: by,
            waiting: None,
        };
        let stood_still = Finding::StoodStill { by, attempt: 3 };
        for (why, counts) in [
            (limit.clone(), true),
            (stood_still.clone(), false),
            (Finding::NotRun(Box::new(stood_still)), false),
            (Finding::InSetUp(Box::new(limit)), true),
        ] {
            let findings = Findings::from(why.clone());
            let step = StepRecord {
                verdict: fault_db::Verdict::Error,
                findings: findings.to_json(),
                ..StepRecord::passed(0, "a/b", "c")
            };
            assert_eq!(of_step(&step).is_some(), counts, "{why:?}");
        }
    }
}
