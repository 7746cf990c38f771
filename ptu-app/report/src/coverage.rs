//! Coverage of a run in words: every surface that tells a count of a run tells this one.

use fault_db::StepCounts;
use ptu_runs::coverage::Coverage;

use crate::words::{Words, fill};

/// The count of a run as a sentence.
pub fn count_text(counts: &StepCounts, words: &Words) -> String {
    let report = &words.report;
    let wording = match (counts.run(), counts.not_run(), counts.not_passed()) {
        (0, 0, _) => report.no_steps,
        (0, ..) => report.none_run,
        (_, 0, 0) => report.all_passed,
        (_, 0, _) => report.not_passed,
        (_, _, 0) => report.part_passed,
        _ => report.part_not_passed,
    };
    let mut text = fill(
        wording,
        &[
            ("run", &counts.run()),
            ("of", &counts.planned),
            ("n", &counts.not_passed()),
            ("left", &counts.not_run()),
        ],
    );
    if counts.attempts > counts.run() {
        text += &fill(report.attempts, &[("n", &counts.attempts)]);
    }
    if counts.outside > 0 {
        // The sentence goes on.
        text.truncate(text.trim_end_matches('.').len());
        text += &fill(report.outside_steps, &[("n", &counts.outside)]);
    }
    text
}

/// Count of steps for a table: the steps that were due, and how many of them were run where that
/// differs.
pub fn count_short(counts: &StepCounts, words: &Words) -> String {
    let of = [("run", &counts.run() as _), ("of", &counts.planned as _)];
    match counts.not_run() {
        0 => counts.planned.to_string(),
        _ => fill(words.terminal.of_n, &of),
    }
}

/// Sentence on the coverage, if not all due steps were run, with the needs of the rest.
pub fn coverage_text(coverage: &Coverage, words: &Words) -> Option<String> {
    if coverage.steps.not_run() == 0 {
        return None;
    }
    let mut text = count_text(&coverage.steps, words);
    if coverage.need_bench > 0 {
        let folders: Vec<_> = coverage.on_bench.iter().map(String::as_str).collect();
        text += &fill(
            words.report.needs_bench,
            &[("n", &coverage.need_bench), ("what", &folders.join(", "))],
        );
    }
    Some(text)
}
