//! Column of a table with the times, its unit, and the times of its cells.

use std::str::FromStr;

use chrono::{DateTime, NaiveDateTime};
use ptu_runs::failure::did_you_mean;

/// Columns of a table, as a person describes them.
#[derive(Clone, Debug, Default)]
pub struct Columns {
    /// Headings, and the signals that they stand for.
    pub names: Vec<(String, String)>,
    /// Heading of the column of times; `None` = found by its name.
    pub time: Option<String>,
    /// Unit of the times; `None` = as their heading says.
    pub unit: Option<TimeUnit>,
}

/// The unit of times that are numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeUnit {
    /// s
    Seconds,
    /// ms
    Milliseconds,
    /// µs
    Microseconds,
    /// ns
    Nanoseconds,
}

/// A time, µs: since 1970 (UTC), or from the trigger.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Time {
    pub us: i64,
    pub is_utc: bool,
}

/// Beginnings of the heading of a column of times.
const HEADINGS: [&str; 9] = [
    "time",
    "t",
    "timestamp",
    "x",
    "second",
    "seconds",
    "sec",
    "date",
    "datetime",
];
/// Forms of dates without a zone, which are taken for UTC.
const DATES: [&str; 2] = ["%Y-%m-%dT%H:%M:%S%.f", "%Y-%m-%d %H:%M:%S%.f"];

impl Columns {
    /// Index of the column of times: of the heading that a person named, else of the first heading that is a name of
    /// times and of no signal.
    pub(super) fn time<'a>(
        &self,
        mut headings: impl Iterator<Item = &'a str>,
        is_signal: impl Fn(&str) -> bool,
    ) -> Option<usize> {
        match &self.time {
            Some(time) => headings.position(|heading| heading == time),
            None => headings.position(|heading| is_time(heading) && !is_signal(heading)),
        }
    }

    /// Sentence which says that no column has the name given for the times.
    pub(super) fn no_time<'a>(time: &str, headings: impl Iterator<Item = &'a str>) -> String {
        let near = did_you_mean(time, headings);
        format!("no column is called \"{time}\"{near}")
    }

    /// Unit of a column of times, as a person said, else the cell `below` the heading, else the heading; else seconds.
    pub(super) fn unit(&self, heading: &str, below: Option<&str>) -> TimeUnit {
        let told = |text: &str| words(text).last().and_then(|word| word.parse().ok());
        let unit = self.unit.or_else(|| below.and_then(told));
        unit.or_else(|| told(heading)).unwrap_or(TimeUnit::Seconds)
    }
}

impl TimeUnit {
    /// A number of this unit as microseconds; `None` where an `i64` does not hold it.
    pub(super) fn us(self, number: f64) -> Option<i64> {
        let us = match self {
            Self::Seconds => number * 1e6,
            Self::Milliseconds => number * 1e3,
            Self::Microseconds => number,
            Self::Nanoseconds => number / 1e3,
        };
        (us.abs() < 9e18).then(|| us.round() as i64)
    }

    /// Time of a cell: a number of this unit, or a date.
    pub(super) fn time(self, cell: &str, comma: bool) -> Option<Time> {
        if let Some(number) = number(cell, comma) {
            let is_utc = false;
            return Some(Time {
                us: self.us(number)?,
                is_utc,
            });
        }
        let with_zone = DateTime::parse_from_rfc3339(cell).map(|date| date.to_utc());
        let date = with_zone.ok().or_else(|| {
            let mut read = DATES
                .iter()
                .map(|form| NaiveDateTime::parse_from_str(cell, form));
            Some(read.find_map(Result::ok)?.and_utc())
        });
        let us = date?.timestamp_micros();
        Some(Time { us, is_utc: true })
    }
}

impl FromStr for TimeUnit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "s" | "sec" | "second" | "seconds" => Ok(Self::Seconds),
            "ms" => Ok(Self::Milliseconds),
            "us" | "µs" | "μs" => Ok(Self::Microseconds),
            "ns" => Ok(Self::Nanoseconds),
            _ => Err(format!("\"{text}\" is no unit of time: s, ms, us or ns")),
        }
    }
}

/// A number; with a decimal comma if `comma` permits one.
pub(super) fn number(cell: &str, comma: bool) -> Option<f64> {
    let with_point = || cell.replacen(',', ".", 1).parse().ok();
    cell.parse()
        .ok()
        .or_else(|| comma.then(with_point).flatten())
}

fn is_time(heading: &str) -> bool {
    words(heading)
        .first()
        .is_some_and(|word| HEADINGS.contains(&word.as_str()))
}

fn words(text: &str) -> Vec<String> {
    text.split(|letter: char| !letter.is_alphanumeric())
        .filter(|word| !word.is_empty())
        .map(str::to_lowercase)
        .collect()
}
