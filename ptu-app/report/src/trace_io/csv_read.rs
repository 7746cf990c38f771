//! Imports comma-separated values: our own exports, or any table with times in its first column.

use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use fault_db::{Channel, open_regular_file, read_regular_file};
use serde_json::Value;

use super::about::TraceInfo;
use super::csv::beside;
use super::known::KnownSignals;
use super::series::{Import, Table, check_size, wrong};
use ptu_runs::data::LONGEST_FILE;
use ptu_runs::failure::Failure;

/// A longer line is none of a table of signals.
const MAX_LINE: u64 = 1 << 20;

/// Reads a file: headings in the first line, seconds in the first column, separated by comma, semicolon or
/// tab.
pub(super) fn read(file: &Path, known: &[Channel]) -> Result<Import, Failure> {
    let about = about(file)?;
    let opened = open_regular_file(file);
    let opened = opened
        .map_err(|error| Failure::usage(format!("cannot read {}: {error}", file.display())))?;
    let mut lines = Lines {
        file,
        input: BufReader::new(opened),
        number: 0,
        bytes: Vec::new(),
    };
    let own = about.as_ref().map_or(&[][..], |about| &about.channels);
    let table = read_table(&mut lines, &KnownSignals::of(&[own, known]))?;
    Ok(Import {
        tables: vec![table],
        is_utc: false,
        about,
    })
}

/// What stands in the description beside, if there is one.
fn about(file: &Path) -> Result<Option<TraceInfo>, Failure> {
    let beside = beside(file);
    let text = match read_regular_file(&beside, LONGEST_FILE) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => {
            let what = format!("cannot read {}: {error}", beside.display());
            return Err(Failure::usage(what));
        }
    };
    let document: Value =
        serde_json::from_slice(&text).map_err(|error| wrong(&beside, &error.to_string()))?;
    // Another program's description says nothing of what is asked here.
    let note = document.get("notes").and_then(|notes| notes.get(0));
    Ok(note.and_then(|note| serde_json::from_value(note.clone()).ok()))
}

struct Lines<'f, R> {
    file: &'f Path,
    input: R,
    number: usize,
    bytes: Vec<u8>,
}

impl<R: BufRead> Lines<'_, R> {
    /// The next line that has something in it.
    fn next(&mut self) -> Result<Option<&str>, Failure> {
        loop {
            self.bytes.clear();
            self.number += 1;
            let read = (&mut self.input)
                .take(MAX_LINE)
                .read_until(b'\n', &mut self.bytes)
                .map_err(|error| {
                    Failure::usage(format!("cannot read {}: {error}", self.file.display()))
                })?;
            if read == 0 {
                return Ok(None);
            }
            if read as u64 == MAX_LINE {
                return Err(self.wrong("it is longer than a line of a table can be"));
            }
            if !self.bytes.trim_ascii().is_empty() {
                break;
            }
        }
        match std::str::from_utf8(&self.bytes) {
            Ok(line) => {
                let line = line.trim_end_matches(['\r', '\n']);
                // A mark some programs begin their files with.
                Ok(Some(line.strip_prefix('\u{feff}').unwrap_or(line)))
            }
            Err(_) => Err(self.wrong("it is not UTF-8")),
        }
    }

    fn wrong(&self, what: &str) -> Failure {
        wrong(self.file, &format!("line {}: {what}", self.number))
    }

    fn wrong_cell(&self, column: usize, heading: &str, what: &str) -> Failure {
        let place = format!("column {} (\"{heading}\")", column + 1);
        wrong(self.file, &format!("line {}, {place}: {what}", self.number))
    }
}

fn read_table<R: BufRead>(
    lines: &mut Lines<'_, R>,
    known: &KnownSignals,
) -> Result<Table, Failure> {
    let file = lines.file;
    let Some(line) = lines.next()? else {
        return Err(wrong(file, "it is empty"));
    };
    let separator = separator(line);
    let headings =
        fields(line, separator).map_err(|what| wrong(file, &format!("line 1: {what}")))?;
    if headings.len() < 2 {
        let what = "headings are missing: times, then a column a signal";
        return Err(lines.wrong(what));
    }
    check_size(file, headings.len() - 1, 0)?;
    let signals: Vec<_> = headings[1..]
        .iter()
        .map(|heading| known.signal(heading))
        .collect();
    let mut names = BTreeSet::new();
    for (place, signal) in signals.iter().enumerate() {
        if !names.insert(signal.channel.name.as_str()) {
            return Err(lines.wrong_cell(place + 1, &headings[place + 1], "it comes twice"));
        }
    }
    let mut table = Table {
        times_us: Vec::new(),
        columns: vec![Vec::new(); signals.len()],
        channels: signals
            .iter()
            .map(|signal| signal.channel.clone())
            .collect(),
    };
    let mut cells = Vec::new();
    loop {
        let Some(line) = lines.next()? else {
            return Ok(table);
        };
        let read = fields(line, separator);
        cells.clear();
        cells.extend(read.map_err(|what| lines.wrong(what))?);
        if cells.len() != headings.len() {
            let (found, wanted) = (cells.len(), headings.len());
            return Err(lines.wrong(&format!("{found} fields where the headings are {wanted}")));
        }
        let time_us =
            time_us(&cells[0]).map_err(|what| lines.wrong_cell(0, &headings[0], &what))?;
        if table.times_us.last().is_some_and(|last| *last > time_us) {
            return Err(lines.wrong_cell(0, &headings[0], "it is earlier than the line before"));
        }
        table.times_us.push(time_us);
        for (place, cell) in cells[1..].iter().enumerate() {
            let sample = signals[place].sample(cell);
            let wrong = |what: String| lines.wrong_cell(place + 1, &headings[place + 1], &what);
            table.columns[place].push(sample.map_err(wrong)?);
        }
        check_size(file, table.columns.len(), table.samples())?;
    }
}

/// The one of the usual three that the headings have most of.
fn separator(line: &str) -> char {
    let count = |separator: &char| line.matches(*separator).count();
    // Of equals the last is taken.
    [';', '\t', ',']
        .into_iter()
        .max_by_key(count)
        .unwrap_or(',')
}

fn fields(line: &str, separator: char) -> Result<Vec<String>, &'static str> {
    let mut fields = Vec::new();
    let mut field = String::new();
    let mut quoted = false;
    let mut letters = line.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            '"' if quoted && letters.peek() == Some(&'"') => {
                letters.next();
                field.push('"');
            }
            '"' if quoted || field.trim().is_empty() => quoted = !quoted,
            _ if letter == separator && !quoted => {
                fields.push(std::mem::take(&mut field).trim().to_owned());
            }
            _ => field.push(letter),
        }
    }
    if quoted {
        return Err("a quotation mark is not closed");
    }
    fields.push(field.trim().to_owned());
    Ok(fields)
}

fn time_us(cell: &str) -> Result<i64, String> {
    let seconds = cell.parse::<f64>().ok();
    let time_us = seconds.and_then(whole_us);
    time_us.ok_or_else(|| format!("\"{cell}\" is no time in seconds"))
}

/// Seconds as microseconds, if there are as many.
pub(super) fn whole_us(seconds: f64) -> Option<i64> {
    (seconds.abs() < 9e12).then(|| (seconds * 1e6).round() as i64)
}

#[cfg(test)]
mod tests {
    use fault_db::ChannelKind;

    use super::super::series::plain;
    use super::*;

    fn read(text: &str) -> Result<Table, String> {
        let mut lines = Lines {
            file: Path::new("x.csv"),
            input: text.as_bytes(),
            number: 0,
            bytes: Vec::new(),
        };
        let mode = Channel {
            name: "mode".into(),
            unit: String::new(),
            kind: ChannelKind::Enum {
                labels: [(0, "off".to_owned()), (3, "ato".to_owned())].into(),
            },
        };
        let speed = Channel {
            unit: "km/h".into(),
            ..plain("speed")
        };
        read_table(&mut lines, &KnownSignals::of(&[&[mode, speed]]))
            .map_err(|failure| failure.message)
    }

    #[test]
    fn tables_of_other_programs_are_read() {
        let table = read("\u{feff}t;mode;\"a \"\"b\"\"\";speed_kmh\r\n0,5;;;\r\n");
        assert_eq!(
            table.expect_err("a decimal comma"),
            "x.csv: line 2, column 1 (\"t\"): \"0,5\" is no time in seconds"
        );
        let table = read("t;mode;\"a \"\"b\"\"\";speed_kmh\r\n\r\n-0.5;ato;1e3;\r\n1;0;nan;7.5");
        let table = table.expect("read");
        let names: Vec<_> = table.channels.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["mode", "a \"b\"", "speed"]);
        assert_eq!(table.times_us, [-500_000, 1_000_000]);
        assert_eq!(table.columns[0], [3.0, 0.0]);
        assert_eq!(table.columns[1][0], 1000.0);
        assert!(table.columns[1][1].is_nan() && table.columns[2][0].is_nan());
        assert_eq!(table.columns[2][1], 7.5);
    }

    #[test]
    fn errors_are_reported_with_line_and_column() {
        for (text, told) in [
            ("", "x.csv: it is empty"),
            ("only", "x.csv: line 1: headings are missing"),
            ("t,a,a\n", "line 1, column 3 (\"a\"): it comes twice"),
            ("t,a\n1\n", "line 2: 1 fields where the headings are 2"),
            ("t,a\n1,x\n", "line 2, column 2 (\"a\"): \"x\" is no number"),
            (
                "t,a\n1,1\n\n0,1\n",
                "line 4, column 1 (\"t\"): it is earlier",
            ),
            ("t,mode\n1,on\n", "\"on\" is none of off, ato"),
            ("t,a\nnan,1\n", "\"nan\" is no time"),
            ("t,a\n1e300,1\n", "\"1e300\" is no time"),
            ("t,\"a\n1,1\n", "line 1: a quotation mark is not closed"),
        ] {
            let found = read(text).expect_err(text);
            assert!(found.contains(told), "{text:?}: {found}");
        }
    }
}
