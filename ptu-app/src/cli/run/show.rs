//! How a run is shown while it goes on and at its end, and where its events go.

use std::path::PathBuf;

use clap::Args;
use fault_db::RunDetail;

use crate::console::Detail;
use crate::event_stream::StreamTarget;
use crate::verdict_table::{failures, verdict_table};
use ptu_report::words::Words;

/// How much is said, and in which form.
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
    /// Amount of detail.
    pub fn detail(&self) -> Detail {
        match (self.quiet, self.verbose) {
            (true, _) => Detail::Quiet,
            (_, true) => Detail::Verbose,
            _ => Detail::Usual,
        }
    }

    /// Where the events go, if they are asked for.
    pub fn events(&self) -> Option<StreamTarget> {
        match self.json {
            true => Some(StreamTarget::Stdout),
            false => self.events.clone().map(StreamTarget::File),
        }
    }

    /// Outcome of the run.
    pub fn verdict(&self, run: &RunDetail) -> String {
        let words = Words::shown();
        match self.quiet {
            true => failures(run, words),
            false => verdict_table(run, words),
        }
    }
}
