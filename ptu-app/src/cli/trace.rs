//! `ptu trace`: recorded traces.

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::{Args, Subcommand};
use fault_db::{Channel, ChannelKind, Id, Store, TraceData};
use serde_json::json;

use super::{Database, print_json, print_out};
use crate::clock::{local, rfc3339};
use crate::data;
use crate::failure::{Exit, Failure};

/// Characters of a plotted line.
const PLOT_WIDTH: usize = 60;
/// Heights of a plotted line.
const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// Show and export recorded traces
#[derive(Debug, Args)]
pub struct TraceArguments {
    #[command(subcommand)]
    verb: Verb,
    #[command(flatten)]
    database: Database,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Show a trace: an id, its beginning or end (at least 4 digits), or `latest`
    Show {
        /// The trace
        id: String,
        /// Only these signals
        #[arg(long, value_name = "NAME[,NAME]", value_delimiter = ',')]
        signals: Vec<String>,
        /// Print JSON with all samples
        #[arg(long)]
        json: bool,
    },
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
    /// Shows or exports.
    pub fn run(self) -> Result<Exit, Failure> {
        let store = self.database.open_read_only()?;
        match self.verb {
            Verb::Show { id, signals, json } => {
                let (id, trace) = read(&store, &id, &signals)?;
                if json {
                    print_json(&trace_json(id, &trace))
                } else {
                    print_out(&plot(id, &trace))
                }
            }
            Verb::Export { id, to, signals } => {
                if to.extension().is_none_or(|ending| ending != "csv") {
                    return Err(Failure::usage("the file to export to must end in .csv"));
                }
                let (id, trace) = read(&store, &id, &signals)?;
                data::write(&to, &csv(&trace))?;
                let rows = trace.rows();
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

fn trace_json(id: Id, trace: &TraceData) -> serde_json::Value {
    let channel = |(channel, column): (&Channel, &Vec<f64>)| {
        let samples: Vec<_> = column.iter().map(|v| (!v.is_nan()).then_some(*v)).collect();
        json!({
            "name": channel.name, "unit": channel.unit, "kind": channel.kind, "samples": samples,
        })
    };
    json!({
        "id": id.to_string(),
        "t0": rfc3339(trace.t0_us),
        "t0_bench_s": trace.t0_bench_us as f64 / 1e6,
        "period_ms": trace.period_us as f64 / 1e3,
        "rows": trace.rows(),
        "trigger_row": trace.trigger_row,
        "partial": trace.partial,
        "channels": trace.channels.iter().zip(&trace.columns).map(channel).collect::<Vec<_>>(),
    })
}

/// One line a channel: range and a plot that shows each part's extreme.
fn plot(id: Id, trace: &TraceData) -> String {
    let rows = trace.rows();
    let seconds = |rows: usize| rows as f64 * trace.period_us as f64 / 1e6;
    let trigger = trace.trigger_row.unwrap_or(0) as usize;
    let mut text = format!(
        "trace {id}\nbegins {}, {rows} rows, {:.1} s before the trigger and {:.1} s after{}\n",
        local(trace.t0_us),
        seconds(trigger),
        seconds(rows.saturating_sub(trigger + 1)),
        if trace.partial { ", cut short" } else { "" }
    );
    let width = trace
        .channels
        .iter()
        .map(|c| c.name.len())
        .max()
        .unwrap_or(0);
    let mark = trigger * PLOT_WIDTH / rows.max(1);
    let _ = writeln!(text, "{:width$}  {:mark$}▼", "", "");
    for (channel, column) in trace.channels.iter().zip(&trace.columns) {
        let known = || column.iter().copied().filter(|v| !v.is_nan());
        let (low, high) = (
            known().fold(f64::MAX, f64::min),
            known().fold(f64::MIN, f64::max),
        );
        let range = if low > high {
            "not known".into()
        } else if low == high {
            named(channel, low)
        } else {
            format!("{} .. {}", named(channel, low), named(channel, high))
        };
        let _ = writeln!(
            text,
            "{:width$}  {}  {range}",
            channel.name,
            bars(column, low, high)
        );
    }
    text.trim_end().to_owned()
}

fn bars(column: &[f64], low: f64, high: f64) -> String {
    let part = |i: usize| {
        let (from, to) = (
            i * column.len() / PLOT_WIDTH,
            (i + 1) * column.len() / PLOT_WIDTH,
        );
        let values = &column[from..to.max(from + 1).min(column.len())];
        let value = values.iter().copied().fold(f64::NAN, f64::max);
        match value {
            value if value.is_nan() => ' ',
            _ if high <= low => BARS[0],
            value => BARS[((value - low) / (high - low) * 7.0).round() as usize],
        }
    };
    (0..PLOT_WIDTH).map(part).collect()
}

fn named(channel: &Channel, value: f64) -> String {
    match &channel.kind {
        ChannelKind::Enum { labels } => labels
            .get(&(value as i64))
            .cloned()
            .unwrap_or_else(|| value.to_string()),
        ChannelKind::Bit => value.to_string(),
        ChannelKind::Number { .. } => {
            format!("{} {}", (value * 1000.0).round() / 1000.0, channel.unit)
                .trim_end()
                .to_owned()
        }
    }
}

/// Time in seconds from the trigger, then a column a channel; an unknown sample is empty.
fn csv(trace: &TraceData) -> String {
    let mut text = String::from("time_s");
    for channel in &trace.channels {
        let unit = channel.unit.replace('/', "");
        let _ = match unit.as_str() {
            "" => write!(text, ",{}", channel.name),
            unit => write!(text, ",{}_{unit}", channel.name),
        };
    }
    let trigger = i64::from(trace.trigger_row.unwrap_or(0));
    for row in 0..trace.rows() {
        let time_us = (row as i64 - trigger) * trace.period_us;
        let _ = write!(text, "\n{:.3}", time_us as f64 / 1e6);
        for column in &trace.columns {
            let value = column[row];
            let _ = if value.is_nan() {
                write!(text, ",")
            } else {
                write!(text, ",{value}")
            };
        }
    }
    text.push('\n');
    text
}
