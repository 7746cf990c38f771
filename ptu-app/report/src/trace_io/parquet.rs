//! Traces as Apache Parquet: a column of times, then one column per signal.
//!
//! Columns are called as [`column_name`] says. Numbers are doubles, bits booleans, enumerations their words; an unknown
//! sample is null. The file's metadata has [`TraceInfo`](super::TraceInfo) under its name.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use fault_db::{Channel, ChannelKind};
use parquet::basic::{Compression, LogicalType, Repetition, TimeUnit, Type as Physical, ZstdLevel};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;

use super::about::NAME;
use super::column::{column_name, word};
use super::part::TracePart;
use ptu_runs::failure::Failure;
use ptu_runs::new_file::cannot_write;

/// Rows of a row group; one column of a group is in memory at once.
const GROUP_ROWS: usize = 1 << 16;
/// Heading of the column of seconds from the trigger.
const TIME: &str = "time_s";
/// Heading of the column of UTC.
pub(super) const UTC: &str = "time_utc";

pub(super) fn put(
    out: &mut (impl Write + Send),
    chosen: &TracePart<'_>,
    to: &Path,
) -> Result<(), Failure> {
    let failed = |error: ParquetError| cannot_write(to, &error);
    let about = &chosen.about;
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_created_by("ptu".to_owned())
        .set_key_value_metadata(Some(vec![KeyValue::new(NAME.to_owned(), about.json())]))
        .build();
    let schema = schema(&about.channels).map_err(failed)?;
    let mut file =
        SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties)).map_err(failed)?;
    for first in (0..about.rows).step_by(GROUP_ROWS) {
        let rows = first..about.rows.min(first + GROUP_ROWS);
        let mut group = file.next_row_group().map_err(failed)?;
        let mut place = 0;
        while let Some(mut column) = group.next_column().map_err(failed)? {
            let written = match place {
                0 => {
                    let seconds = rows.clone().map(|row| about.time_us(row) as f64 / 1e6);
                    put_values::<DoubleType>(&mut column, seconds, None)
                }
                1 => {
                    let later_us = |row: usize| (row as i64).saturating_mul(about.period_us);
                    let utc_us = rows
                        .clone()
                        .map(|row| about.t0_us.saturating_add(later_us(row)));
                    put_values::<Int64Type>(&mut column, utc_us, None)
                }
                place => {
                    let samples = chosen.column(place - 2, rows.clone())?;
                    put_samples(&mut column, &about.channels[place - 2], &samples)
                }
            };
            written
                .and_then(|()| column.close().map(drop))
                .map_err(failed)?;
            place += 1;
        }
        group.close().map_err(failed)?;
    }
    file.close().map_err(failed)?;
    Ok(())
}

fn schema(channels: &[Channel]) -> Result<Type, ParquetError> {
    let utc = LogicalType::timestamp(true, TimeUnit::MICROS);
    let mut fields = vec![
        schema_column(TIME, Repetition::REQUIRED, Physical::DOUBLE, None)?,
        schema_column(UTC, Repetition::REQUIRED, Physical::INT64, Some(utc))?,
    ];
    for channel in channels {
        let (physical, logical) = match channel.kind {
            ChannelKind::Number { .. } => (Physical::DOUBLE, None),
            ChannelKind::Bit => (Physical::BOOLEAN, None),
            ChannelKind::Enum { .. } => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        let name = column_name(channel);
        fields.push(schema_column(
            &name,
            Repetition::OPTIONAL,
            physical,
            logical,
        )?);
    }
    Type::group_type_builder("trace")
        .with_fields(fields)
        .build()
}

/// A column of a schema.
pub(crate) fn schema_column(
    name: &str,
    repetition: Repetition,
    physical: Physical,
    logical: Option<LogicalType>,
) -> Result<Arc<Type>, ParquetError> {
    let column = Type::primitive_type_builder(name, physical);
    let column = column
        .with_repetition(repetition)
        .with_logical_type(logical);
    column.build().map(Arc::new)
}

/// Writes the values of a column; `known` says in which rows they are.
fn put_values<T: DataType>(
    column: &mut SerializedColumnWriter<'_>,
    values: impl Iterator<Item = T::T>,
    known: Option<&[i16]>,
) -> Result<(), ParquetError> {
    let values: Vec<_> = values.collect();
    let written = column.typed::<T>().write_batch(&values, known, None);
    written.map(drop)
}

fn put_samples(
    column: &mut SerializedColumnWriter<'_>,
    channel: &Channel,
    samples: &[f64],
) -> Result<(), ParquetError> {
    let known: Vec<i16> = samples.iter().map(|s| i16::from(!s.is_nan())).collect();
    let present = samples.iter().copied().filter(|sample| !sample.is_nan());
    let known = Some(known.as_slice());
    match &channel.kind {
        ChannelKind::Number { .. } => put_values::<DoubleType>(column, present, known),
        ChannelKind::Bit => {
            put_values::<BoolType>(column, present.map(|sample| sample != 0.0), known)
        }
        ChannelKind::Enum { .. } => {
            let word =
                |sample| word(channel, sample).map_or_else(|| sample.to_string(), str::to_owned);
            let words = present.map(|sample| ByteArray::from(word(sample).into_bytes()));
            put_values::<ByteArrayType>(column, words, known)
        }
    }
}
