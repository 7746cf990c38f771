//! `ptu trace`: shows recorded traces, compares them with a good unit's, replays them, and exchanges them with
//! other programs' files.

mod diff;
mod explained;
mod export;
mod plot;
mod replay;
mod show;
mod signal_text;

use clap::{Args, Subcommand};
use fault_db::{Id, Store, TraceData};

use super::Database;
use ptu_report::trace_io::Seconds;
use ptu_runs::failure::{Exit, Failure};

/// Show, explain, compare, replay and export recorded traces
#[derive(Debug, Args)]
pub struct TraceArguments {
    #[command(subcommand)]
    verb: Verb,
    #[command(flatten)]
    database: Database,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Show a trace and where it parts from what was expected: an id, its beginning or end (at least 4
    /// digits), or `latest`
    Show(show::ShowArguments),
    Diff(diff::DiffArguments),
    Replay(replay::ReplayArguments),
    Export(export::ExportArguments),
}

/// Which part of a trace.
#[derive(Debug, Args)]
pub struct PartArguments {
    /// Only these signals
    #[arg(long = "signal", value_name = "NAME[,NAME]", value_delimiter = ',')]
    pub signals: Vec<String>,
    /// Only this span, seconds from the trigger [default: all]
    #[arg(
        long,
        value_name = "FROM..TO",
        default_value = "..",
        hide_default_value = true,
        allow_hyphen_values = true
    )]
    pub window: Seconds,
}

impl TraceArguments {
    /// Shows, compares, replays or exports.
    pub fn run(self) -> Result<Exit, Failure> {
        match self.verb {
            Verb::Show(arguments) => arguments.run(&self.database.open_read_only()?),
            Verb::Diff(arguments) => arguments.run(&self.database.open_read_only()?),
            Verb::Replay(arguments) => arguments.run(&self.database),
            Verb::Export(arguments) => arguments.run(&self.database.open_read_only()?),
        }
    }
}

/// Some signals, or all where none is named, at some times.
fn read(
    store: &Store,
    asked: &str,
    signals: &[String],
    span: Seconds,
) -> Result<(Id, TraceData), Failure> {
    let id = store.resolve_trace(asked)?;
    let names: Vec<&str> = signals.iter().map(String::as_str).collect();
    let rows = span.rows(&store.trace_head(id)?)?;
    Ok((id, store.trace_window(id, &names, rows)?))
}
