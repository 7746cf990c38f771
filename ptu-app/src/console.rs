//! The console: progress while a run goes on, and its verdict table.

use std::io::IsTerminal;
use std::time::Duration;

use btu_rig::procedure::{Procedure, RunEvent, Verdict};
use fault_db::RunDetail;
use indicatif::{ProgressBar, ProgressStyle};

use crate::run::{Listener, RunPlan, SessionEvent, steps_of};
use crate::table::Table;

/// How often the bar's clock moves while nothing happens.
const TICK: Duration = Duration::from_millis(250);

/// Shows progress on stderr: a bar on a terminal, a line a procedure elsewhere.
pub struct Console {
    bar: Option<ProgressBar>,
}

impl Console {
    /// For a run of this plan.
    pub fn new(plan: &RunPlan) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let bar =
                ProgressBar::new(steps_of(&plan.tasks) as u64).with_message("bringing the unit up");
            bar.enable_steady_tick(TICK);
            let style = "{bar:30} {pos}/{len} steps  {elapsed} (left {eta})  {msg}";
            bar.with_style(
                ProgressStyle::with_template(style)
                    .unwrap_or_else(|_| ProgressStyle::default_bar()),
            )
        });
        Self { bar }
    }

    /// The run is over.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }

    fn say(&self, line: &str) {
        match &self.bar {
            Some(bar) => bar.println(line),
            None => eprintln!("{line}"),
        }
    }
}

impl Listener for Console {
    fn hear(&mut self, procedure: &Procedure, event: &SessionEvent) {
        match event {
            SessionEvent::Run(RunEvent::StepStarted { name, .. }) => {
                if let Some(bar) = &self.bar {
                    bar.set_message(format!("{}: {name}", procedure.id));
                }
            }
            SessionEvent::Run(RunEvent::Waiting { what, left }) => {
                if let Some(bar) = &self.bar {
                    bar.set_message(format!(
                        "{}: {what}, {:.0} s left",
                        procedure.id,
                        left.as_secs()
                    ));
                }
            }
            SessionEvent::Run(RunEvent::StepFinished(result)) => {
                if let Some(bar) = &self.bar {
                    bar.inc(1);
                }
                if !matches!(result.verdict, Verdict::Passed | Verdict::Skipped) {
                    self.say(&format!(
                        "{:<7} {}: {}: {}",
                        result.verdict.label(),
                        procedure.id,
                        result.name,
                        result.message
                    ));
                }
            }
            SessionEvent::Run(RunEvent::ProcedureFinished {
                verdict, message, ..
            }) => {
                let more = if message.is_empty() {
                    String::new()
                } else {
                    format!(": {message}")
                };
                self.say(&format!("{:<7} {}{more}", verdict.label(), procedure.id));
            }
            SessionEvent::Fault(fault) => {
                self.say(&format!(
                    "fault   {} → {}: {}",
                    fault.name, fault.lru, fault.message
                ));
            }
            _ => {}
        }
    }
}

/// Procedures with their verdicts, what did not pass, and the faults found.
pub fn verdict_table(run: &RunDetail) -> String {
    let mut text = match run.steps[..] {
        // A unit's own log, imported, or a run that never began.
        [] => format!("{}, no steps", run.run.source),
        _ => procedures(run).render(),
    };
    let failed: Vec<_> = run
        .steps
        .iter()
        .filter(|step| {
            !matches!(
                step.verdict,
                fault_db::Verdict::Passed | fault_db::Verdict::Skipped
            )
        })
        .collect();
    if !failed.is_empty() {
        let mut table = Table::new(&["VERDICT", "STEP", "WHY"]);
        for step in failed {
            let name = format!("{}: {}", step.procedure, step.name);
            table.row([step.verdict.as_str().into(), name, step.message.clone()]);
        }
        text.push_str(&format!("\n\n{}", table.render()));
    }
    if !run.faults.is_empty() {
        let mut table = Table::new(&["FAULT", "CODE", "PART", "SEVERITY", "SEEN", "TRACE"]);
        for fault in &run.faults {
            let trace = fault.trace_id.map_or_else(String::new, |id| id.short());
            table.row([
                fault.id.short(),
                format!("{} {}", fault.code, fault.code_name),
                fault.lru.clone(),
                fault.severity.clone(),
                fault.occurrences.to_string(),
                trace,
            ]);
        }
        text.push_str(&format!("\n\n{}", table.render()));
    }
    text.push_str(&format!("\n\n{}", summary(run)));
    text
}

fn procedures(run: &RunDetail) -> Table {
    let mut table = Table::new(&["PROCEDURE", "VERDICT", "STEPS", "PASSED", "BENCH TIME"]);
    let mut steps = run.steps.as_slice();
    while let Some(first) = steps.first() {
        let end = steps
            .iter()
            .position(|s| s.procedure != first.procedure)
            .unwrap_or(steps.len());
        let (mine, rest) = steps.split_at(end);
        let passed = mine
            .iter()
            .filter(|s| s.verdict == fault_db::Verdict::Passed)
            .count();
        let time: i64 = mine.iter().map(|step| step.bench_time_us).sum();
        table.row([
            first.procedure.clone(),
            worst(mine, run.run.verdict).into(),
            mine.len().to_string(),
            passed.to_string(),
            format!("{:.1} s", time as f64 / 1e6),
        ]);
        steps = rest;
    }
    table
}

/// The gravest verdict among steps.
/// What a procedure came to. One that was broken off is an error, as its run is; in any other run a check
/// that failed is said before one that could not be made.
fn worst(steps: &[fault_db::StepDetail], run: Option<fault_db::Verdict>) -> &'static str {
    use fault_db::Verdict::{Aborted, Error, Failed, Passed};
    let order = match run {
        Some(Error) => [Aborted, Error, Failed, Passed],
        _ => [Aborted, Failed, Error, Passed],
    };
    order
        .into_iter()
        .find(|verdict| steps.iter().any(|step| step.verdict == *verdict))
        .map_or("skipped", |verdict| verdict.as_str())
}

fn summary(run: &RunDetail) -> String {
    let bench_s = run.run.bench_time_us.unwrap_or(0) as f64 / 1e6;
    let wall_s = run.run.wall_time_us.unwrap_or(0) as f64 / 1e6;
    format!(
        "run {}  unit {}  {} steps, {} faults: {}\nbench time {bench_s:.1} s in {wall_s:.2} s",
        run.run.id.short(),
        run.run.unit_serial,
        run.steps.len(),
        run.faults.len(),
        run.run
            .verdict
            .map_or("interrupted", |verdict| verdict.as_str())
    )
}
