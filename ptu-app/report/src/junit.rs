//! JUnit XML, for tools that collect test results.

use fault_db::{RunDetail, StepRecord, Verdict};
use protocol::display_text;
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use ptu_bench::failure::Failure;

/// One suite a procedure, one case a step; measurements go to the case's output.
pub fn junit(run: &RunDetail) -> Result<String, Failure> {
    let mut report = Report::new(format!("ptu run {}", run.run.id));
    let mut begun: Option<(String, TestSuite)> = None;
    for step in &run.steps {
        if begun
            .as_ref()
            .is_none_or(|(procedure, _)| *procedure != step.procedure)
        {
            if let Some((_, suite)) = begun.take() {
                report.add_test_suite(suite);
            }
            begun = Some((
                step.procedure.clone(),
                TestSuite::new(&*display_text::line(&step.procedure)),
            ));
        }
        if let Some((_, suite)) = &mut begun {
            suite.add_test_case(case(step));
        }
    }
    if let Some((_, suite)) = begun {
        report.add_test_suite(suite);
    }
    report
        .to_string()
        .map_err(|error| Failure::bench(format!("cannot make the JUnit report: {error}")))
}

fn case(step: &StepRecord) -> TestCase {
    let status = match step.verdict {
        Verdict::Passed => TestCaseStatus::success(),
        Verdict::Skipped => TestCaseStatus::skipped(),
        Verdict::Failed => failed(NonSuccessKind::Failure, &step.message),
        Verdict::Error | Verdict::Aborted => failed(NonSuccessKind::Error, &step.message),
    };
    let mut case = TestCase::new(&*display_text::line(&step.name), status);
    case.set_classname(&*display_text::line(&step.procedure));
    case.set_time(std::time::Duration::from_micros(
        step.bench_time_us.max(0) as u64
    ));
    let lines: Vec<_> = step
        .measurements
        .iter()
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

fn failed(kind: NonSuccessKind, message: &str) -> TestCaseStatus {
    let mut status = TestCaseStatus::non_success(kind);
    status.set_message(&*display_text::lines(message));
    status
}
