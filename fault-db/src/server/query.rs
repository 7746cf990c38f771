//! A question in SQL to a server, in a transaction that can only read.

use std::path::Path;

use postgres::error::SqlState;

use super::trouble;
use crate::base::{Field, Row, Server, SqlError};
use crate::error::StoreError;
use crate::query::{MOST_BYTES, QueryResult, SqlValue};

const DOING: &str = "answering a query";

/// Rows that are fetched together.
const ROWS_AT_ONCE: i32 = 200;

/// Answers one question; of a long answer the first `max_rows`.
pub(crate) fn answer(
    server: &Server,
    path: &Path,
    sql: &str,
    max_rows: usize,
) -> Result<QueryResult, StoreError> {
    if sql.trim().trim_end_matches(';').is_empty() {
        return Err(refused("it is empty"));
    }
    let found = server.with_client(|client| {
        let mut transaction = client.build_transaction().read_only(true).start()?;
        let statement = transaction.prepare(sql)?;
        let columns: Vec<_> = (statement.columns().iter())
            .map(|column| column.name().to_owned())
            .collect();
        if columns.is_empty() {
            return Ok(None);
        }
        let portal = transaction.bind(&statement, &[])?;
        let (mut rows, mut bytes, mut truncated) = (Vec::new(), 0, false);
        loop {
            let some = transaction.query_portal(&portal, ROWS_AT_ONCE)?;
            let is_last = some.len() < ROWS_AT_ONCE as usize;
            for row in &some {
                truncated = rows.len() == max_rows || bytes > MOST_BYTES;
                if truncated {
                    break;
                }
                let values = values(row, columns.len());
                bytes += values.iter().flatten().map(SqlValue::bytes).sum::<usize>();
                rows.push(values);
            }
            if truncated || is_last {
                return Ok(Some((columns, rows, truncated)));
            }
        }
    });
    let found = found.map_err(|error| sorted(path, error))?;
    // What has no columns does something instead of answering.
    let (columns, rows, truncated) = found.ok_or_else(|| refused("it would do more than read"))?;
    let rows = rows.into_iter().collect::<Result<_, _>>();
    let rows = rows.map_err(|error| match error {
        SqlError::Value { column, reason } => StoreError::QueryFailed {
            reason: format!("column {}: {reason}", columns[column]),
        },
        other => StoreError::from_sql(path, DOING, other),
    })?;
    Ok(QueryResult {
        columns,
        rows,
        truncated,
    })
}

fn values(row: &postgres::Row, columns: usize) -> Result<Vec<SqlValue>, SqlError> {
    (0..columns)
        .map(|column| Row::Server(row).field(column).map(value))
        .collect()
}

fn refused(reason: &str) -> StoreError {
    StoreError::QueryRefused {
        reason: reason.to_owned(),
    }
}

/// Trouble of the server stays what it is; all else is the question's own.
fn sorted(path: &Path, error: postgres::Error) -> StoreError {
    if error.code() == Some(&SqlState::READ_ONLY_SQL_TRANSACTION) {
        return refused("it would do more than read");
    }
    match trouble::sorted(path, DOING, error) {
        StoreError::Server { source, .. } => match source.as_db_error() {
            Some(said) if said.message().contains("multiple commands") => {
                refused("there is a second statement")
            }
            Some(said) => StoreError::QueryFailed {
                reason: said.message().to_owned(),
            },
            None => StoreError::QueryFailed {
                reason: source.to_string(),
            },
        },
        other => other,
    }
}

fn value(field: Field<'_>) -> SqlValue {
    match field {
        Field::Null => SqlValue::Null,
        Field::Integer(integer) => SqlValue::Integer(integer),
        Field::Real(real) => SqlValue::Real(real),
        Field::Text(text) => SqlValue::Text(text.to_owned()),
        Field::Bytes(bytes) => SqlValue::of_bytes(bytes),
    }
}
