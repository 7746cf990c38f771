//! JUnit XML, for tools that collect test results.

use std::time::Duration;

use btu_rig::procedure::Outside;
use chrono::{DateTime, FixedOffset};
use fault_db::{RunDetail, StepKind, StepRecord, Verdict, rank};
use protocol::display_text;
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestRerun, TestSuite};

use crate::coverage::{count_text, coverage_text};
use crate::departure::Departure;
use crate::words::Language;
use ptu_runs::clock::rfc3339;
use ptu_runs::coverage::Coverage;
use ptu_runs::failure::{Failure, FileTrouble, Why};
use ptu_runs::stored::{WHOLE_RUN, by_procedure, kind_of};

/// One suite a procedure, one case a step or what failed outside the steps; measurements go to the case's output.
///
/// A run that did not pass has at least one case that did not pass: also a run without a verdict, and a run of a
/// program that did not store failures outside steps.
pub fn junit(run: &RunDetail) -> Result<String, Failure> {
    let (coverage, words) = (Coverage::of_run(run), Language::English.words());
    let counted = coverage_text(&coverage, words);
    let counted = counted.unwrap_or_else(|| count_text(&coverage.steps, words));
    let mut report = Report::new(format!("ptu run {}: {counted}", run.run.id));
    let began_us = run.run.started_at_us;
    report.set_timestamp(utc(began_us));
    let departure = Departure::of(run);
    for (procedure, steps) in by_procedure(&run.steps) {
        let mut suite = TestSuite::new(&*display_text::line(procedure));
        suite.set_timestamp(utc(began_us + steps[0].started_bench_us));
        let all_us = steps.iter().map(|step| step.bench_time_us.max(0) as u64);
        suite.set_time(Duration::from_micros(all_us.sum()));
        if let Some(departure) = &departure {
            let until = rfc3339(departure.until_us);
            let why_not = departure.why_not(words).join("; ");
            let said = match why_not.is_empty() {
                true => ("departure_valid_until", &*until),
                false => ("departure_not_valid", &*why_not),
            };
            suite.add_property(said);
        }
        for results in by_step(steps) {
            suite.add_test_case(case(&results, began_us));
        }
        report.add_test_suite(suite);
    }
    if let Some(case) = of_whole(run) {
        let mut suite = TestSuite::new(WHOLE_RUN);
        suite.add_test_case(case);
        report.add_test_suite(suite);
    }
    report.to_string().map_err(|error| {
        Failure::bench(FileTrouble::NotPrinted("the JUnit report", Why::of(error)))
    })
}

/// Results of each step in order; what is outside steps stands alone.
fn by_step(steps: Vec<&StepRecord>) -> Vec<Vec<&StepRecord>> {
    let mut all: Vec<Vec<&StepRecord>> = Vec::new();
    for step in steps {
        let same = all
            .iter_mut()
            .find(|of| step.place.is_some() && of[0].place == step.place);
        match same {
            Some(results) => results.push(step),
            None => all.push(vec![step]),
        }
    }
    all
}

/// Test case for the run as a whole, where no step has its result.
fn of_whole(run: &RunDetail) -> Option<TestCase> {
    let passed = |verdict| matches!(verdict, Verdict::Passed | Verdict::Skipped);
    let (verdict, message) = match run.run.verdict {
        Some(verdict) if passed(verdict) => return None,
        Some(_) if !run.steps.iter().all(|step| passed(step.verdict)) => return None,
        Some(verdict) => (verdict, "the run did not pass; no step says why"),
        None => (Verdict::Error, "the run has not come to its end"),
    };
    let name = Outside::Whole.name();
    let mut case = TestCase::new(name, status(verdict, name, message));
    case.set_classname(WHOLE_RUN);
    Some(case)
}

/// The case of a step: the result with the highest rank counts, and the other results that did not pass are added.
fn case(results: &[&StepRecord], began_us: i64) -> TestCase {
    let stands = results.iter().rev().max_by_key(|step| rank(step.verdict));
    let step = stands.unwrap_or(&results[0]);
    let kind = kind_of(step);
    let mut status = status(step.verdict, kind, &step.message);
    let others = results.iter().filter(|other| other.index != step.index);
    for attempt in others.filter(|other| other.verdict != Verdict::Passed) {
        let mut rerun = TestRerun::new(match attempt.verdict {
            Verdict::Failed => NonSuccessKind::Failure,
            _ => NonSuccessKind::Error,
        });
        rerun.set_timestamp(utc(began_us + attempt.started_bench_us));
        rerun.set_time(Duration::from_micros(attempt.bench_time_us.max(0) as u64));
        rerun.set_type(match attempt.verdict {
            Verdict::Skipped => "not tested",
            verdict => verdict.as_str(),
        });
        rerun.set_message(&*display_text::lines(&attempt.message));
        status.add_rerun(rerun);
    }
    let mut case = TestCase::new(&*display_text::line(&step.name), status);
    case.set_classname(&*display_text::line(&step.procedure));
    case.set_time(Duration::from_micros(step.bench_time_us.max(0) as u64));
    case.set_timestamp(utc(began_us + step.started_bench_us));
    case.add_property(("kind", kind));
    case.add_property(("verdict", step.verdict.as_str()));
    case.add_property(("step_index", &*step.index.to_string()));
    let attempts = results.iter().filter(|of| of.kind == StepKind::Attempt);
    for attempt in attempts {
        let said = Language::English.words().record(attempt);
        case.add_property(("attempt", &*display_text::line(&said)));
    }
    if let Some(line) = step.script_line {
        case.add_property(("script_line", &*line.to_string()));
    }
    if let Some(source) = &step.limit_source {
        case.add_property(("limit_source", &*display_text::line(source)));
    }
    for measured in &step.measurements {
        if let Some(source) = &measured.limit_source {
            let name = format!("limit_source {}", measured.name);
            case.add_property((&*display_text::line(&name), &*display_text::line(source)));
        }
    }
    let lines: Vec<_> = results
        .iter()
        .flat_map(|result| &result.measurements)
        .map(|m| {
            let value = m
                .value
                .map_or_else(|| "no value".into(), |value| format!("{value:.3}"));
            format!("{} = {value} {} [{}]", m.name, m.unit, m.verdict.as_str())
        })
        .collect();
    if !lines.is_empty() {
        case.set_system_out(&*display_text::lines(&lines.join("\n")));
    }
    case
}

/// Status for a verdict, with the place and the reason of the result, also for a skipped step.
fn status(verdict: Verdict, kind: &str, message: &str) -> TestCaseStatus {
    let mut status = match verdict {
        Verdict::Passed => return TestCaseStatus::success(),
        Verdict::Skipped => TestCaseStatus::skipped(),
        Verdict::Failed => TestCaseStatus::non_success(NonSuccessKind::Failure),
        Verdict::Error | Verdict::Inconclusive | Verdict::Aborted => {
            TestCaseStatus::non_success(NonSuccessKind::Error)
        }
    };
    status.set_message(&*display_text::lines(message));
    if verdict != Verdict::Skipped {
        status.set_type(format!("{kind} {}", verdict.as_str()));
    }
    status
}

/// A moment in UTC. It orders events, but is no time of day: bench time in virtual time runs ahead of the clock.
fn utc(at_us: i64) -> DateTime<FixedOffset> {
    DateTime::from_timestamp_micros(at_us)
        .unwrap_or_default()
        .fixed_offset()
}
