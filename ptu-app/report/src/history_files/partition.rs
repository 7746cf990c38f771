//! One Parquet file of a view's rows, a group of rows at a time. The same rows give the same bytes.

use std::sync::Arc;

use fault_db::SqlValue;
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;

use super::views::{Kind, View};
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
        let mut columns = view.columns.iter().enumerate();
        while let Some(mut writer) = group.next_column().map_err(failed)? {
            let Some((place, (name, kind))) = columns.next() else {
                break;
            };
            let values = rows
                .iter()
                .map(|row| row.get(place).unwrap_or(&SqlValue::Null));
            put_column(&mut writer, *kind, values).map_err(|why| match why {
                Refused::Value(value) => Failure::bench(FileTrouble::OddValue(
                    format!("{}.{name}", view.name),
                    format!("{value:?}"),
                )),
                Refused::File(error) => failed(error),
            })?;
            writer.close().map_err(failed)?;
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

enum Refused {
    Value(SqlValue),
    File(ParquetError),
}

impl From<ParquetError> for Refused {
    fn from(error: ParquetError) -> Self {
        Self::File(error)
    }
}

fn put_column<'v>(
    column: &mut SerializedColumnWriter<'_>,
    kind: Kind,
    values: impl Iterator<Item = &'v SqlValue> + Clone,
) -> Result<(), Refused> {
    let is_known = |value: &SqlValue| i16::from(*value != SqlValue::Null);
    let known: Vec<i16> = values.clone().map(is_known).collect();
    let known = Some(known.as_slice());
    let values = values.filter(|value| **value != SqlValue::Null);
    let refused = |value: &SqlValue| Refused::Value(value.clone());
    match kind {
        Kind::Whole => {
            let whole = |value: &SqlValue| match value {
                SqlValue::Integer(number) => Ok(*number),
                other => Err(refused(other)),
            };
            let all = values.map(whole).collect::<Result<Vec<_>, _>>()?;
            column.typed::<Int64Type>().write_batch(&all, known, None)?;
        }
        Kind::Number => {
            let number = |value: &SqlValue| match value {
                SqlValue::Integer(number) => Ok(*number as f64),
                SqlValue::Real(number) => Ok(*number),
                other => Err(refused(other)),
            };
            let all = values.map(number).collect::<Result<Vec<_>, _>>()?;
            column
                .typed::<DoubleType>()
                .write_batch(&all, known, None)?;
        }
        Kind::Text => {
            let text = |value: &SqlValue| match value {
                SqlValue::Text(text) => Ok(ByteArray::from(text.clone().into_bytes())),
                other => Err(refused(other)),
            };
            let all = values.map(text).collect::<Result<Vec<_>, _>>()?;
            column
                .typed::<ByteArrayType>()
                .write_batch(&all, known, None)?;
        }
    }
    Ok(())
}

fn schema(view: &View) -> Result<Type, ParquetError> {
    let field = |(name, kind): &(&str, Kind)| {
        let (physical, logical) = match kind {
            Kind::Whole => (Physical::INT64, None),
            Kind::Number => (Physical::DOUBLE, None),
            Kind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        let field = Type::primitive_type_builder(name, physical)
            .with_repetition(Repetition::OPTIONAL)
            .with_logical_type(logical)
            .build();
        field.map(Arc::new)
    };
    let fields: Vec<_> = view.columns.iter().map(field).collect::<Result<_, _>>()?;
    Type::group_type_builder(view.name)
        .with_fields(fields)
        .build()
}
