//! A trace as lines of text.

use std::fmt::Write as _;

use fault_db::{Id, TraceData};
use unicode_width::UnicodeWidthStr as _;

use super::signal_text::named;
use crate::sparkline::BARS;
use ptu_report::words::{Words, fill};
use ptu_runs::clock::local;
use ptu_runs::table::{cell, padded};

/// Width of a plotted line, characters.
const PLOT_WIDTH: usize = 60;
/// Most signals that are shown side by side.
const LANES: usize = 12;
/// Greatest width of a signal's name, columns.
const WIDEST_NAME: usize = 60;

/// A line for each signal: a plot whose bars are the greatest value of their part of the trace, and the range.
pub fn plot(id: Id, trace: &TraceData) -> String {
    let rows = trace.rows();
    let seconds = |rows: usize| rows as f64 * trace.period_us as f64 / 1e6;
    let trigger = trace.trigger_row.map(|row| row as usize);
    let words = Words::shown();
    let terminal = &words.terminal;
    let tenths = |rows: usize| format!("{:.1}", seconds(rows));
    let mut long = match trigger {
        Some(row) => fill(
            terminal.of_trigger,
            &[
                ("before", &tenths(row)),
                ("after", &tenths(rows.saturating_sub(row + 1))),
            ],
        ),
        // A part of a trace without its trigger.
        None => fill(terminal.without_trigger, &[("n", &tenths(rows))]),
    };
    if trace.partial {
        long += terminal.cut_short;
    }
    let begins = local(trace.t0_us);
    let of = [
        ("at", &begins as _),
        ("rows", &rows as _),
        ("long", &long as _),
    ];
    let begins = fill(terminal.begins_at, &of);
    let mut text = format!("{} {id}\n{begins}\n", terminal.trace);
    let names = trace
        .channels
        .iter()
        .map(|channel| cell(&words.signal(&channel.name), WIDEST_NAME));
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
            words.faults.not_known.into()
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

/// Two lines for each signal, the recorded above the expected values, on one scale and aligned at the triggers.
pub fn lanes(came: &TraceData, expected: &TraceData, names: &[&str]) -> String {
    let words = Words::shown();
    let terminal = &words.terminal;
    let sides = [terminal.came, terminal.expected];
    let side = sides.iter().map(|side| side.width()).max().unwrap_or(0);
    let rows = came.rows();
    let trigger = came.trigger_row.unwrap_or(0) as usize;
    let shown = |name: &str| cell(&words.signal(name), WIDEST_NAME);
    let width = names
        .iter()
        .map(|name| shown(name).width())
        .max()
        .unwrap_or(0);
    let mark = trigger * PLOT_WIDTH / rows.max(1);
    let mut text = format!("{:width$}  {:side$} {:mark$}▼\n", "", "", "");
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
            "{}  {} {}  {range}",
            padded(&shown(name), width),
            padded(sides[0], side),
            bars(ours, low, high)
        );
        let expected = padded(sides[1], side);
        let _ = writeln!(
            text,
            "{:width$}  {expected} {}",
            "",
            bars(&theirs, low, high)
        );
    }
    if names.len() > LANES {
        let more = names.len() - LANES;
        let _ = writeln!(text, "{}", fill(terminal.choose_signals, &[("n", &more)]));
    }
    text.trim_end().to_owned()
}
