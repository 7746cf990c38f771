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
use ptu_report::words::{Language, Words, fill};
use ptu_report::{count_short, coverage_text};
use ptu_runs::coverage::{Coverage, counts_of};
use ptu_runs::failure::{Failure, RunTrouble};
use ptu_runs::run::{LinePrinter, Listener, RunPlan, SessionEvent, steps_of};
use ptu_runs::stdio;
use ptu_runs::stored::{by_procedure, from_stored, of_procedure, standing};
use ptu_runs::table::{Table, cell, padded};
use ptu_runs::terminal::{self, Style, verdict};

/// How often the bar's clock moves while nothing happens.
const TICK: Duration = Duration::from_millis(250);
/// What may wait for a terminal that takes nothing, as one that was halted: more is left out.
const WAITING: usize = 4096;
/// What a line begins with, in columns.
const LINE_BEGIN: usize = 7;
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
            let said = Words::shown().terminal.lines_lost;
            stdio::note(&fill(said, &[("n", &left_out)]));
        }
    }
}

fn bar(steps: u64, detail: Detail) -> Option<ProgressBar> {
    (detail != Detail::Quiet && stdio::draws()).then(|| {
        let terminal = &Words::shown().terminal;
        let bar = ProgressBar::new(steps).with_message(terminal.bringing_up);
        bar.enable_steady_tick(TICK);
        let style = ProgressStyle::with_template(&format!("{{bar:30}} {}", terminal.step_count));
        bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
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
        let words = Words::shown();
        let shown = match event {
            SessionEvent::Run(RunEvent::StepStarted {
                name, turn, turns, ..
            }) => present(words.step(name, [*turn, *turns], StepKind::Step)),
            SessionEvent::Run(RunEvent::Waiting { action, left }) => {
                let (what, n) = (
                    words.awaited_briefly(action),
                    format!("{:.0}", left.as_secs()),
                );
                present(fill(
                    words.terminal.left_seconds,
                    &[("what", &what), ("n", &n)],
                ))
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
        let words = Words::shown();
        let begin = |word: &str| padded(word, LINE_BEGIN);
        match event {
            SessionEvent::Run(RunEvent::Prompt { text, .. }) => {
                let (asks, text) = (begin(words.terminal.asks), words.content(text));
                Some(format!("{asks} {}: {text} {HOW_TO_ANSWER}", procedure.id))
            }
            SessionEvent::Run(RunEvent::Measured { measurement, .. })
                if self.detail == Detail::Verbose =>
            {
                Some(format!("{} {}", begin(""), measured(measurement, words)))
            }
            SessionEvent::Run(RunEvent::StepFinished(result))
                if result.kind == ResultKind::Attempt
                    || self.detail == Detail::Verbose
                    || !matches!(result.verdict, Verdict::Passed | Verdict::Skipped) =>
            {
                let verdict = match result.kind {
                    ResultKind::Attempt => words.terminal.repeat,
                    _ => words.verdict_name(result.verdict),
                };
                let name = words.result(result);
                let more = after_colon(&result.findings, words);
                let verdict = terminal::verdict(&begin(verdict));
                Some(format!("{verdict} {}: {name}{more}", procedure.id))
            }
            SessionEvent::Run(RunEvent::ProcedureFinished {
                verdict, findings, ..
            }) if self.detail != Detail::Quiet
                || !matches!(verdict, Verdict::Passed | Verdict::Skipped) =>
            {
                let more = after_colon(findings, words);
                let verdict = terminal::verdict(&begin(words.verdict_name(*verdict)));
                Some(format!("{verdict} {}{more}", procedure.id))
            }
            // Quietly the failed step says it.
            SessionEvent::Fault(fault) if self.detail != Detail::Quiet => Some(format!(
                "{} {} → {}: {}",
                begin(words.common.fault),
                fault.name,
                lru::stored(fault.lru.as_ref()),
                words.short_finding(&fault.finding)
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

fn after_colon(findings: &Findings, words: &Words) -> String {
    match findings.is_empty() {
        true => String::new(),
        false => format!(": {}", words.short_findings(findings)),
    }
}

/// A value with its limits, in the words of a failed one.
fn measured(measurement: &Measurement, words: &Words) -> String {
    let common = &words.common;
    let value = measurement
        .value
        .map_or_else(|| words.terminal.no_value.to_owned(), short);
    let limit = match (measurement.low.map(short), measurement.high.map(short)) {
        (None, None) => None,
        (Some(low), None) => Some(fill(common.at_least, &[("n", &low)])),
        (None, Some(high)) => Some(fill(common.at_most, &[("n", &high)])),
        (Some(low), Some(high)) => Some(fill(common.from_to, &[("low", &low), ("high", &high)])),
    };
    let limits = limit.map_or_else(String::new, |limit| {
        fill(words.terminal.allowed, &[("limit", &limit)])
    });
    let text = format!(
        "{} = {value}{} {}",
        words.measurement(&measurement.name),
        Style::Limit.mark(&limits),
        words.unit(measurement.unit)
    );
    text.trim_end().to_owned()
}

/// The procedure and the step; or where it failed outside of steps, as files name it.
fn named(step: &StepRecord, words: &Words) -> String {
    let name = match words.language {
        Language::English => words.step(&step.name, [step.turn, step.turns], step.kind),
        Language::Korean => words.record(step),
    };
    format!("{}: {name}", step.procedure)
}

/// Attempts at steps that were not tested, and made again.
fn repeated(run: &RunDetail, words: &Words) -> String {
    let mut table = Table::headed(&[words.terminal.repeated_step, words.terminal.reason]);
    let attempts = run.steps.iter();
    let rows: Vec<_> = attempts
        .filter(|step| step.kind == StepKind::Attempt)
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    for step in rows {
        table.row([named(step, words), words.found_in(step).into_owned()]);
    }
    format!("\n\n{}", table.render())
}

/// Why steps were skipped, each reason once.
fn skipped(run: &RunDetail, words: &Words) -> String {
    let mut reasons = BTreeMap::<_, BTreeSet<(&str, Option<u32>)>>::new();
    let skipped = standing(&run.steps);
    for step in skipped.filter(|step| step.verdict == fault_db::Verdict::Skipped) {
        let steps = reasons.entry(words.found_in(step)).or_default();
        steps.insert((&step.procedure, step.place));
    }
    if reasons.is_empty() {
        return String::new();
    }
    let mut table = Table::headed(&[words.terminal.skipped_steps, words.terminal.reason]);
    for (reason, steps) in reasons {
        table.row([steps.len().to_string(), reason.into_owned()]);
    }
    format!("\n\n{}", table.render())
}

/// Procedures with their verdicts, what did not pass, and the faults found.
pub fn verdict_table(run: &RunDetail, words: &Words) -> String {
    let mut text = match run.steps[..] {
        // A unit's own log, imported, or a run that never began.
        [] => fill(words.terminal.no_steps, &[("source", &run.run.source)]),
        _ => part(run, words) + &procedures(run, words).render(),
    };
    text.push_str(&not_passed(run, words));
    text.push_str(&repeated(run, words));
    text.push_str(&skipped(run, words));
    if !run.faults.is_empty() {
        let (common, terminal) = (&words.common, &words.terminal);
        let mut table = Table::headed(&[
            common.fault,
            common.code,
            common.part,
            common.severity,
            terminal.seen,
            terminal.trace,
        ])
        .parts([2]);
        for fault in &run.faults {
            let trace = fault.trace_id.map_or_else(String::new, |id| id.short());
            table.row([
                fault.id.short(),
                format!("{} {}", fault.code, fault.code_name),
                fault.lru.clone(),
                words.severity_name(&fault.severity).to_owned(),
                fault.occurrences.to_string(),
                trace,
            ]);
        }
        text.push_str(&format!("\n\n{}", table.render()));
    }
    text.push_str(&format!("\n\n{}", summary(run, words)));
    text
}

/// What did not pass, what was made again, and the verdict.
pub fn failures(run: &RunDetail, words: &Words) -> String {
    let (failed, repeated) = (not_passed(run, words), repeated(run, words));
    format!("{failed}{repeated}\n\n{}", summary(run, words))
        .trim_start()
        .to_owned()
}

/// Steps that did not pass, each with the reason.
fn not_passed(run: &RunDetail, words: &Words) -> String {
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
    let common = &words.common;
    let mut table =
        Table::headed(&[common.verdict, common.step, words.terminal.reason]).verdicts(0);
    for step in failed {
        let verdict = words.verdict_name(from_stored(step.verdict)).to_owned();
        table.row([
            verdict,
            named(step, words),
            words.found_in(step).into_owned(),
        ]);
    }
    format!("\n\n{}", table.render())
}

fn procedures(run: &RunDetail, words: &Words) -> Table {
    let (common, terminal) = (&words.common, &words.terminal);
    let mut table = Table::headed(&[
        common.procedure,
        common.verdict,
        terminal.steps,
        terminal.passed,
        terminal.bench_time,
    ])
    .verdicts(1);
    for (procedure, mine) in by_procedure(&run.steps) {
        let counts = StepCounts::of(mine.iter().copied());
        let verdict = of_procedure(mine.iter().copied(), run.run.verdict);
        let time: i64 = mine.iter().map(|step| step.bench_time_us).sum();
        table.row([
            procedure.to_owned(),
            words.verdict_name(from_stored(verdict)).to_owned(),
            counts.planned.to_string(),
            counts.passed.to_string(),
            format!("{:.1} s", time as f64 / 1e6),
        ]);
    }
    table
}

fn summary(run: &RunDetail, words: &Words) -> String {
    let terminal = &words.terminal;
    let bench_s = run.run.bench_time_us.unwrap_or(0) as f64 / 1e6;
    let wall_s = run.run.wall_time_us.unwrap_or(0) as f64 / 1e6;
    let continued = (run.run.continues).map_or_else(String::new, |earlier| {
        let said = fill(terminal.continues, &[("run", &earlier.short())]);
        format!("\n{said}")
    });
    let came = fill(
        terminal.summary,
        &[
            ("run", &run.run.id.short()),
            ("unit", &display_text::line(&run.run.unit_serial)),
            ("steps", &count_short(&counts_of(&run.run), words)),
            ("faults", &run.faults.len()),
            ("verdict", &verdict(words.run_verdict(&run.run))),
        ],
    );
    let took = fill(
        terminal.times,
        &[
            ("bench", &format!("{bench_s:.1}")),
            ("wall", &format!("{wall_s:.2}")),
        ],
    );
    format!("{came}\n{took}{continued}")
}

/// The first line, where steps were skipped.
fn part(run: &RunDetail, words: &Words) -> String {
    let coverage = coverage_text(&Coverage::of_run(run), words);
    coverage.map_or_else(String::new, |part| {
        format!("{}: {part}\n\n", verdict(words.run_verdict(&run.run)))
    })
}
