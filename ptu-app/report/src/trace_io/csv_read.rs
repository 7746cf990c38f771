//! Imports comma-separated values: our own exports, or any table with a column of times.

use std::cell::Cell;
use std::collections::HashSet;
use std::io::{self, BufRead, Read};
use std::path::Path;
use std::rc::Rc;

use csv::{ByteRecord, Reader, ReaderBuilder};
use fault_db::{Channel, open_regular_file, read_regular_file};
use serde_json::Value;

use super::about::TraceInfo;
use super::csv::beside;
use super::known::{Known, KnownSignals};
use super::series::{Import, Table, check_size, in_order, plain, wrong};
use super::times::{Columns, TimeUnit};
use super::utf16::text;
use ptu_runs::failure::{Failure, FileTrouble};
use ptu_runs::whole_file::LONGEST_FILE;

/// Longest line of a table, bytes. A line may be longer by what the CSV library reads at once.
const MAX_LINE: u64 = 1 << 20;
/// Most lines before the first row of a table, in which a recorder describes itself.
const MOST_BEFORE: usize = 1_000;
/// Most cells kept for a suggestion where no column has the name that a person gave for the times.
const MAX_SEEN: usize = 500;
/// Number of lines from which the separator is found.
const LOOKED_AT: usize = 50;

/// Reads a file: what a recorder says of itself, headings, perhaps units, then a row a line; separated by comma, semicolon or tab.
pub(super) fn read(file: &Path, known: &[Channel], asked: &Columns) -> Result<Import, Failure> {
    let about = about(file)?;
    let opened = open_regular_file(file);
    let opened = opened.map_err(|error| Failure::usage(FileTrouble::unread(file, error)))?;
    let own = about.as_ref().map_or(&[][..], |about| &about.channels);
    let (table, is_utc) = read_table(
        file,
        opened,
        &KnownSignals::of(&[own, known], &asked.names),
        asked,
    )?;
    Ok(Import {
        tables: vec![table],
        is_utc,
        about,
    })
}

/// Content of the description beside the file, if there is one.
fn about(file: &Path) -> Result<Option<TraceInfo>, Failure> {
    let beside = beside(file);
    let text = match read_regular_file(&beside, LONGEST_FILE) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => {
            return Err(Failure::usage(FileTrouble::unread(&beside, error)));
        }
    };
    let document: Value =
        serde_json::from_slice(&text).map_err(|error| wrong(&beside, &error.to_string()))?;
    // Another program's description says nothing of what is asked here.
    let note = document.get("notes").and_then(|notes| notes.get(0));
    Ok(note.and_then(|note| serde_json::from_value(note.clone()).ok()))
}

/// The records of a table, one by one.
struct Records<'f, R> {
    file: &'f Path,
    input: Reader<Watched<R>>,
    /// Bytes that were read since the last record.
    since: Rc<Cell<u64>>,
    record: ByteRecord,
    cells: Vec<String>,
    /// Line at which the record that was read last began.
    line: u64,
    separator: u8,
}

/// Refuses a record without an end: a quotation mark that is not closed makes one record of a whole file.
struct Watched<R> {
    input: R,
    since: Rc<Cell<u64>>,
}

impl<R: Read> Read for Watched<R> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        if self.since.get() > MAX_LINE {
            return Err(io::Error::other(
                "longer than a line of a table can be, or a quotation mark is not closed",
            ));
        }
        let read = self.input.read(to)?;
        self.since.set(self.since.get() + read as u64);
        Ok(read)
    }
}

impl<'f, R: BufRead> Records<'f, R> {
    fn new(file: &'f Path, mut input: R) -> Result<Self, Failure> {
        let begin = input
            .fill_buf()
            .map_err(|error| wrong(file, &error.to_string()))?;
        let separator = separator(&String::from_utf8_lossy(begin));
        let since = Rc::new(Cell::new(0));
        let watched = Watched {
            input,
            since: since.clone(),
        };
        let mut form = ReaderBuilder::new();
        form.delimiter(separator).has_headers(false).flexible(true);
        Ok(Self {
            file,
            input: form.comment(Some(b'#')).from_reader(watched),
            since,
            record: ByteRecord::new(),
            cells: Vec::new(),
            line: 0,
            separator,
        })
    }

    /// Reads the next record that is not empty, false at the end of the file; bytes that are not UTF-8 are Latin-1.
    fn next(&mut self) -> Result<bool, Failure> {
        loop {
            self.since.set(0);
            let more = self.input.read_byte_record(&mut self.record);
            if !more.map_err(|error| self.unread(&error.to_string()))? {
                return Ok(false);
            }
            self.cells.clear();
            for cell in &self.record {
                let text = std::str::from_utf8(cell).map_or_else(
                    |_| cell.iter().copied().map(char::from).collect(),
                    str::to_owned,
                );
                self.cells.push(
                    text.trim_matches(|letter: char| {
                        letter.is_whitespace() || letter == '\u{feff}'
                    })
                    .to_owned(),
                );
            }
            if self.cells.iter().any(|cell| !cell.is_empty()) {
                let place = self.record.position();
                self.line = place.map_or(self.line, csv::Position::line);
                return Ok(true);
            }
        }
    }

    fn comma(&self) -> bool {
        self.separator != b','
    }

    /// Failure in the record that is read now.
    fn unread(&self, what: &str) -> Failure {
        wrong(self.file, &format!("after line {}: {what}", self.line))
    }

    fn wrong(&self, what: &str) -> Failure {
        wrong(self.file, &format!("line {}: {what}", self.line))
    }

    fn wrong_cell(&self, column: usize, heading: &str, what: &str) -> Failure {
        let (line, column) = (self.line, column + 1);
        let place = format!("line {line}, column {column} (\"{heading}\")");
        wrong(self.file, &format!("{place}: {what}"))
    }
}

/// Headings above the rows of a table, whose first row has been read.
struct Above {
    headings: Vec<String>,
    time: usize,
    unit: TimeUnit,
}

fn above<R: BufRead>(
    records: &mut Records<'_, R>,
    known: &KnownSignals,
    asked: &Columns,
) -> Result<Above, Failure> {
    // The headings are the last line with a known name for a column of times, whose unit may stand below. Without such
    // a name they are the line before the first that begins with a time.
    let (mut named, mut before): (Option<Above>, Option<Vec<String>>) = (None, None);
    let (mut is_last, mut seen) = (false, Vec::new());
    for _ in 0..MOST_BEFORE {
        if !records.next()? {
            break;
        }
        check_size(records.file, records.cells.len().saturating_sub(1), 0)?;
        let (cells, comma) = (&records.cells, records.comma());
        if let Some(above) = &mut named {
            let cell = cells.get(above.time).map_or("", String::as_str);
            if above.unit.time(cell, comma).is_some() {
                return Ok(named.take().expect("just seen"));
            }
            above.unit = asked.unit(&above.headings[above.time], Some(cell));
            // Units below the headings are no headings, though "second" may be one.
            if cell.parse::<TimeUnit>().is_ok() {
                is_last = false;
                continue;
            }
        }
        let headings = || cells.iter().map(String::as_str);
        if seen.len() < MAX_SEEN {
            seen.extend(cells.iter().cloned());
        }
        let is_signal = |name: &str| known.named(name).is_some();
        match asked.time(headings(), is_signal) {
            Some(time) if cells.len() > 1 => {
                is_last = true;
                let unit = asked.unit(&cells[time], None);
                named = Some(Above {
                    headings: cells.clone(),
                    time,
                    unit,
                });
            }
            _ if named.is_some() => is_last = false,
            _ => {
                let is_row =
                    asked.time.is_none() && TimeUnit::Seconds.time(&cells[0], comma).is_some();
                if let Some(headings) = before.take_if(|before| is_row && before.len() > 1) {
                    let unit = asked.unit(&headings[0], None);
                    return Ok(Above {
                        headings,
                        time: 0,
                        unit,
                    });
                }
                before = Some(cells.clone());
            }
        }
    }
    match (named, &asked.time) {
        (Some(_), _) if is_last => Err(wrong(records.file, "no rows stand below the headings")),
        (Some(above), _) => {
            let cell = records.cells.get(above.time).map_or("", String::as_str);
            let what = format!("\"{cell}\" is no time");
            Err(records.wrong_cell(above.time, &above.headings[above.time], &what))
        }
        (None, Some(time)) => Err(wrong(
            records.file,
            &Columns::no_time(time, seen.iter().map(String::as_str)),
        )),
        (None, None) if before.is_none() => Err(wrong(records.file, "it is empty")),
        (None, None) => Err(wrong(
            records.file,
            "no line of headings has rows with times below; `--time` names the column of times",
        )),
    }
}

fn read_table(
    file: &Path,
    input: impl Read,
    known: &KnownSignals,
    asked: &Columns,
) -> Result<(Table, bool), Failure> {
    let input = text(input).map_err(|error| wrong(file, &error.to_string()))?;
    let mut records = Records::new(file, input)?;
    let Above {
        mut headings,
        time,
        unit,
    } = above(&mut records, known, asked)?;
    // A program that ends each line with a separator leaves an empty heading.
    while headings.len() > 2 && headings.last().is_some_and(String::is_empty) {
        headings.pop();
    }
    let signals = signals(&records, &headings, time, known)?;
    let mut table = Table {
        times_us: Vec::new(),
        columns: vec![Vec::new(); signals.len()],
        channels: signals
            .iter()
            .map(|signal| signal.1.channel.clone())
            .collect(),
    };
    let mut is_utc = None;
    loop {
        let (cells, comma) = (&records.cells, records.comma());
        let found = cells
            .iter()
            .rposition(|cell| !cell.is_empty())
            .map_or(0, |last| last + 1);
        if found > headings.len() || cells.len() < headings.len() {
            let (found, wanted) = (found.max(cells.len().min(headings.len())), headings.len());
            return Err(records.wrong(&format!("{found} fields where the headings are {wanted}")));
        }
        let cell = &cells[time];
        let read = unit
            .time(cell, comma)
            .filter(|time| *is_utc.get_or_insert(time.is_utc) == time.is_utc);
        let Some(at) = read else {
            return Err(records.wrong_cell(
                time,
                &headings[time],
                &format!("\"{cell}\" is no time"),
            ));
        };
        table.times_us.push(at.us);
        for ((place, signal), column) in signals.iter().zip(&mut table.columns) {
            let sample = signal.sample(&cells[*place], comma);
            column.push(match sample {
                Ok(sample) => sample,
                // A column that is no signal of a trace may hold texts: such a sample is unknown.
                Err(_) if !signal.is_of_a_trace => f64::NAN,
                Err(what) => return Err(records.wrong_cell(*place, &headings[*place], &what)),
            });
        }
        check_size(file, table.columns.len(), table.samples())?;
        if !records.next()? {
            in_order(&mut table);
            return Ok((table, is_utc.unwrap_or_default()));
        }
    }
}

/// The signals of a table, with the places of their columns.
fn signals<R: BufRead>(
    records: &Records<'_, R>,
    headings: &[String],
    time: usize,
    known: &KnownSignals,
) -> Result<Vec<(usize, Known)>, Failure> {
    let (mut signals, mut names) = (Vec::new(), HashSet::new());
    for (place, heading) in headings
        .iter()
        .enumerate()
        .filter(|(place, _)| *place != time)
    {
        let mut signal = known.signal(heading);
        if !names.insert(signal.channel.name.clone()) {
            if signal.is_of_a_trace {
                return Err(records.wrong_cell(place, heading, "it comes twice"));
            }
            signal.channel = plain(&format!("{heading} (column {})", place + 1));
        }
        signals.push((place, signal));
    }
    Ok(signals)
}

/// The one of three usual separators whose number is the same in most lines.
fn separator(begin: &str) -> u8 {
    let lines = || {
        begin
            .lines()
            .filter(|line| !line.is_empty())
            .take(LOOKED_AT)
    };
    let alike = |separator: &u8| {
        let counts = lines().map(|line| line.matches(char::from(*separator)).count());
        let counts: Vec<usize> = counts.filter(|count| *count > 0).collect();
        let same = |one: &usize| counts.iter().filter(|other| *other == one).count();
        counts.iter().map(same).max().unwrap_or(0)
    };
    // Of separators equally frequent the last is taken: a comma may be a decimal one.
    [b',', b'\t', b';']
        .into_iter()
        .max_by_key(alike)
        .unwrap_or(b',')
}

#[cfg(test)]
mod tests;
