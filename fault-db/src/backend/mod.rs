//! The two database backends, a SQLite file and a PostgreSQL server, behind one query interface.
//!
//! Queries are written in the SQL that both understand, with parameters `?1`, `?2` …:
//! * sums and counts of a comparison as `CASE WHEN … THEN 1 ELSE 0 END`, sums of whole numbers as
//!   `CAST(sum(x) AS BIGINT)`, `coalesce` for `ifnull`, no scalar `min` or `max`;
//! * `GROUP BY` names every selected column that is not an aggregate;
//! * `ORDER BY` is complete; both backends compare text by its bytes.

mod error;
mod numeric;
mod row;
mod server;
mod value;

use rusqlite::{Connection, ToSql, params_from_iter};

pub(crate) use error::{Refusal, SqlError, SqlResult};
pub(crate) use row::{Row, from_row};
pub(crate) use server::Server;
pub(crate) use value::{Field, FromField, Value, values};

/// An open file or server.
pub(crate) enum Backend {
    File(Connection),
    Server(Server),
}

/// Calls `take` with each row of a file's result.
pub(crate) fn each_of_file(
    conn: &Connection,
    sql: &str,
    values: &[Value<'_>],
    mut take: impl FnMut(Row<'_>) -> SqlResult<()>,
) -> SqlResult<()> {
    let mut select = conn.prepare_cached(sql)?;
    let mut rows = select.query(params_from_iter(values))?;
    while let Some(row) = rows.next()? {
        take(Row::File(row))?;
    }
    Ok(())
}

impl Backend {
    /// Calls `take` with each row of a result. `take` must not query this backend.
    pub fn each(
        &self,
        sql: &str,
        values: &[Value<'_>],
        mut take: impl FnMut(Row<'_>) -> SqlResult<()>,
    ) -> SqlResult<()> {
        match self {
            Self::File(conn) => each_of_file(conn, sql, values, take),
            Self::Server(server) => server.each(sql, values, |row| take(Row::Server(row))),
        }
    }

    /// All rows of a result.
    pub fn select<T>(
        &self,
        sql: &str,
        values: &[Value<'_>],
        mut read: impl FnMut(Row<'_>) -> SqlResult<T>,
    ) -> SqlResult<Vec<T>> {
        let mut found = Vec::new();
        self.each(sql, values, |row| {
            found.push(read(row)?);
            Ok(())
        })?;
        Ok(found)
    }

    /// The first row of a result.
    pub fn first<T>(
        &self,
        sql: &str,
        values: &[Value<'_>],
        mut read: impl FnMut(Row<'_>) -> SqlResult<T>,
    ) -> SqlResult<Option<T>> {
        match self {
            Self::File(conn) => {
                let mut select = conn.prepare_cached(sql)?;
                let mut rows = select.query(params_from_iter(values))?;
                rows.next()?.map(|row| read(Row::File(row))).transpose()
            }
            Self::Server(_) => Ok(self.select(sql, values, read)?.into_iter().next()),
        }
    }

    /// Whether a result has a row.
    pub fn has(&self, sql: &str, values: &[Value<'_>]) -> SqlResult<bool> {
        Ok(self.first(sql, values, |_| Ok(()))?.is_some())
    }

    /// Executes an `INSERT … RETURNING seq`; returns the row number.
    pub fn insert(&self, sql: &str, values: &[Value<'_>]) -> SqlResult<i64> {
        let seq = self.first(sql, values, |row| row.get(0))?;
        seq.ok_or(SqlError::File(rusqlite::Error::QueryReturnedNoRows))
    }

    /// Executes a statement; returns the number of rows changed.
    pub fn execute(&self, sql: &str, values: &[Value<'_>]) -> SqlResult<u64> {
        match self {
            Self::File(conn) => {
                let changed = conn
                    .prepare_cached(sql)?
                    .execute(params_from_iter(values))?;
                Ok(changed as u64)
            }
            Self::Server(server) => server.execute(sql, values),
        }
    }
}

impl ToSql for Value<'_> {
    fn to_sql(&self) -> rusqlite::Result<rusqlite::types::ToSqlOutput<'_>> {
        use rusqlite::types::{ToSqlOutput, ValueRef};
        Ok(ToSqlOutput::Borrowed(match self {
            Self::Null => ValueRef::Null,
            Self::Integer(integer) => ValueRef::Integer(*integer),
            Self::Real(real) => ValueRef::Real(*real),
            Self::Text(text) => ValueRef::Text(text.as_bytes()),
            Self::Bytes(bytes) => ValueRef::Blob(bytes),
        }))
    }
}
