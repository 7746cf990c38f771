//! Comparisons of runs that are alike, changed, and hard to compare.

use fault_db::{StepRecord, Verdict};

use super::super::tests::{stored, words_of};
use super::{Differs, RunComparison, Tally, comparison_json, comparison_text};
use crate::run::page::pages;
use crate::words::Language;

/// A run of a few steps twice; `change` makes the second one another.
fn twice(change: impl FnOnce(&mut Vec<StepRecord>)) -> RunComparison {
    let (stored, run) = stored(4, true);
    let read = || stored.store.run(run).expect("a run");
    let (a, mut b) = (read(), read());
    change(&mut b.steps);
    RunComparison { a, b, all: false }
}

#[test]
fn a_run_is_like_itself() {
    let same = twice(|_| {});
    let failed = same
        .a
        .steps
        .iter()
        .filter(|step| step.verdict == Verdict::Failed);
    let expected = Tally {
        in_neither: failed.count(),
        ..Tally::default()
    };
    assert_eq!(same.tally(), expected);
    assert!(same.differs().is_empty(), "{:?}", same.differs());
    let mut changes = same.steps().into_iter().flat_map(|pair| {
        let changes = pair.measurements.iter().filter_map(super::Compared::change);
        changes.collect::<Vec<_>>()
    });
    assert!(changes.all(|change| change == 0.0));
}

/// Goal: each step counts where it belongs, also where a run tested it twice. Method: of the steps of a run one is made to
/// pass, one to fail, one is taken away, one is new, and the one that fails now passed before that.
#[test]
fn steps_count_by_what_became_of_them() {
    let mut changed = twice(|steps| {
        let failed = steps
            .iter_mut()
            .find(|step| step.verdict == Verdict::Failed);
        let failed = failed.expect("a failed step");
        failed.verdict = Verdict::Passed;
        let mut passed = steps.iter().filter(|step| step.verdict == Verdict::Passed);
        let mut again = passed.next_back().expect("a passed step").clone();
        again.verdict = Verdict::Failed;
        steps.push(again);
        let mut new = steps[0].clone();
        new.name = "a new step".into();
        steps.push(new);
    });
    let before = twice(|_| {}).tally();
    let tally = changed.tally();
    assert_eq!(tally.pass_now + tally.in_neither, before.in_neither);
    assert_eq!((tally.pass_now, tally.passed_before), (1, 1));
    assert_eq!((tally.only_a, tally.only_b), (0, 1));
    changed.b.steps.pop();
    changed.b.steps.remove(0);
    assert_eq!(changed.tally().only_a, 1);
}

#[test]
fn what_makes_runs_hard_to_compare_is_said_in_both_languages() {
    let mut other = twice(|_| {});
    let run = &mut other.b.run;
    run.unit_serial = "OTHER-2".into();
    run.line = "line9".into();
    run.unit_config_sha256 = "other".into();
    run.scripts_sha256 = "other".into();
    run.started_at_us -= 1;
    run.verdict = None;
    let differs = other.differs();
    assert_eq!(differs.len(), 6, "{differs:?}");
    assert!(differs.contains(&Differs::Order));
    let [english, korean] = Language::ALL.map(|language| {
        let text = comparison_text(&other, language.words());
        let pages = pages(&other, language.words()).expect("pages");
        let page: String = pages.iter().map(|page| words_of(page)).collect();
        for warning in other.warnings(language.words()) {
            assert!(text.contains(&warning), "{warning}: {text}");
        }
        assert!(page.contains("OTHER-2"), "{page}");
        text
    });
    assert!(english.contains("of different units"), "{english}");
    assert!(korean.contains("서로 다른 장치의 시험입니다"), "{korean}");
    let data = comparison_json(&other);
    assert_eq!(data["differs"].as_array().map(Vec::len), Some(6));
}
