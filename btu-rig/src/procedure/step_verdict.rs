//! Verdict and message of a step from the problems that were found in it.

use super::Verdict;
use super::action_run::Problem;
use super::evidence::counted;
use super::plan::Step;

/// A bench problem outranks all: then the step says nothing about the unit. A request that was refused is one, unless
/// the unit has `restarted` by itself and no longer knows what was sent to it.
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
pub(super) fn message(problems: &[(Problem, u32)], step: &Step, aborted: bool) -> String {
    if problems.is_empty() && !aborted {
        return step.note.clone().unwrap_or_default();
    }
    let mut texts: Vec<(String, u32)> = Vec::new();
    texts.extend(aborted.then(|| ("stopped by the operator".to_owned(), 1)));
    // Measurements wait for the same thing more often than not: it is said once.
    let mut without_value: Vec<(&str, &str, usize)> = Vec::new();
    for (problem, times) in problems {
        match problem.message().split_once(": ") {
            Some((name, reason)) if reason.starts_with("no value") => {
                match without_value.iter_mut().find(|known| known.1 == reason) {
                    Some(known) => known.2 += 1,
                    None => without_value.push((name, reason, 0)),
                }
            }
            _ => texts.push((problem.message().to_owned(), *times)),
        }
    }
    texts.extend(
        without_value
            .into_iter()
            .map(|(name, reason, more)| match more {
                0 => (format!("{name}: {reason}"), 1),
                more => (format!("{name} and {more} more: {reason}"), 1),
            }),
    );
    counted(texts.iter().map(|(text, times)| (text.as_str(), *times)))
}
