//! Verdict and message of a step from the problems that were found in it.

use super::Verdict;
use super::finding::{Finding, Findings, WhyNoValue};
use super::plan::Step;
use super::problem::Problem;

/// A bench problem outranks all: then the step says nothing about the unit. A refused request is a bench problem,
/// unless the unit has `restarted` by itself and has forgotten what was sent to it: then the step has failed.
pub(super) fn verdict(problems: &[(Problem, u32)], restarted: bool, aborted: bool) -> Verdict {
    let any = |wanted: fn(&Problem) -> bool| problems.iter().any(|(problem, _)| wanted(problem));
    let refused = any(|p| matches!(p, Problem::Refused(_)));
    if aborted {
        Verdict::Aborted
    } else if any(|p| matches!(p, Problem::Bench(_))) || refused && !restarted {
        Verdict::Error
    } else if refused || any(Problem::is_failure) {
        Verdict::Failed
    } else if any(|p| matches!(p, Problem::NoData(_))) {
        Verdict::Error
    } else {
        Verdict::Passed
    }
}

/// Each problem once, measurements without a value for the same reason together; without a problem the step's note.
pub(super) fn findings(problems: &[(Problem, u32)], step: &Step, aborted: bool) -> Findings {
    let mut all = Findings::default();
    if problems.is_empty() && !aborted {
        all.extend(step.note.clone().map(Finding::Told));
        return all;
    }
    all.extend(aborted.then_some(Finding::Stopped));
    // Measurements without a value mostly lack it for one reason, which is told once.
    let mut without_value: Vec<(&str, &WhyNoValue, u32)> = Vec::new();
    for (problem, times) in problems {
        let Finding::NoValue {
            measurement, why, ..
        } = problem.finding()
        else {
            all.add(problem.finding().clone(), *times);
            continue;
        };
        match without_value.iter_mut().find(|known| known.1 == why) {
            Some(known) => known.2 += 1,
            None => without_value.push((measurement, why, 0)),
        }
    }
    all.extend(
        without_value
            .into_iter()
            .map(|(name, why, others)| Finding::NoValue {
                measurement: name.to_owned(),
                others,
                why: why.clone(),
            }),
    );
    all
}
