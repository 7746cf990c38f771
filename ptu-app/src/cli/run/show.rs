//! Options for what a run shows while it goes on and at its end, and for the files of its events.

use std::path::PathBuf;

use btu_rig::procedure::Procedure;
use clap::Args;
use fault_db::RunDetail;

use crate::console::{Console, Detail};
use crate::event_stream::{EventStream, StreamTarget};
use crate::run_recording::RunRecording;
use crate::verdict_table::{failures, verdict_table};
use ptu_report::words::Words;
use ptu_runs::failure::Failure;
use ptu_runs::run::{LinePrinter, Listener, Outcome, RunPlan, SessionEvent};

/// Options that say how much is shown, and in which form.
#[derive(Debug, Args)]
pub struct ShowOptions {
    /// Say only what did not pass, and the verdict
    #[arg(short, long, conflicts_with = "verbose")]
    quiet: bool,
    /// Say each step and each measured value with its limits
    #[arg(short, long)]
    verbose: bool,
    /// Print each event of the run as a JSON line (docs/commands.md) while it goes on; with --list, print the list as JSON
    #[arg(long, conflicts_with_all = ["check", "events"])]
    pub json: bool,
    /// Write the lines of --json to a file instead
    #[arg(long, value_name = "FILE", conflicts_with_all = ["check", "list"])]
    events: Option<PathBuf>,
    /// Record every signal and event of the run, whatever its verdict, in an MCAP file for Foxglove, PlotJuggler and others
    #[arg(long, value_name = "FILE.mcap", conflicts_with_all = ["check", "list"])]
    pub mcap: Option<PathBuf>,
}

impl ShowOptions {
    /// Begins to show a run of this plan.
    ///
    /// # Errors
    /// A file cannot be written, or the system gives no thread.
    pub fn begin(&self, plan: &RunPlan) -> Result<RunShow, Failure> {
        let events = match self.json {
            true => Some(StreamTarget::Stdout),
            false => self.events.clone().map(StreamTarget::File),
        };
        let mcap = self.mcap.as_deref();
        Ok(RunShow {
            console: Console::new(plan, self.detail())?,
            stream: events.map(EventStream::begin).transpose()?,
            recording: mcap.map(RunRecording::begin).transpose()?,
        })
    }

    fn detail(&self) -> Detail {
        match (self.quiet, self.verbose) {
            (true, _) => Detail::Quiet,
            (_, true) => Detail::Verbose,
            _ => Detail::Usual,
        }
    }

    /// Text at the end of a run: with --quiet failures and verdict, else the table of procedures.
    pub fn verdict(&self, run: &RunDetail) -> String {
        let words = Words::shown();
        match self.quiet {
            true => failures(run, words),
            false => verdict_table(run, words),
        }
    }
}

/// Everything that receives the events of a run.
pub struct RunShow {
    console: Console,
    stream: Option<EventStream>,
    recording: Option<RunRecording>,
}

impl RunShow {
    /// Ends the output after the run; says whether the stream and the recording are complete.
    pub fn finish(self, outcome: Option<&Outcome>) -> [Result<(), Failure>; 2] {
        let recorded = self.recording.map(|recording| recording.finish(outcome));
        let streamed = self.stream.map(|stream| stream.finish(outcome));
        self.console.finish();
        [streamed, recorded].map(|ended| ended.unwrap_or(Ok(())))
    }
}

impl Listener for RunShow {
    fn on_event(&mut self, procedure: &Procedure, event: &SessionEvent) {
        if let Some(recording) = &mut self.recording {
            recording.event(procedure, event);
        }
        if let Some(stream) = &mut self.stream {
            stream.event(procedure, event);
        }
        self.console.on_event(procedure, event);
    }

    fn line(&self, procedure: &Procedure, event: &SessionEvent) -> Option<String> {
        self.console.line(procedure, event)
    }

    fn line_printer(&self) -> Option<LinePrinter> {
        self.console.line_printer()
    }
}
