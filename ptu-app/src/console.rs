//! Progress of a run on the console.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, SyncSender};
use std::thread::JoinHandle;
use std::time::Duration;

use btu_rig::procedure::{Findings, Measurement, Procedure, ResultKind, RunEvent, Verdict};
use fault_db::StepKind;
use indicatif::ProgressBar;
use protocol::{display_text, lru};

use crate::operator::HOW_TO_ANSWER;
use ptu_report::limits::{limits_text, short};
use ptu_report::words::{Words, fill};
use ptu_runs::failure::{Failure, RunTrouble};
use ptu_runs::run::{LinePrinter, Listener, RunPlan, SessionEvent, steps_of};
use ptu_runs::table::{cell, padded};
use ptu_runs::terminal::{self, Style};
use ptu_runs::{progress, stdio};

/// Interval at which the clock beside the bar is drawn while nothing happens.
const TICK: Duration = Duration::from_millis(250);
/// Most lines that wait for a terminal that takes no output, as a stopped terminal; further lines are left out.
const WAITING: usize = 4096;
/// Width of the word at the beginning of a line, columns.
const LINE_BEGIN: usize = 7;
/// Greatest width of the text beside the bar, columns.
const BESIDE_BAR: usize = 100;

/// How much the console says about a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    Quiet,
    /// Also each procedure, and on a terminal the step under way.
    Usual,
    /// Also each step and each measurement.
    Verbose,
}

/// Shows progress on stderr: a bar on a terminal, elsewhere a line for each procedure. The console has a thread of its
/// own, so that neither bench nor store waits for a slow terminal.
pub struct Console {
    detail: Detail,
    /// Steps of the present procedure: number begun, number of all.
    steps: (usize, usize),
    shown: SyncSender<Shown>,
    /// Number of lines that were not printed.
    left_out: Arc<AtomicUsize>,
    thread: JoinHandle<()>,
}

enum Shown {
    /// Step under way, beside the bar.
    RunPosition(String),
    StepDone,
    Line(String),
}

impl Console {
    /// Console of a run of this plan.
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

    /// Ends the console after the run; returns when everything is printed.
    pub fn finish(self) {
        drop(self.shown);
        // A console that failed is no reason for the run to fail.
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
        let form = format!("{{bar:30}} {}", terminal.step_count);
        let bar = progress::bar(steps, &form).with_message(terminal.bringing_up);
        bar.enable_steady_tick(TICK);
        bar
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
        // If the terminal takes no output, this state is not shown, and the run goes on.
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
            // With --quiet the line of the failed step stands for the fault.
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

/// Text of a measurement: name, value, permitted range, unit.
fn measured(measurement: &Measurement, words: &Words) -> String {
    let value = measurement
        .value
        .map_or_else(|| words.report.no_value.to_owned(), short);
    let limits = match limits_text(words, measurement.low, measurement.high) {
        limit if limit.is_empty() => limit,
        limit => fill(words.terminal.allowed, &[("limit", &limit)]),
    };
    let text = format!(
        "{} = {value}{} {}",
        words.measurement(&measurement.name),
        Style::Limit.mark(&limits),
        words.unit(measurement.unit)
    );
    text.trim_end().to_owned()
}
