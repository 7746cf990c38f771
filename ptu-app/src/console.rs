//! The console during a run: progress, and the table of verdicts at its end.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, SyncSender};
use std::thread::JoinHandle;
use std::time::Duration;

use btu_rig::procedure::{Findings, Measurement, Procedure, ResultKind, RunEvent, Verdict};
use fault_db::{RunDetail, StepCounts, StepKind, StepRecord};
use indicatif::{ProgressBar, ProgressStyle};
use protocol::{display_text, lru};

use crate::operator::HOW_TO_ANSWER;
use ptu_report::limits::short;
use ptu_report::words::Language;
use ptu_report::{count_short, coverage_text};
use ptu_runs::coverage::{Coverage, counts_of};
use ptu_runs::failure::{Failure, RunTrouble};
use ptu_runs::run::{LinePrinter, Listener, RunPlan, SessionEvent, steps_of};
use ptu_runs::stdio;
use ptu_runs::stored::{by_procedure, of_procedure, standing};
use ptu_runs::table::{Table, cell};
use ptu_runs::terminal::{self, Style, verdict};

/// How often the bar's clock moves while nothing happens.
const TICK: Duration = Duration::from_millis(250);
/// What may wait for a terminal that takes nothing, as one that was halted: more is left out.
const WAITING: usize = 4096;
/// Widest wording beside the bar, in columns.
const BESIDE_BAR: usize = 100;

/// How much is said of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// What did not pass.
    Quiet,
    /// And each procedure, and the step under way on a terminal.
    Usual,
    /// And each step and measurement.
    Verbose,
}

/// Shows progress on stderr: a bar on a terminal, a line a procedure elsewhere. It has a thread of its own:
/// neither the bench nor the store waits for whoever reads.
pub struct Console {
    detail: Detail,
    /// Steps of the present procedure: begun, and all of it.
    steps: (usize, usize),
    shown: SyncSender<Shown>,
    /// Lines that were not printed.
    left_out: Arc<AtomicUsize>,
    thread: JoinHandle<()>,
}

enum Shown {
    /// What is under way, beside the bar.
    RunPosition(String),
    StepDone,
    Line(String),
}

impl Console {
    /// For a run of this plan.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn new(plan: &RunPlan, detail: Detail) -> Result<Self, Failure> {
        let steps = steps_of(&plan.tasks) as u64;
        let (shown, all) = mpsc::sync_channel(WAITING);
        let thread = std::thread::Builder::new()
            .name("console".into())
            .spawn(move || show(&all, bar(steps, detail).as_ref()));
        let thread =
            thread.map_err(|error| Failure::bench(RunTrouble::NoThread(error.to_string())))?;
        Ok(Self {
            detail,
            steps: (0, 0),
            shown,
            left_out: Arc::default(),
            thread,
        })
    }

    /// The run is over; returns when all is shown.
    pub fn finish(self) {
        drop(self.shown);
        // What it showed is no reason for a run to fail.
        let _ = self.thread.join();
        let left_out = self.left_out.load(Ordering::Relaxed);
        if left_out > 0 {
            stdio::note(&format!(
                "{left_out} lines were left out because nothing took them; `ptu runs show latest` has all"
            ));
        }
    }
}

fn bar(steps: u64, detail: Detail) -> Option<ProgressBar> {
    (detail != Detail::Quiet && stdio::draws()).then(|| {
        let bar = ProgressBar::new(steps).with_message("bringing the unit up");
        bar.enable_steady_tick(TICK);
        let style = "{bar:30} {pos}/{len} steps  {elapsed} (left {eta})  {msg}";
        bar.with_style(
            ProgressStyle::with_template(style).unwrap_or_else(|_| ProgressStyle::default_bar()),
        )
    })
}

fn show(all: &Receiver<Shown>, bar: Option<&ProgressBar>) {
    for shown in all {
        match (shown, bar) {
            (Shown::RunPosition(what), Some(bar)) => bar.set_message(what),
            (Shown::StepDone, Some(bar)) => bar.inc(1),
            (Shown::Line(line), Some(bar)) => bar.println(stdio::noted(&display_text::line(&line))),
            (Shown::Line(line), None) => stdio::note(&display_text::line(&line)),
            (Shown::RunPosition(_) | Shown::StepDone, None) => {}
        }
    }
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
}

impl Listener for Console {
    fn on_event(&mut self, procedure: &Procedure, event: &SessionEvent) {
        match event {
            SessionEvent::Run(RunEvent::ProcedureStarted { steps, .. }) => self.steps = (0, *steps),
            SessionEvent::Run(RunEvent::StepStarted { .. }) => self.steps.0 += 1,
            _ => {}
        }
        let (step, of) = self.steps;
        let present = |what: String| {
            let place = format!("{} {step}/{of}: {what}", procedure.id);
            Shown::RunPosition(cell(&place, BESIDE_BAR))
        };
        let shown = match event {
            SessionEvent::Run(RunEvent::StepStarted {
                name, turn, turns, ..
            }) => present(
                Language::English
                    .words()
                    .step(name, [*turn, *turns], StepKind::Step),
            ),
            SessionEvent::Run(RunEvent::Waiting { action: what, left }) => {
                present(format!("{what}, {:.0} s left", left.as_secs()))
            }
            SessionEvent::Run(RunEvent::StepFinished(result))
                if result.kind != ResultKind::Attempt =>
            {
                Shown::StepDone
            }
            _ => return,
        };
        // Beside a terminal that takes nothing this is missed.
        let _ = self.shown.try_send(shown);
    }

    fn line(&self, procedure: &Procedure, event: &SessionEvent) -> Option<String> {
        match event {
            SessionEvent::Run(RunEvent::Prompt { text, .. }) => {
                Some(format!("asks    {}: {text} {HOW_TO_ANSWER}", procedure.id))
            }
            SessionEvent::Run(RunEvent::Measured { measurement, .. })
                if self.detail == Detail::Verbose =>
            {
                Some(format!("        {}", measured(measurement)))
            }
            SessionEvent::Run(RunEvent::StepFinished(result))
                if result.kind == ResultKind::Attempt
                    || self.detail == Detail::Verbose
                    || !matches!(result.verdict, Verdict::Passed | Verdict::Skipped) =>
            {
                let verdict = match result.kind {
                    ResultKind::Attempt => "repeat",
                    _ => result.verdict.label(),
                };
                let name = Language::English.words().result(result);
                let more = after_colon(&result.findings);
                let verdict = terminal::verdict(&format!("{verdict:<7}"));
                Some(format!("{verdict} {}: {name}{more}", procedure.id))
            }
            SessionEvent::Run(RunEvent::ProcedureFinished {
                verdict, findings, ..
            }) if self.detail != Detail::Quiet
                || !matches!(verdict, Verdict::Passed | Verdict::Skipped) =>
            {
                let more = after_colon(findings);
                let verdict = terminal::verdict(&format!("{:<7}", verdict.label()));
                Some(format!("{verdict} {}{more}", procedure.id))
            }
            // Quietly the failed step says it.
            SessionEvent::Fault(fault) if self.detail != Detail::Quiet => Some(format!(
                "fault   {} → {}: {}",
                fault.name,
                lru::stored(fault.lru.as_ref()),
                fault.finding
            )),
            _ => None,
        }
    }

    fn line_printer(&self) -> Option<LinePrinter> {
        let (shown, left_out) = (self.shown.clone(), self.left_out.clone());
        Some(Box::new(move |line| {
            if shown.try_send(Shown::Line(line)).is_err() {
                left_out.fetch_add(1, Ordering::Relaxed);
            }
        }))
    }
}

fn after_colon(findings: &Findings) -> String {
    match findings.is_empty() {
        true => String::new(),
        false => format!(": {findings}"),
    }
}

/// A value with its limits, in the words of a failed one.
fn measured(measurement: &Measurement) -> String {
    let value = measurement
        .value
        .map_or_else(|| "no value".to_owned(), short);
    let limits = match (measurement.low, measurement.high) {
        (None, None) => String::new(),
        (Some(low), None) => format!(", allowed at least {}", short(low)),
        (None, Some(high)) => format!(", allowed at most {}", short(high)),
        (Some(low), Some(high)) => format!(", allowed {} to {}", short(low), short(high)),
    };
    let text = format!(
        "{} = {value}{} {}",
        measurement.name,
        Style::Limit.mark(&limits),
        measurement.unit
    );
    text.trim_end().to_owned()
}

/// The procedure and the step; or where it failed outside of steps, as files name it.
fn named(step: &StepRecord) -> String {
    let turn = [step.turn, step.turns];
    let name = Language::English.words().step(&step.name, turn, step.kind);
    format!("{}: {name}", step.procedure)
}

/// Attempts at steps that were not tested, and made again.
fn repeated(run: &RunDetail) -> String {
    let mut table = Table::new(&["REPEATED STEP", "WHY"]);
    let attempts = run.steps.iter();
    let rows: Vec<_> = attempts
        .filter(|step| step.kind == StepKind::Attempt)
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    for step in rows {
        let name = named(step);
        table.row([name, step.message.clone()]);
    }
    format!("\n\n{}", table.render())
}

/// Why steps were skipped, each reason once.
fn skipped(run: &RunDetail) -> String {
    let mut reasons = BTreeMap::<&str, BTreeSet<(&str, Option<u32>)>>::new();
    let skipped = standing(&run.steps);
    for step in skipped.filter(|step| step.verdict == fault_db::Verdict::Skipped) {
        let steps = reasons.entry(&step.message).or_default();
        steps.insert((&step.procedure, step.place));
    }
    if reasons.is_empty() {
        return String::new();
    }
    let mut table = Table::new(&["SKIPPED STEPS", "WHY"]);
    for (reason, steps) in reasons {
        table.row([steps.len().to_string(), reason.to_owned()]);
    }
    format!("\n\n{}", table.render())
}

/// Procedures with their verdicts, what did not pass, and the faults found.
pub fn verdict_table(run: &RunDetail) -> String {
    let mut text = match run.steps[..] {
        // A unit's own log, imported, or a run that never began.
        [] => format!("{}, no steps", run.run.source),
        _ => part(run) + &procedures(run).render(),
    };
    text.push_str(&not_passed(run));
    text.push_str(&repeated(run));
    text.push_str(&skipped(run));
    if !run.faults.is_empty() {
        let mut table =
            Table::new(&["FAULT", "CODE", "PART", "SEVERITY", "SEEN", "TRACE"]).parts([2]);
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

/// What did not pass, what was made again, and the verdict.
pub fn failures(run: &RunDetail) -> String {
    format!("{}{}\n\n{}", not_passed(run), repeated(run), summary(run))
        .trim_start()
        .to_owned()
}

/// Steps that did not pass, each with the reason.
fn not_passed(run: &RunDetail) -> String {
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
    if failed.is_empty() {
        return String::new();
    }
    let mut table = Table::new(&["VERDICT", "STEP", "WHY"]).verdicts(0);
    for step in failed {
        let name = named(step);
        table.row([step.verdict.as_str().into(), name, step.message.clone()]);
    }
    format!("\n\n{}", table.render())
}

fn procedures(run: &RunDetail) -> Table {
    let mut table =
        Table::new(&["PROCEDURE", "VERDICT", "STEPS", "PASSED", "BENCH TIME"]).verdicts(1);
    for (procedure, mine) in by_procedure(&run.steps) {
        let counts = StepCounts::of(mine.iter().copied());
        let verdict = of_procedure(mine.iter().copied(), run.run.verdict);
        let time: i64 = mine.iter().map(|step| step.bench_time_us).sum();
        table.row([
            procedure.to_owned(),
            verdict.as_str().into(),
            counts.planned.to_string(),
            counts.passed.to_string(),
            format!("{:.1} s", time as f64 / 1e6),
        ]);
    }
    table
}

fn summary(run: &RunDetail) -> String {
    let bench_s = run.run.bench_time_us.unwrap_or(0) as f64 / 1e6;
    let wall_s = run.run.wall_time_us.unwrap_or(0) as f64 / 1e6;
    let continued = (run.run.continues).map_or_else(String::new, |earlier| {
        format!("\ncontinues run {}", earlier.short())
    });
    format!(
        "run {}  unit {}  {} steps, {} faults: {}\nbench time {bench_s:.1} s in {wall_s:.2} s{continued}",
        run.run.id.short(),
        display_text::line(&run.run.unit_serial),
        count_short(&counts_of(&run.run)),
        run.faults.len(),
        verdict(verdict_word(run))
    )
}

fn verdict_word(run: &RunDetail) -> &'static str {
    let verdict = run.run.verdict;
    verdict.map_or(run.run.state.as_str(), |verdict| verdict.as_str())
}

/// The first line, where steps were skipped.
fn part(run: &RunDetail) -> String {
    let coverage = coverage_text(&Coverage::of_run(run), Language::English.words());
    coverage.map_or_else(String::new, |part| {
        format!("{}: {part}\n\n", verdict(verdict_word(run)))
    })
}
