//! Imports Apache Parquet: our own exports, or any table with a column of times.

use std::fs::File;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use fault_db::{Channel, open_regular_file};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::metadata::ParquetMetaData;
use parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};
use parquet::schema::types::ColumnDescPtr;

use super::about::{NAME, TraceInfo};
use super::known::{Known, KnownSignals};
use super::parquet::UTC;
use super::parquet_pages::{check_footer, check_pages};
use super::parquet_values::Values;
use super::series::{Import, Table, check_size, in_order, wrong};
use super::times::{Columns, TimeUnit};
use ptu_runs::failure::{Failure, FileTrouble};

/// Greatest length of all pages that are read, unpacked, bytes.
const MAX_UNPACKED: u64 = 512 << 20;
/// Rows that are read from the file at once: each may hold a text as long as a page.
const AT_ONCE: usize = 16;

/// A column of the file that is a signal, or would be a signal if its values could be read.
struct Signal {
    place: usize,
    known: Known,
    /// Conversion of the values; `None` if they cannot be read, and then no trace has the signal.
    values: Option<Values>,
}

struct Times {
    place: usize,
    values: Values,
    unit: TimeUnit,
    is_utc: bool,
}

/// Reads a file: one row after the other, each column but those of times a signal.
pub(super) fn read(file: &Path, known: &[Channel], asked: &Columns) -> Result<Import, Failure> {
    let opened = open_regular_file(file)
        .map_err(|error| Failure::usage(FileTrouble::unread(file, error)))?;
    // The library panics on some pages that state a wrong length, where it could return an error.
    let read = catch_unwind(AssertUnwindSafe(|| read_table(file, opened, known, asked)));
    read.unwrap_or_else(|_| Err(wrong(file, "damaged: a page is not as it says")))
}

fn read_table(
    file: &Path,
    opened: File,
    known: &[Channel],
    asked: &Columns,
) -> Result<Import, Failure> {
    let damaged =
        |error: ParquetError| wrong(file, &format!("damaged, or no Parquet file: {error}"));
    let refused = |what: String| wrong(file, &what);
    let mut pages = opened
        .try_clone()
        .map_err(|error| refused(error.to_string()))?;
    check_footer(&mut pages).map_err(refused)?;
    let reader = SerializedFileReader::new(opened).map_err(damaged)?;
    let about = about(reader.metadata());
    let own = about.as_ref().map_or(&[][..], |about| &about.channels);
    let names = KnownSignals::of(&[own, known], &asked.names);
    let (times, columns) = columns(file, reader.metadata(), &names, asked)?;
    let mut left = MAX_UNPACKED;
    let mut table = Table {
        times_us: Vec::new(),
        channels: (columns.iter().map(|column| column.known.channel.clone())).collect(),
        columns: vec![Vec::new(); columns.len()],
    };
    for place in 0..reader.num_row_groups() {
        let group = reader.get_row_group(place).map_err(damaged)?;
        let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(usize::MAX);
        let all = rows.saturating_add(table.times_us.len());
        check_size(file, columns.len(), all.saturating_mul(columns.len() + 1))?;
        let read = columns.iter().filter(|column| column.values.is_some());
        for place in std::iter::once(times.place).chain(read.map(|column| column.place)) {
            let column = group.metadata().column(place);
            check_pages(&pages, column, &mut left).map_err(refused)?;
        }
        let before = table.times_us.len();
        read_group(&*group, before..all, (&times, &columns), &mut table)
            .map_err(|what| wrong(file, &what))?;
    }
    in_order(&mut table);
    Ok(Import {
        tables: vec![table],
        is_utc: times.is_utc,
        about,
    })
}

/// Description in a file exported by this program.
fn about(metadata: &ParquetMetaData) -> Option<TraceInfo> {
    let pairs = metadata.file_metadata().key_value_metadata()?;
    let about = pairs.iter().find(|pair| pair.key == NAME)?;
    serde_json::from_str(about.value.as_deref()?).ok()
}

/// The times, and the signals.
fn columns(
    file: &Path,
    metadata: &ParquetMetaData,
    known: &KnownSignals,
    asked: &Columns,
) -> Result<(Times, Vec<Signal>), Failure> {
    let schema = metadata.file_metadata().schema_descr();
    let all = schema.columns();
    let is_signal = |name: &str| known.named(name).is_some();
    let holds_times =
        |column: &ColumnDescPtr| matches!(Values::of(column), Ok(Values::Times { .. }));
    let headings = all.iter().map(|column| column.name());
    let place = asked.time(headings.clone(), |name| name == UTC || is_signal(name));
    let place = match (place, &asked.time) {
        (Some(place), _) => place,
        (None, Some(time)) => return Err(wrong(file, &Columns::no_time(time, headings))),
        (None, None) => all.iter().position(holds_times).unwrap_or(0),
    };
    let Some(time) = all.get(place).filter(|_| all.len() > 1) else {
        return Err(wrong(
            file,
            "a column of times and one a signal are missing",
        ));
    };
    let values = Values::of(time).map_err(|what| {
        wrong(
            file,
            &format!("column \"{}\", the times: {what}", time.path().string()),
        )
    })?;
    let (unit, is_utc) = match values {
        Values::Times { unit, is_utc } => (unit, is_utc),
        Values::Words => {
            let what = format!("column \"{}\" has no times", time.name());
            return Err(wrong(file, &what));
        }
        _ => (asked.unit(time.name(), None), false),
    };
    let mut signals = Vec::new();
    for (at, column) in all.iter().enumerate() {
        if at == place || column.name() == UTC {
            continue;
        }
        let path = column.path().string();
        let values = Values::of(column).and_then(|values| match values {
            Values::Times { .. } => Err("times are no samples".to_owned()),
            values => Ok(values),
        });
        if let (true, Err(what)) = (is_signal(&path), &values) {
            return Err(wrong(file, &format!("column \"{path}\": {what}")));
        }
        signals.push(Signal {
            place: at,
            known: known.signal(&path),
            values: values.ok(),
        });
    }
    check_size(file, signals.len(), 0)?;
    Ok((
        Times {
            place,
            values,
            unit,
            is_utc,
        },
        signals,
    ))
}

fn read_group(
    group: &dyn RowGroupReader,
    rows: Range<usize>,
    (times, columns): (&Times, &[Signal]),
    table: &mut Table,
) -> Result<(), String> {
    let reader = |place: usize| group.get_column_reader(place).map_err(|e| e.to_string());
    for (row, number) in samples(reader(times.place)?, rows.clone(), times.values, None)?
        .into_iter()
        .enumerate()
    {
        let time_us = times.unit.us(number);
        let time_us =
            time_us.ok_or_else(|| at_row(rows.start + row, &format!("{number} is no time")))?;
        table.times_us.push(time_us);
    }
    for (column, to) in columns.iter().zip(&mut table.columns) {
        let known = &column.known;
        match &column.values {
            Some(values) => {
                let read = samples(reader(column.place)?, rows.clone(), *values, Some(known));
                to.extend(
                    read.map_err(|what| format!("column \"{}\": {what}", known.channel.name))?,
                );
            }
            None => to.resize(to.len() + rows.len(), f64::NAN),
        }
    }
    Ok(())
}

/// Samples of a column; an unknown sample is NaN, and a word is a number by the words of the channel.
fn samples(
    reader: ColumnReader,
    rows: Range<usize>,
    values: Values,
    known: Option<&Known>,
) -> Result<Vec<f64>, String> {
    match reader {
        ColumnReader::DoubleColumnReader(column) => numbers(column, rows, |n| Ok(*n)),
        ColumnReader::FloatColumnReader(column) => numbers(column, rows, |n| Ok(f64::from(*n))),
        ColumnReader::Int32ColumnReader(column) => numbers(column, rows, |n| Ok(values.of_32(*n))),
        ColumnReader::Int64ColumnReader(column) => numbers(column, rows, |n| Ok(values.of_64(*n))),
        ColumnReader::BoolColumnReader(column) => numbers(column, rows, |n| Ok(f64::from(*n))),
        ColumnReader::FixedLenByteArrayColumnReader(column) => {
            numbers(column, rows, |bytes| values.of_bytes(bytes.data()))
        }
        ColumnReader::ByteArrayColumnReader(column) if values == Values::Words => {
            let known = known.ok_or("texts in place of times")?;
            numbers(column, rows, |word| {
                let word = word.as_utf8().map_err(|error| error.to_string())?;
                known
                    .sample(word, false)
                    .or_else(|what| match known.is_of_a_trace {
                        true => Err(what),
                        // A column that is no signal of a trace may hold texts: such a sample is unknown.
                        false => Ok(f64::NAN),
                    })
            })
        }
        ColumnReader::ByteArrayColumnReader(column) => {
            numbers(column, rows, |bytes| values.of_bytes(bytes.data()))
        }
        ColumnReader::Int96ColumnReader(_) => Err("its values are of 96 bits".to_owned()),
    }
}

/// Sentence on an error in a row, which a person counts from 1 at the file's beginning.
fn at_row(row: usize, what: &str) -> String {
    format!("row {}: {what}", row + 1)
}

fn numbers<T: DataType>(
    mut column: ColumnReaderImpl<T>,
    rows: Range<usize>,
    number: impl Fn(&T::T) -> Result<f64, String>,
) -> Result<Vec<f64>, String> {
    let (mut levels, mut values) = (Vec::new(), Vec::new());
    let mut samples = Vec::new();
    while samples.len() < rows.len() {
        levels.clear();
        values.clear();
        let most = AT_ONCE.min(rows.len() - samples.len());
        let (read, _, _) = column
            .read_records(most, Some(&mut levels), None, &mut values)
            .map_err(|error| error.to_string())?;
        if read == 0 {
            return Err(format!("it has {} of {} rows", samples.len(), rows.len()));
        }
        let mut values = values.iter();
        let mut next = || values.next().map_or(Ok(f64::NAN), &number);
        for row in 0..read {
            // A column that has a value in each row has no levels.
            let has_value = levels.get(row).is_none_or(|level| *level > 0);
            let sample = if has_value { next() } else { Ok(f64::NAN) };
            let sample = sample.map_err(|what| at_row(rows.start + samples.len(), &what))?;
            samples.push(sample);
        }
    }
    Ok(samples)
}

#[cfg(test)]
mod tests;
