//! Exports traces as comma-separated values, with a description in a file beside.
//!
//! One line per row: the time in seconds from the trigger, then one column per signal under its name in files
//! ([`column_name`]); enumerations are words, bits numbers, an unknown sample is empty. `FILE-metadata.json` beside it says what
//! the signals are, as the W3C's "CSV on the Web" has it.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use fault_db::{Channel, ChannelKind};
use protocol::display_text;
use serde_json::{Value, json};

use super::about::TraceInfo;
use super::column::{column_name, word};
use crate::csv::{MARK, no_formula, quoted};

/// Heading of the column of times.
pub const TIME: &str = "time_s";

/// Begins a file with the line of headings; with a column of distances if the way is written.
///
/// # Errors
/// `out` fails.
pub fn put_headings<'a>(
    out: &mut impl Write,
    with_distance: bool,
    channels: impl Iterator<Item = &'a Channel>,
) -> io::Result<()> {
    write!(out, "{MARK}{TIME}")?;
    if with_distance {
        write!(out, ",distance_m")?;
    }
    for channel in channels {
        let name = column_name(channel);
        write!(out, ",{}", quoted(&display_text::line(&no_formula(&name))))?;
    }
    out.write_all(b"\n")
}

/// Writes a row: its time, µs from the trigger, in seconds to the millisecond if the period is of whole milliseconds;
/// the distance, m, if there is one; a sample of each signal.
///
/// # Errors
/// `out` fails.
pub fn put_row<'a>(
    out: &mut impl Write,
    (time_us, period_us): (i64, i64),
    distance_m: Option<f64>,
    samples: impl Iterator<Item = (&'a Channel, f64)>,
) -> io::Result<()> {
    let digits = if period_us % 1000 == 0 { 3 } else { 6 };
    write!(out, "{:.digits$}", time_us as f64 / 1e6)?;
    if let Some(distance_m) = distance_m {
        write!(out, ",{distance_m:.2}")?;
    }
    for (channel, sample) in samples {
        match word(channel, sample) {
            _ if sample.is_nan() => out.write_all(b",")?,
            Some(word) => write!(out, ",{}", quoted(&display_text::line(&no_formula(word))))?,
            None => write!(out, ",{sample}")?,
        }
    }
    out.write_all(b"\n")
}

/// The name of a CSV file's description.
pub(super) fn beside(file: &Path) -> PathBuf {
    let mut name = file.as_os_str().to_owned();
    name.push("-metadata.json");
    name.into()
}

/// The description that stands beside a file with the name `file`.
pub(super) fn description(file: &str, about: &TraceInfo) -> Value {
    let column = |channel: &Channel| {
        let datatype = match channel.kind {
            ChannelKind::Number { .. } => "double",
            ChannelKind::Enum { .. } => "string",
            ChannelKind::Bit => "integer",
        };
        json!({
            "name": column_name(channel), "titles": column_name(channel), "datatype": datatype,
            "dc:description": format!("{}, {}", channel.name, unit_told(channel)),
        })
    };
    let time = json!({
        "name": TIME, "titles": TIME, "datatype": "double", "required": true,
        "dc:description": "seconds from the trigger",
    });
    let columns: Vec<_> = std::iter::once(time)
        .chain(about.channels.iter().map(column))
        .collect();
    json!({
        "@context": "http://www.w3.org/ns/csvw",
        "url": file,
        "tableSchema": {"columns": columns},
        "notes": [about],
    })
}

fn unit_told(channel: &Channel) -> String {
    match &channel.kind {
        ChannelKind::Number { .. } if channel.unit.is_empty() => "a number".to_owned(),
        ChannelKind::Number { .. } => format!("in {}", channel.unit),
        ChannelKind::Bit => "0 or 1".to_owned(),
        ChannelKind::Enum { labels } => {
            let words = labels.iter().map(|(n, word)| format!("{n} {word}"));
            let words: Vec<_> = words.collect();
            words.join(", ")
        }
    }
}
