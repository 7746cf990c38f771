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
use fault_db::{Id, Store, TraceData, TraceSummary};
use serde_json::{Value, json};

use super::output::Form;
use super::{Database, at_least_one};
use ptu_report::trace_io::Seconds;
use ptu_report::words::Words;
use ptu_runs::clock::{local, rfc3339};
use ptu_runs::failure::{Exit, Failure, Unknown, did_you_mean};
use ptu_runs::table::Table;

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
    /// List traces, newest first
    List {
        /// At most N traces
        #[arg(long, value_name = "N", default_value_t = 50, value_parser = at_least_one())]
        limit: u32,
        #[command(flatten)]
        form: Form,
    },
    /// Show a trace and where it deviates from what was expected: an id, its beginning or end (at least 4 digits), or
    /// `latest`
    Show(show::ShowArguments),
    Diff(diff::DiffArguments),
    Replay(replay::ReplayArguments),
    Export(export::ExportArguments),
}

/// Options that choose a part of a trace.
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
    pub fn run(self) -> Result<Exit, Failure> {
        match self.verb {
            Verb::List { limit, form } => {
                let traces = self.database.open_read_only()?.newest_traces(limit)?;
                let rows: Vec<_> = traces.iter().map(listed).collect();
                form.print(&rows, || table(&traces))
            }
            Verb::Show(arguments) => arguments.run(&self.database.open_read_only()?),
            Verb::Diff(arguments) => arguments.run(&self.database.open_read_only()?),
            Verb::Replay(arguments) => arguments.run(&self.database),
            Verb::Export(arguments) => arguments.run(&self.database.open_read_only()?),
        }
    }
}

fn listed(trace: &TraceSummary) -> Value {
    json!({
        "id": trace.id.to_string(), "run_id": trace.run_id.to_string(), "t0": rfc3339(trace.t0_us),
        "period_ms": trace.period_us as f64 / 1e3, "rows": trace.rows, "occurrences": trace.occurrences,
    })
}

fn table(traces: &[TraceSummary]) -> String {
    let words = Words::shown();
    let terminal = &words.terminal;
    if traces.is_empty() {
        return terminal.no_traces.into();
    }
    let (run, length) = (words.common.run, terminal.length);
    let mut table = Table::headed(&[
        terminal.trace,
        terminal.begins,
        run,
        length,
        terminal.faults,
    ])
    .right([3, 4]);
    for trace in traces {
        let length_s = f64::from(trace.rows) * trace.period_us as f64 / 1e6;
        table.row([
            trace.id.short(),
            local(trace.t0_us),
            trace.run_id.short(),
            format!("{length_s:.1} s"),
            trace.occurrences.to_string(),
        ]);
    }
    table.render()
}

/// Reads the named signals of a trace, or all signals where none is named, within a span.
fn read(
    store: &Store,
    asked: &str,
    signals: &[String],
    span: Seconds,
) -> Result<(Id, TraceData), Failure> {
    let id = store.resolve_trace(asked)?;
    let head = store.trace_head(id)?;
    for asked in signals {
        let mut known = head.channels.iter().map(|channel| channel.name.as_str());
        if !known.any(|name| name == asked) {
            let known = head.channels.iter().map(|channel| channel.name.as_str());
            let near = did_you_mean(asked, known);
            return Err(Failure::usage(Unknown::Signal(asked.clone(), near)));
        }
    }
    let names: Vec<&str> = signals.iter().map(String::as_str).collect();
    let rows = span.rows(&head)?;
    Ok((id, store.trace_window(id, &names, rows)?))
}
