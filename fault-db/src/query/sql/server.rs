//! A query on a server, in a read-only transaction.

use std::path::Path;

use postgres::error::SqlState;

use super::{QueryBounds, QueryResult, SqlValue, exceeds, refused};
use crate::backend::{Field, Row, Server, SqlError};
use crate::error::{MOST_RESULT_BYTES, QueryLimit, StoreError};

const DOING: &str = "answering a query";

/// Greatest number of rows fetched at once. The first fetch gets one row, each later one twice as many as before,
/// because a fetch arrives whole however long its rows are.
const ROWS_AT_ONCE: i32 = 200;

/// Runs one query; of a long result only the first rows are returned.
pub(super) fn answer(
    server: &Server,
    path: &Path,
    sql: &str,
    bounds: QueryBounds,
    goes_on: &mut dyn FnMut() -> bool,
) -> Result<QueryResult, StoreError> {
    if sql.trim().trim_end_matches(';').is_empty() {
        return Err(refused("it is empty"));
    }
    let failed = |error| classify(path, error);
    server.with_client(|client| {
        let transaction = client.build_transaction().read_only(true).start();
        let mut transaction = transaction.map_err(failed)?;
        if let Some(most_ms) = bounds.server_ms {
            let limit = format!("SET LOCAL statement_timeout = {most_ms}");
            transaction.batch_execute(&limit).map_err(failed)?;
        }
        let statement = transaction.prepare(sql).map_err(failed)?;
        let columns: Vec<_> = (statement.columns().iter())
            .map(|column| column.name().to_owned())
            .collect();
        // A statement without columns is no query.
        if columns.is_empty() {
            return Err(refused("it would do more than read"));
        }
        let portal = transaction.bind(&statement, &[]).map_err(failed)?;
        let (mut rows, mut bytes, mut truncated) = (Vec::new(), 0, false);
        let mut at_once = 1;
        loop {
            // The server's own time limit applies to each fetch.
            if !goes_on() {
                return Err(exceeds(QueryLimit::Stopped));
            }
            let some = transaction.query_portal(&portal, at_once);
            let some = some.map_err(failed)?;
            let is_last = some.len() < at_once as usize;
            at_once = (at_once * 2).min(ROWS_AT_ONCE);
            for row in &some {
                truncated = rows.len() == bounds.rows;
                if truncated {
                    break;
                }
                let values = values(path, row, &columns)?;
                bytes += values.iter().map(SqlValue::bytes).sum::<usize>();
                if bytes > MOST_RESULT_BYTES && rows.is_empty() {
                    return Err(exceeds(QueryLimit::Row));
                }
                truncated = bytes > MOST_RESULT_BYTES;
                if truncated {
                    break;
                }
                rows.push(values);
            }
            if truncated || is_last {
                return Ok(QueryResult {
                    columns,
                    rows,
                    truncated,
                });
            }
        }
    })
}

fn values(
    path: &Path,
    row: &postgres::Row,
    columns: &[String],
) -> Result<Vec<SqlValue>, StoreError> {
    let field = |column: usize| match Row::Server(row).field(column) {
        Ok(field) => Ok(value(field)),
        Err(SqlError::Value { column, reason }) => {
            let column = &columns[column];
            Err(StoreError::QueryFailed(format!(
                "column {column}: {reason}"
            )))
        }
        Err(other) => Err(StoreError::from_sql(path, DOING, other)),
    };
    (0..columns.len()).map(field).collect()
}

/// The error of a query: errors of the server keep their kind, all others are attributed to the query.
fn classify(path: &Path, error: postgres::Error) -> StoreError {
    if error.code() == Some(&SqlState::READ_ONLY_SQL_TRANSACTION) {
        return refused("it would do more than read");
    }
    if error.code() == Some(&SqlState::QUERY_CANCELED) {
        return exceeds(QueryLimit::Stopped);
    }
    match StoreError::from_sql(path, DOING, error.into()) {
        StoreError::Server { source, .. } => match source.as_db_error() {
            Some(said) if said.message().contains("multiple commands") => {
                refused("there is a second statement")
            }
            Some(said) => StoreError::QueryFailed(said.message().to_owned()),
            None => StoreError::QueryFailed(source.to_string()),
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
