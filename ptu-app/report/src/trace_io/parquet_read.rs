//! Imports Apache Parquet: our own exports, or any flat table with seconds in its first column.

use std::fs::File;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use fault_db::{Channel, open_regular_file};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::metadata::ParquetMetaData;
use parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};

use super::about::{NAME, TraceInfo};
use super::csv_read::whole_us;
use super::known::{Known, KnownSignals};
use super::parquet::UTC;
use super::parquet_pages::{check_footer, check_pages};
use super::series::{Import, Table, check_size, wrong};
use ptu_runs::failure::Failure;

/// All pages that are read, unpacked.
const MAX_UNPACKED: u64 = 512 << 20;
/// Rows that are held as they come from the file: a text may be as long as a page.
const AT_ONCE: usize = 16;

/// Reads a file: one row after the other, each column but the first and that of UTC a signal.
pub(super) fn read(file: &Path, known: &[Channel]) -> Result<Import, Failure> {
    let opened = open_regular_file(file)
        .map_err(|error| Failure::usage(format!("cannot read {}: {error}", file.display())))?;
    // The library panics on some pages that say another length than they have, where it could answer.
    let read = catch_unwind(AssertUnwindSafe(|| read_table(file, opened, known)));
    read.unwrap_or_else(|_| Err(wrong(file, "damaged: a page is not as it says")))
}

fn read_table(file: &Path, opened: File, known: &[Channel]) -> Result<Import, Failure> {
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
    let columns = columns(file, reader.metadata(), &KnownSignals::of(&[own, known]))?;
    let mut left = MAX_UNPACKED;
    let mut table = Table {
        times_us: Vec::new(),
        channels: (columns.iter().map(|(_, known)| known.channel.clone())).collect(),
        columns: vec![Vec::new(); columns.len()],
    };
    for place in 0..reader.num_row_groups() {
        let group = reader.get_row_group(place).map_err(damaged)?;
        let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(usize::MAX);
        let all = rows.saturating_add(table.times_us.len());
        check_size(file, columns.len(), all.saturating_mul(columns.len() + 1))?;
        let read = std::iter::once(0).chain(columns.iter().map(|(place, _)| *place));
        for place in read {
            let column = group.metadata().column(place);
            check_pages(&pages, column, &mut left).map_err(refused)?;
        }
        read_group(&*group, rows, &columns, &mut table)
            .map_err(|what| wrong(file, &format!("rows from {}: {what}", table.times_us.len())))?;
    }
    Ok(Import {
        tables: vec![table],
        is_utc: false,
        about,
    })
}

/// What our own exports say of themselves.
fn about(metadata: &ParquetMetaData) -> Option<TraceInfo> {
    let pairs = metadata.file_metadata().key_value_metadata()?;
    let about = pairs.iter().find(|pair| pair.key == NAME)?;
    serde_json::from_str(about.value.as_deref()?).ok()
}

/// The signals, each with the place of its column.
fn columns(
    file: &Path,
    metadata: &ParquetMetaData,
    known: &KnownSignals,
) -> Result<Vec<(usize, Known)>, Failure> {
    let schema = metadata.file_metadata().schema_descr();
    let mut columns = Vec::new();
    for (place, column) in schema.columns().iter().enumerate() {
        if column.max_rep_level() > 0 || column.max_def_level() > 1 {
            let path = column.path().string();
            return Err(wrong(file, &format!("column \"{path}\" is no plain one")));
        }
        if place > 0 && column.name() != UTC {
            columns.push((place, known.signal(column.name())));
        }
    }
    check_size(file, columns.len(), 0)?;
    if columns.is_empty() {
        return Err(wrong(
            file,
            "a column of times and one a signal are missing",
        ));
    }
    Ok(columns)
}

fn read_group(
    group: &dyn RowGroupReader,
    rows: usize,
    columns: &[(usize, Known)],
    table: &mut Table,
) -> Result<(), String> {
    let reader = |place: usize| group.get_column_reader(place).map_err(|e| e.to_string());
    for seconds in samples(reader(0)?, rows, None)? {
        let time_us =
            whole_us(seconds).ok_or_else(|| format!("{seconds} is no time in seconds"))?;
        if table.times_us.last().is_some_and(|last| *last > time_us) {
            return Err(format!("{seconds} s is earlier than the row before"));
        }
        table.times_us.push(time_us);
    }
    for ((place, known), column) in columns.iter().zip(&mut table.columns) {
        let read = samples(reader(*place)?, rows, Some(known));
        column.extend(read.map_err(|what| format!("column \"{}\": {what}", known.channel.name))?);
    }
    Ok(())
}

/// A column's samples; an unknown one is NaN, and words are those of the channel.
fn samples(reader: ColumnReader, rows: usize, known: Option<&Known>) -> Result<Vec<f64>, String> {
    match reader {
        ColumnReader::DoubleColumnReader(column) => numbers(column, rows, |n| Ok(*n)),
        ColumnReader::FloatColumnReader(column) => numbers(column, rows, |n| Ok(f64::from(*n))),
        ColumnReader::Int32ColumnReader(column) => numbers(column, rows, |n| Ok(f64::from(*n))),
        ColumnReader::Int64ColumnReader(column) => numbers(column, rows, |n| Ok(*n as f64)),
        ColumnReader::BoolColumnReader(column) => {
            numbers(column, rows, |n| Ok(f64::from(u8::from(*n))))
        }
        ColumnReader::ByteArrayColumnReader(column) => {
            let known = known.ok_or("the first column has texts in place of seconds")?;
            let number = |word: &parquet::data_type::ByteArray| {
                let word = word.as_utf8().map_err(|error| error.to_string())?;
                known.sample(word)
            };
            numbers(column, rows, number)
        }
        _ => Err("its values are neither numbers, bits nor words".into()),
    }
}

fn numbers<T: DataType>(
    mut column: ColumnReaderImpl<T>,
    rows: usize,
    number: impl Fn(&T::T) -> Result<f64, String>,
) -> Result<Vec<f64>, String> {
    let (mut levels, mut values) = (Vec::new(), Vec::new());
    let mut samples = Vec::new();
    while samples.len() < rows {
        levels.clear();
        values.clear();
        let most = AT_ONCE.min(rows - samples.len());
        let (read, _, _) = column
            .read_records(most, Some(&mut levels), None, &mut values)
            .map_err(|error| error.to_string())?;
        if read == 0 {
            return Err(format!("it has {} of {rows} rows", samples.len()));
        }
        let mut values = values.iter();
        let mut next = || values.next().map_or(Ok(f64::NAN), &number);
        for row in 0..read {
            // A column that has a value in each row has no levels.
            let has_value = levels.get(row).is_none_or(|level| *level > 0);
            samples.push(if has_value { next()? } else { f64::NAN });
        }
    }
    Ok(samples)
}
