//! Rows of one table of a change set, each checked against the domain of its columns when it is read.

use std::rc::Rc;

use super::columns::{Column, Kind};
use super::tables::Table;
use crate::backend::Refusal;
use crate::backend::{Field, Row, SqlError, SqlResult, Value};
use crate::exchange::domain::{PACKED_BYTES, check, shown_id};

/// Rows of one table.
pub(super) struct Rows {
    pub table: &'static Table,
    for_server: bool,
    /// Query that reads rows of a file, selected by the column `by` of the table.
    pub sql: Rc<str>,
    values: Vec<Value<'static>>,
    width: usize,
    /// Approximate bytes on the wire.
    pub bytes: usize,
}

/// A state of [`Rows`] to go back to: number of values, and bytes.
pub(super) type Mark = (usize, usize);

impl Rows {
    /// An empty list; rows for a server have the derived columns, too.
    pub fn of(table: &'static Table, for_server: bool) -> Self {
        Self {
            table,
            for_server,
            sql: table.read(table.by, for_server).into(),
            values: Vec::new(),
            width: table.sent(for_server).count(),
            bytes: 0,
        }
    }

    pub fn count(&self) -> usize {
        self.values.len() / self.width
    }

    pub fn iter(&self) -> impl Iterator<Item = &[Value<'static>]> {
        self.values.chunks_exact(self.width)
    }

    /// The values of one column.
    pub fn column(&self, place: usize) -> impl Iterator<Item = &Value<'static>> {
        self.values.iter().skip(place).step_by(self.width)
    }

    pub fn mark(&self) -> Mark {
        (self.values.len(), self.bytes)
    }

    /// Removes the rows added since the mark.
    pub fn back_to(&mut self, (values, bytes): Mark) {
        self.values.truncate(values);
        self.bytes = bytes;
    }

    /// Adds a row, whose columns are in the order of the table's.
    ///
    /// # Errors
    /// [`SqlError::Refused`]: a value is outside its column's domain; the row is not added.
    pub fn take(&mut self, row: Row<'_>) -> SqlResult<()> {
        let mark = self.mark();
        let taken = self.take_fields(row)?;
        let checked = taken.and_then(|()| (self.table.check)(&self.values[mark.0..]));
        checked.map_err(|reason| {
            self.back_to(mark);
            let shown = shown(row.field(self.table.shown));
            Refusal::of(self.table.name, shown, reason)
        })
    }

    fn take_fields(&mut self, row: Row<'_>) -> SqlResult<Result<(), String>> {
        for (place, column) in self.table.sent(self.for_server).enumerate() {
            let field = match row.field(place) {
                Ok(field) => field,
                Err(SqlError::Value { reason, .. }) => {
                    return Ok(Err(format!("{}: {reason}", column.name)));
                }
                Err(other) => return Err(other),
            };
            if let Err(reason) = check_field(column, field) {
                return Ok(Err(reason));
            }
            self.bytes += match field {
                Field::Text(text) => 4 + text.len(),
                Field::Bytes(bytes) => 4 + bytes.len(),
                _ => 12,
            };
            self.values.push(field.to_value());
        }
        Ok(Ok(()))
    }
}

fn check_field(column: &Column, field: Field<'_>) -> Result<(), String> {
    let wanted = column.kind.server_type();
    match (field, column.kind) {
        (Field::Null, _)
        | (Field::Integer(_), Kind::Integer)
        | (Field::Real(_), Kind::Real)
        | (Field::Text(_), Kind::Text | Kind::Unit) => {}
        (Field::Bytes(_), _) if wanted == "bytea" => {}
        (Field::Integer(_), Kind::Text | Kind::Bytes) => {
            return Err(format!("a value has more than {PACKED_BYTES} bytes"));
        }
        (other, _) => {
            return Err(format!(
                "{}: {other:?} where a {wanted} should be",
                column.name
            ));
        }
    }
    check(column.name, field)
}

/// Name of a row, for people.
fn shown(name: SqlResult<Field<'_>>) -> String {
    match name {
        Ok(Field::Bytes(id)) => shown_id(id),
        Ok(Field::Integer(number)) => number.to_string(),
        Ok(Field::Text(text)) => text.chars().take(40).collect(),
        _ => "without a name".to_owned(),
    }
}
