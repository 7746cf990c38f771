//! `ptu trace`: recorded traces, what was expected beside what came, and the same again.

mod diff;
mod explained;
mod plot;
mod replay;
mod show;
mod words;

use std::path::PathBuf;

use clap::{Args, Subcommand};
use fault_db::{Id, Store, TraceData};

use super::{Database, print_out};
use crate::data;
use crate::failure::{Exit, Failure};
use crate::trace_view::csv::csv;

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
    /// Write a trace to a .csv file
    Export {
        /// The trace
        id: String,
        /// The file
        #[arg(long, value_name = "FILE.csv")]
        to: PathBuf,
        /// Only these signals
        #[arg(long, value_name = "NAME[,NAME]", value_delimiter = ',')]
        signals: Vec<String>,
    },
}

impl TraceArguments {
    /// Shows, compares, replays or exports.
    pub fn run(self) -> Result<Exit, Failure> {
        match self.verb {
            Verb::Show(arguments) => arguments.run(&self.database.open_read_only()?),
            Verb::Diff(arguments) => arguments.run(&self.database.open_read_only()?),
            Verb::Replay(arguments) => arguments.run(&self.database),
            Verb::Export { id, to, signals } => {
                if to.extension().is_none_or(|ending| ending != "csv") {
                    return Err(Failure::usage("the file to export to must end in .csv"));
                }
                let (id, trace) = read(&self.database.open_read_only()?, &id, &signals)?;
                let rows = trace.rows();
                let channels: Vec<_> = (0..trace.channels.len()).collect();
                data::write(&to, csv(&trace, &channels, 0..rows, None))?;
                print_out(&format!(
                    "trace {}: {rows} rows to {}",
                    id.short(),
                    to.display()
                ))
            }
        }
    }
}

fn read(store: &Store, asked: &str, signals: &[String]) -> Result<(Id, TraceData), Failure> {
    let id = store.resolve_trace(asked)?;
    let trace = if signals.is_empty() {
        store.trace(id)?
    } else {
        store.trace_channels(id, &signals.iter().map(String::as_str).collect::<Vec<_>>())?
    };
    Ok((id, trace))
}
