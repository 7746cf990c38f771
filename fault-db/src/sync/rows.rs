//! Rows to be sent: collected column by column, inserted by one statement.

use postgres::types::ToSql;

use crate::backend::{Backend, Field, Row, Server, SqlError, SqlResult, values};
use crate::domain::check;

/// The type of a column.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    Integer,
    Real,
    Text,
    Bytes,
}

/// How rows of a table are read from a file and inserted on a server.
pub(super) struct Table {
    /// The columns sent.
    pub columns: &'static [(&'static str, Kind)],
    /// Reads the rows of a parent row `?1`, with the columns in that order.
    pub read: &'static str,
    /// Statements that insert the rows, in this order: `{rows}` stands for the rows sent, `x`, with their
    /// place; `{laptop}` for the laptop. The first one counts the new rows.
    pub insert: &'static [&'static str],
}

/// Rows of one table.
pub(super) struct Rows {
    table: &'static Table,
    columns: Vec<Column>,
    pub count: usize,
    /// Approximate bytes on the wire.
    pub bytes: usize,
}

enum Column {
    Integer(Vec<Option<i64>>),
    Real(Vec<Option<f64>>),
    Text(Vec<Option<String>>),
    Bytes(Vec<Option<Vec<u8>>>),
}

impl Rows {
    pub fn of(table: &'static Table) -> Self {
        let column = |(_, kind): &(_, Kind)| match kind {
            Kind::Integer => Column::Integer(Vec::new()),
            Kind::Real => Column::Real(Vec::new()),
            Kind::Text => Column::Text(Vec::new()),
            Kind::Bytes => Column::Bytes(Vec::new()),
        };
        Self {
            table,
            columns: table.columns.iter().map(column).collect(),
            count: 0,
            bytes: 0,
        }
    }

    /// Reads the rows that belong to this row of a file.
    pub fn read(&mut self, file: &Backend, of: i64) -> SqlResult<()> {
        let sql = self.table.read;
        file.each(sql, &values![of], |row| self.take(row, &[]))
    }

    /// Adds a row of a file, with its derived fields.
    pub fn take(&mut self, row: Row<'_>, made: &[Field<'_>]) -> SqlResult<()> {
        let read = self.columns.len() - made.len();
        for column in 0..read {
            self.push(column, row.field(column)?)?;
        }
        for (column, field) in (read..).zip(made) {
            self.push(column, *field)?;
        }
        self.count += 1;
        Ok(())
    }

    /// The current length, for [`back_to`](Self::back_to).
    pub fn mark(&self) -> (usize, usize) {
        (self.count, self.bytes)
    }

    /// Removes the rows added since.
    pub fn back_to(&mut self, (count, bytes): (usize, usize)) {
        (self.count, self.bytes) = (count, bytes);
        self.columns
            .iter_mut()
            .for_each(|column| column.truncate(count));
    }

    fn push(&mut self, column: usize, field: Field<'_>) -> SqlResult<()> {
        let (name, _) = self.table.columns[column];
        check(name, field).map_err(|reason| SqlError::Value { column, reason })?;
        self.bytes += match &field {
            Field::Text(text) => 4 + text.len(),
            Field::Bytes(bytes) => 4 + bytes.len(),
            _ => 12,
        };
        self.columns[column]
            .push(field)
            .map_err(|reason| SqlError::Value { column, reason })
    }

    /// Inserts all rows; the number of new ones.
    pub fn send(&self, server: &Server, laptop: i64) -> SqlResult<u64> {
        if self.count == 0 {
            return Ok(0);
        }
        let mut new = None;
        for insert in self.table.insert {
            let changed = self.send_by(server, laptop, insert)?;
            new.get_or_insert(changed);
        }
        Ok(new.unwrap_or_default())
    }

    /// Executes one statement over all rows; the number of rows it changed.
    pub fn send_by(&self, server: &Server, laptop: i64, sql: &str) -> SqlResult<u64> {
        if self.count == 0 {
            return Ok(0);
        }
        let columns: Vec<_> = self.columns.iter().map(|column| column as _).collect();
        server.execute_columns(&self.filled(sql, laptop), &columns)
    }

    /// The result of a query over all rows.
    pub fn ask(&self, server: &Server, laptop: i64, sql: &str) -> SqlResult<Vec<postgres::Row>> {
        if self.count == 0 {
            return Ok(Vec::new());
        }
        let columns: Vec<_> = self.columns.iter().map(|column| column as _).collect();
        server.select_columns(&self.filled(sql, laptop), &columns)
    }

    fn filled(&self, sql: &str, laptop: i64) -> String {
        let arrays: Vec<_> = (self.columns.iter().enumerate())
            .map(|(place, column)| format!("${}::{}[]", place + 1, column.server_type()))
            .collect();
        let names: Vec<_> = self.table.columns.iter().map(|(name, _)| *name).collect();
        let rows = format!(
            "unnest({}) WITH ORDINALITY AS x({}, place)",
            arrays.join(", "),
            names.join(", ")
        );
        sql.replace("{rows}", &rows)
            .replace("{laptop}", &laptop.to_string())
    }
}

impl Column {
    fn truncate(&mut self, count: usize) {
        match self {
            Self::Integer(all) => all.truncate(count),
            Self::Real(all) => all.truncate(count),
            Self::Text(all) => all.truncate(count),
            Self::Bytes(all) => all.truncate(count),
        }
    }

    fn server_type(&self) -> &'static str {
        match self {
            Self::Integer(_) => "bigint",
            Self::Real(_) => "float8",
            Self::Text(_) => "text",
            Self::Bytes(_) => "bytea",
        }
    }

    fn push(&mut self, field: Field<'_>) -> Result<(), String> {
        match (self, field) {
            (Self::Integer(all), Field::Integer(value)) => all.push(Some(value)),
            (Self::Real(all), Field::Real(value)) => all.push(Some(value)),
            (Self::Text(all), Field::Text(text)) => all.push(Some(plain(text))),
            (Self::Bytes(all), Field::Bytes(bytes)) => all.push(Some(bytes.to_vec())),
            (Self::Integer(all), Field::Null) => all.push(None),
            (Self::Real(all), Field::Null) => all.push(None),
            (Self::Text(all), Field::Null) => all.push(None),
            (Self::Bytes(all), Field::Null) => all.push(None),
            (column, field) => {
                return Err(format!(
                    "{field:?} where a {} should be",
                    column.server_type()
                ));
            }
        }
        Ok(())
    }
}

/// PostgreSQL stores no NUL character in text.
fn plain(text: &str) -> String {
    text.replace('\0', "\u{fffd}")
}

impl ToSql for Column {
    fn to_sql(
        &self,
        of_type: &postgres::types::Type,
        out: &mut bytes::BytesMut,
    ) -> Result<postgres::types::IsNull, Box<dyn std::error::Error + Sync + Send>> {
        match self {
            Self::Integer(all) => all.to_sql(of_type, out),
            Self::Real(all) => all.to_sql(of_type, out),
            Self::Text(all) => all.to_sql(of_type, out),
            Self::Bytes(all) => all.to_sql(of_type, out),
        }
    }

    fn accepts(_: &postgres::types::Type) -> bool {
        true
    }

    postgres::types::to_sql_checked!();
}

impl std::fmt::Debug for Column {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.server_type())
    }
}
