//! One Parquet file of a view's rows, a group of rows at a time. The same rows give the same bytes.

use std::sync::Arc;

use fault_db::SqlValue;
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;

use super::views::{Kind, View};
use crate::trace_io::schema_column;
use ptu_runs::failure::{Failure, FileTrouble, Why};

pub(super) struct Partition<'a> {
    view: &'a View,
    file: SerializedFileWriter<Vec<u8>>,
}

impl<'a> Partition<'a> {
    pub fn begin(view: &'a View) -> Result<Self, Failure> {
        let properties = WriterProperties::builder()
            .set_compression(Compression::ZSTD(ZstdLevel::default()))
            .set_created_by("ptu".to_owned())
            .build();
        let schema = schema(view).map_err(|error| failed(view, &error))?;
        let file = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties));
        Ok(Self {
            view,
            file: file.map_err(|error| failed(view, &error))?,
        })
    }

    /// Puts a group of rows.
    pub fn put(&mut self, rows: &[Vec<SqlValue>]) -> Result<(), Failure> {
        if rows.is_empty() {
            return Ok(());
        }
        let view = self.view;
        let failed = |error: ParquetError| failed(view, &error);
        let mut group = self.file.next_row_group().map_err(failed)?;
        for (place, name) in view.columns().enumerate() {
            let Some(mut column) = group.next_column().map_err(failed)? else {
                break;
            };
            let values = rows
                .iter()
                .map(|row| row.get(place).unwrap_or(&SqlValue::Null));
            let values: Vec<_> = values.collect();
            let written = match Kind::of(name) {
                Kind::Whole => put_values::<Int64Type>(&mut column, &values, |value| match value {
                    SqlValue::Integer(number) => Some(*number),
                    _ => None,
                }),
                Kind::Number => {
                    put_values::<DoubleType>(&mut column, &values, |value| match value {
                        SqlValue::Integer(number) => Some(*number as f64),
                        SqlValue::Real(number) => Some(*number),
                        _ => None,
                    })
                }
                Kind::Text => {
                    put_values::<ByteArrayType>(&mut column, &values, |value| match value {
                        SqlValue::Text(text) => Some(text.as_bytes().to_vec().into()),
                        _ => None,
                    })
                }
            };
            if let Some(odd) = written.map_err(failed)? {
                let (column, value) = (format!("{}.{name}", view.name), format!("{odd:?}"));
                return Err(Failure::bench(FileTrouble::OddValue(column, value)));
            }
            column.close().map_err(failed)?;
        }
        group.close().map_err(failed)?;
        Ok(())
    }

    pub fn finish(self) -> Result<Vec<u8>, Failure> {
        let bytes = self.file.into_inner();
        bytes.map_err(|error| failed(self.view, &error))
    }
}

fn failed(view: &View, error: &ParquetError) -> Failure {
    Failure::bench(FileTrouble::Unwritten(
        format!("{} (Parquet)", view.name),
        Why::of(error),
    ))
}

/// Writes the values of a column, converted by `of`; returns the first value of another type.
fn put_values<'v, T: DataType>(
    column: &mut SerializedColumnWriter<'_>,
    values: &[&'v SqlValue],
    of: impl Fn(&SqlValue) -> Option<T::T>,
) -> Result<Option<&'v SqlValue>, ParquetError> {
    let is_known = |value: &SqlValue| *value != SqlValue::Null;
    let known: Vec<i16> = values
        .iter()
        .map(|value| i16::from(is_known(value)))
        .collect();
    let mut written = Vec::new();
    for value in values.iter().copied().filter(|value| is_known(value)) {
        match of(value) {
            Some(value) => written.push(value),
            None => return Ok(Some(value)),
        }
    }
    let batch = column
        .typed::<T>()
        .write_batch(&written, Some(&known), None);
    batch.map(|_| None)
}

fn schema(view: &View) -> Result<Type, ParquetError> {
    let field = |name: &str| {
        let (physical, logical) = match Kind::of(name) {
            Kind::Whole => (Physical::INT64, None),
            Kind::Number => (Physical::DOUBLE, None),
            Kind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        schema_column(name, Repetition::OPTIONAL, physical, logical)
    };
    let fields: Vec<_> = view.columns().map(field).collect::<Result<_, _>>()?;
    Type::group_type_builder(view.name)
        .with_fields(fields)
        .build()
}
