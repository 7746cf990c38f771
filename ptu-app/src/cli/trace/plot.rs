//! A trace as lines of text.

use std::fmt::Write as _;

use fault_db::{Id, TraceData};
use unicode_width::UnicodeWidthStr as _;

use super::signal_text::named;
use ptu_runs::clock::local;
use ptu_runs::table::{cell, padded};

/// Characters of a plotted line.
const PLOT_WIDTH: usize = 60;
/// Signals shown side by side.
const LANES: usize = 12;
/// Widest name of a signal, in columns.
const WIDEST_NAME: usize = 60;
/// Heights of a plotted line.
const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// One line a channel: range and a plot that shows each part's extreme.
pub fn plot(id: Id, trace: &TraceData) -> String {
    let rows = trace.rows();
    let seconds = |rows: usize| rows as f64 * trace.period_us as f64 / 1e6;
    let trigger = trace.trigger_row.map(|row| row as usize);
    let long = match trigger {
        Some(row) => format!(
            "{:.1} s before the trigger and {:.1} s after",
            seconds(row),
            seconds(rows.saturating_sub(row + 1))
        ),
        // A part of a trace.
        None => format!("{:.1} s, without the trigger", seconds(rows)),
    };
    let mut text = format!(
        "trace {id}\nbegins {}, {rows} rows, {long}{}\n",
        local(trace.t0_us),
        if trace.partial { ", cut short" } else { "" }
    );
    let names = trace
        .channels
        .iter()
        .map(|channel| cell(&channel.name, WIDEST_NAME));
    let names: Vec<_> = names.collect();
    let width = names.iter().map(|name| name.width()).max().unwrap_or(0);
    if let Some(row) = trigger {
        let mark = row * PLOT_WIDTH / rows.max(1);
        let _ = writeln!(text, "{:width$}  {:mark$}▼", "", "");
    }
    for ((channel, name), column) in trace.channels.iter().zip(&names).zip(&trace.columns) {
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
            "{}  {}  {range}",
            padded(name, width),
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

/// Two lines a signal, what came above what was expected, on one scale and aligned at the triggers.
pub fn lanes(came: &TraceData, expected: &TraceData, names: &[&str]) -> String {
    let rows = came.rows();
    let trigger = came.trigger_row.unwrap_or(0) as usize;
    let shown = names.iter().map(|name| cell(name, WIDEST_NAME).width());
    let width = shown.max().unwrap_or(0);
    let mark = trigger * PLOT_WIDTH / rows.max(1);
    let mut text = format!("{:width$}           {:mark$}▼\n", "", "");
    for name in names.iter().take(LANES) {
        let channel = came.channels.iter().find(|channel| channel.name == **name);
        let columns = came.column(name).zip(expected.column(name));
        let (Some(channel), Some((ours, theirs))) = (channel, columns) else {
            continue;
        };
        let shift = i64::from(expected.trigger_row.unwrap_or(0)) - trigger as i64;
        let theirs: Vec<f64> = (0..rows as i64)
            .map(|row| usize::try_from(row + shift).ok())
            .map(|row| {
                row.and_then(|row| theirs.get(row))
                    .copied()
                    .unwrap_or(f64::NAN)
            })
            .collect();
        let known = || ours.iter().chain(&theirs).copied().filter(|v| !v.is_nan());
        let (low, high) = (
            known().fold(f64::MAX, f64::min),
            known().fold(f64::MIN, f64::max),
        );
        let range = format!("{} .. {}", named(channel, low), named(channel, high));
        let _ = writeln!(
            text,
            "{}  came     {}  {range}",
            padded(&cell(name, WIDEST_NAME), width),
            bars(ours, low, high)
        );
        let _ = writeln!(text, "{:width$}  expected {}", "", bars(&theirs, low, high));
    }
    if names.len() > LANES {
        let _ = writeln!(
            text,
            "and {} more; choose with --signal",
            names.len() - LANES
        );
    }
    text.trim_end().to_owned()
}
