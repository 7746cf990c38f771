//! One row of a result, from SQLite or from PostgreSQL.

use postgres::types::{FromSql as _, Type};

use super::error::SqlError;
use super::numeric;
use super::value::{Field, FromField};

/// A row, borrowed from the backend.
#[derive(Clone, Copy)]
pub(crate) enum Row<'a> {
    File(&'a rusqlite::Row<'a>),
    Server(&'a postgres::Row),
}

impl<'a> Row<'a> {
    /// The field in this column, counted from 0, as a Rust type.
    pub fn get<T: FromField<'a>>(&self, column: usize) -> Result<T, SqlError> {
        T::from_field(self.field(column)?).map_err(|reason| SqlError::Value { column, reason })
    }

    /// The field in this column, borrowed.
    pub fn field(&self, column: usize) -> Result<Field<'a>, SqlError> {
        match self {
            Self::File(row) => file_field(row, column),
            Self::Server(row) => server_field(row, column),
        }
    }
}

/// `from_row!(row => Run: id, unit, _, at_us; notes: Vec::new())` makes a `Run`: the first fields are the columns of
/// the row in order (`_` skips a column), the other fields are given.
macro_rules! from_row {
    ($row:ident => $name:ident: $($columns:tt)+) => {
        $crate::backend::from_row!(@ $row, 0, $name [] $($columns)+,)
    };
    (@ $row:ident, $at:expr, $name:ident [$($read:tt)*] _, $($more:tt)*) => {
        $crate::backend::from_row!(@ $row, $at + 1, $name [$($read)*] $($more)*)
    };
    (@ $row:ident, $at:expr, $name:ident [$($read:tt)*] $field:ident, $($more:tt)*) => {
        $crate::backend::from_row!(
            @ $row, $at + 1, $name [$($read)* $field: $row.get($at)?,] $($more)*
        )
    };
    (@ $row:ident, $at:expr, $name:ident [$($read:tt)*] $field:ident; $($given:tt)*) => {
        $name { $($read)* $field: $row.get($at)?, $($given)* }
    };
    (@ $row:ident, $at:expr, $name:ident [$($read:tt)*]) => { $name { $($read)* } };
}
pub(crate) use from_row;

fn file_field<'a>(row: &'a rusqlite::Row<'a>, column: usize) -> Result<Field<'a>, SqlError> {
    use rusqlite::types::ValueRef;
    let value = |reason: String| SqlError::Value { column, reason };
    Ok(match row.get_ref(column).map_err(SqlError::File)? {
        ValueRef::Null => Field::Null,
        ValueRef::Integer(integer) => Field::Integer(integer),
        ValueRef::Real(real) => Field::Real(real),
        ValueRef::Text(text) => {
            Field::Text(std::str::from_utf8(text).map_err(|error| value(error.to_string()))?)
        }
        ValueRef::Blob(bytes) => Field::Bytes(bytes),
    })
}

/// The bytes of a field, not decoded.
struct Raw<'a>(&'a [u8]);

impl<'a> postgres::types::FromSql<'a> for Raw<'a> {
    fn from_sql(_: &Type, raw: &'a [u8]) -> Result<Self, Box<dyn std::error::Error + Sync + Send>> {
        Ok(Self(raw))
    }

    fn accepts(_: &Type) -> bool {
        true
    }
}

fn server_field(row: &postgres::Row, column: usize) -> Result<Field<'_>, SqlError> {
    let raw: Option<Raw<'_>> = row.try_get(column).map_err(SqlError::Server)?;
    let Some(Raw(raw)) = raw else {
        return Ok(Field::Null);
    };
    let of_type = row.columns()[column].type_();
    let wrong = |error: Box<dyn std::error::Error + Sync + Send>| SqlError::Value {
        column,
        reason: error.to_string(),
    };
    Ok(match *of_type {
        Type::INT8 => Field::Integer(i64::from_sql(of_type, raw).map_err(wrong)?),
        Type::INT4 => Field::Integer(i32::from_sql(of_type, raw).map_err(wrong)?.into()),
        Type::INT2 => Field::Integer(i16::from_sql(of_type, raw).map_err(wrong)?.into()),
        Type::BOOL => Field::Integer(bool::from_sql(of_type, raw).map_err(wrong)?.into()),
        Type::FLOAT8 => Field::Real(f64::from_sql(of_type, raw).map_err(wrong)?),
        Type::FLOAT4 => Field::Real(f32::from_sql(of_type, raw).map_err(wrong)?.into()),
        Type::TEXT | Type::VARCHAR | Type::BPCHAR | Type::NAME | Type::UNKNOWN => {
            Field::Text(<&str>::from_sql(of_type, raw).map_err(wrong)?)
        }
        Type::BYTEA => Field::Bytes(raw),
        Type::NUMERIC => numeric::field(raw).ok_or_else(|| SqlError::Value {
            column,
            reason: "a decimal number cut short".to_owned(),
        })?,
        _ => {
            let reason = format!("the type {of_type} is not read here; CAST it to TEXT");
            return Err(SqlError::Value { column, reason });
        }
    })
}
