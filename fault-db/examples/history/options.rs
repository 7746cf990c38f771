//! What is asked for on the command line.

use std::path::PathBuf;
use std::str::FromStr;

use chrono::{NaiveDate, NaiveTime};

/// What to write, and how much of it.
pub struct Options {
    pub file: PathBuf,
    pub faults: usize,
    pub runs: usize,
    pub units: usize,
    pub days: i64,
    pub until_us: i64,
    pub traces: usize,
    pub seed: u64,
}

impl Options {
    pub fn read(mut words: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut options = Self {
            file: PathBuf::new(),
            faults: 1_000_000,
            runs: 100_000,
            units: 150,
            days: 3 * 365,
            until_us: day("2026-06-30")?,
            traces: 0,
            seed: 1,
        };
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or(format!("{word} needs a value"));
            match word.as_str() {
                "--faults" => options.faults = number(&value()?)?,
                "--runs" => options.runs = number(&value()?)?,
                "--units" => options.units = number(&value()?)?,
                "--years" => options.days = number::<i64>(&value()?)? * 365,
                "--until" => options.until_us = day(&value()?)?,
                "--traces" => options.traces = number(&value()?)?,
                "--seed" => options.seed = number(&value()?)?,
                "--year" => {
                    (options.faults, options.runs, options.units) = (10_000, 3_000, 40);
                    (options.days, options.traces) = (365, 300);
                }
                _ if word.starts_with('-') => return Err(format!("{word} is not known")),
                _ => options.file = word.into(),
            }
        }
        if options.file.as_os_str().is_empty() {
            return Err("name the file to write".to_owned());
        }
        if options.file.exists() {
            return Err(format!("{} exists already", options.file.display()));
        }
        if options.units == 0 || options.runs == 0 {
            return Err("a history has at least one unit and one run".to_owned());
        }
        Ok(options)
    }
}

fn number<T: FromStr>(text: &str) -> Result<T, String> {
    text.parse()
        .map_err(|_| format!("{text} is no whole number"))
}

/// The end of a day, UTC.
fn day(text: &str) -> Result<i64, String> {
    let day: NaiveDate = text
        .parse()
        .map_err(|_| format!("{text} is no day like 2026-06-30"))?;
    Ok(day.and_time(NaiveTime::MIN).and_utc().timestamp_micros() + 86_400_000_000)
}
