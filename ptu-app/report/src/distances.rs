//! Distances of trains, by readings of their odometers that a depot keeps as `train,date,km`.
//!
//! Between two readings of a train its distance grows evenly; before the first and after the last nothing is known.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use fault_db::read_regular_file;
use ptu_runs::clock::Span;
use ptu_runs::failure::{Failure, FileTrouble, Why, WrongCell};
use ptu_runs::whole_file::LONGEST_FILE;

/// The columns, in their order.
const COLUMNS: [&str; 3] = ["train", "date", "km"];
/// No odometer has run farther, km.
const FARTHEST_KM: f64 = 1e8;

/// Readings of odometers by train.
#[derive(Debug, Default, PartialEq)]
pub struct Distances(BTreeMap<String, Vec<Reading>>);

/// Reading of an odometer at the beginning of a local day.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Reading {
    at_us: i64,
    km: f64,
}

impl Distances {
    /// Reads a file of comma-separated values with the columns train, date and km in its first line.
    ///
    /// # Errors
    /// The file cannot be read, or a value is wrong: the message names its line and column.
    pub fn read(file: &Path) -> Result<Self, Failure> {
        let text = read_regular_file(file, LONGEST_FILE)
            .map_err(|error| Failure::usage(FileTrouble::unread(file, error)))?;
        Self::parse(&String::from_utf8_lossy(&text))
            .map_err(|why| Failure::usage(FileTrouble::Wrong(file.display().to_string(), why)))
    }

    fn parse(text: &str) -> Result<Self, Why> {
        let text = text.trim_start_matches('\u{feff}');
        let mut lines = (1..).zip(text.lines());
        let heading = lines.next().map(|(_, line)| cells(line));
        if heading != Some(COLUMNS.map(str::to_owned).to_vec()) {
            return Err(Why::Heading);
        }
        let mut all = Self::default();
        for (number, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
            let wrong = |column: usize, what| {
                Why::Cell(number, 1 + column, COLUMNS[column].to_owned(), what)
            };
            let cells = cells(line);
            let Ok([train, date, km]) = <[String; 3]>::try_from(cells) else {
                return Err(Why::Values(number));
            };
            if train.is_empty() {
                return Err(wrong(0, WrongCell::Empty));
            }
            let at_us = day_us(&date).ok_or_else(|| wrong(1, WrongCell::NoDate(date)))?;
            let read = km.parse::<f64>().ok();
            let read = read.filter(|km| (0.0..=FARTHEST_KM).contains(km));
            let km = read.ok_or_else(|| wrong(2, WrongCell::NoDistance(km)))?;
            let of_train = all.0.entry(train).or_default();
            let place = of_train.partition_point(|known| known.at_us < at_us);
            let after = of_train.get(place);
            if after.is_some_and(|after| after.at_us == at_us) {
                return Err(wrong(1, WrongCell::Twice));
            }
            let before = place.checked_sub(1).and_then(|before| of_train.get(before));
            let goes_back = before.is_some_and(|before| before.km > km)
                || after.is_some_and(|after| after.km < km);
            if goes_back {
                return Err(wrong(2, WrongCell::GoesBack(km)));
            }
            of_train.insert(place, Reading { at_us, km });
        }
        Ok(all)
    }

    /// The time for which the distance of a train is known.
    pub fn span_us(&self, train: &str) -> Option<Range<i64>> {
        let readings = self.0.get(train)?;
        Some(readings.first()?.at_us..readings.last()?.at_us)
    }

    /// Distance of a train in a span, as far as its readings reach, km.
    pub fn km(&self, train: &str, span_us: &Range<i64>) -> f64 {
        let readings = self.0.get(train).map_or(&[][..], Vec::as_slice);
        let of_two = |two: &[Reading]| {
            let (from, to) = (two[0], two[1]);
            let both = span_us.start.max(from.at_us)..span_us.end.min(to.at_us);
            let share = (both.end - both.start).max(0) as f64 / (to.at_us - from.at_us) as f64;
            share * (to.km - from.km)
        };
        readings.windows(2).map(of_two).sum()
    }
}

/// The values of a line, without blanks and quotes around them.
fn cells(line: &str) -> Vec<String> {
    let cell = |cell: &str| cell.trim().trim_matches('"').to_owned();
    line.split(',').map(cell).collect()
}

/// When a local day begins.
fn day_us(date: &str) -> Option<i64> {
    let shape: String = (date.chars())
        .map(|c| if c.is_ascii_digit() { '0' } else { c })
        .collect();
    (shape == "0000-00-00")
        .then(|| date.parse::<Span>().ok()?.since_us)
        .flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 3 000 km in the 30 days of June are 100 km a day; 10 days of them are 1 000 km.
    #[test]
    fn a_train_runs_evenly_between_its_readings_and_not_beyond_them() {
        let text = "\u{feff}train,date,km\r\n\"612\", 2026-07-01 ,103000\r\n612,2026-06-01,100000\r\n\r\n613,2026-06-01,5\r\n";
        let read = Distances::parse(text).expect("readings");
        let day = |date| day_us(date).expect("a day");
        let km = |from, to| read.km("612", &(day(from)..day(to)));
        assert!((km("2026-06-11", "2026-06-21") - 1000.0).abs() < 5.0);
        assert!((km("2020-01-01", "2030-01-01") - 3000.0).abs() < 1e-6);
        assert_eq!(km("2026-07-01", "2026-08-01"), 0.0);
        assert_eq!(read.km("613", &(day("2026-01-01")..day("2027-01-01"))), 0.0);
        assert_eq!(
            read.span_us("612"),
            Some(day("2026-06-01")..day("2026-07-01"))
        );
        assert_eq!(read.span_us("614"), None);
    }

    #[test]
    fn what_is_wrong_is_told_by_line_and_column() {
        let of = |lines: &str| {
            let text = format!("train,date,km\n{lines}");
            Distances::parse(&text).expect_err("wrong").to_string()
        };
        for (lines, said) in [
            ("612,2026-06-01", "line 2: three values"),
            (",2026-06-01,1", "line 2, column 1 (train): "),
            (
                "612,2026-06-01,1\n612,30d,1",
                "line 3, column 2 (date): \"30d\"",
            ),
            ("612,2026-02-30,1", "line 2, column 2 (date): "),
            ("612,2026-06-01,1e999", "line 2, column 3 (km): "),
            ("612,2026-06-01,-1", "line 2, column 3 (km): \"-1\""),
            ("612,2026-06-01,NaN", "line 2, column 3 (km): "),
            (
                "612,2026-06-01,9\n612,2026-06-02,8",
                "line 3, column 3 (km): 8 does not fit",
            ),
            (
                "612,2026-06-01,9\n612,2026-06-01,9",
                "line 3, column 2 (date): ",
            ),
        ] {
            let why = of(lines);
            assert!(why.starts_with(said), "{lines}: {why}");
        }
        let heading = Distances::parse("Zug;Tag;km\n").expect_err("wrong");
        let heading = heading.to_string();
        assert!(heading.starts_with("line 1: "), "{heading}");
        assert!(Distances::parse("").is_err());
    }
}
