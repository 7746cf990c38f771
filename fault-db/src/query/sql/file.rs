//! Queries on a file, on a separate connection that can only read.

use rusqlite::fallible_iterator::FallibleIterator;
use rusqlite::hooks::{AuthAction, AuthContext, Authorization};
use rusqlite::types::ValueRef;
use rusqlite::{Connection, ErrorCode, Statement};

use super::{QueryBounds, QueryResult, SqlValue, exceeds, refused};
use crate::error::{MOST_RESULT_BYTES, QueryLimit, StoreError};
use crate::store::Store;

/// Runs one query; of a long result only the first rows are returned.
pub(super) fn answer(
    store: &Store,
    sql: &str,
    bounds: QueryBounds,
    mut goes_on: impl FnMut() -> bool + Send + 'static,
) -> Result<QueryResult, StoreError> {
    // A separate connection: the authorizer would restrict this store's writer, too.
    let reader = Store::open_read_only(store.path())?;
    let conn = reader.file()?;
    let most = match bounds.memory_bytes {
        Some(bytes) => format!("PRAGMA hard_heap_limit = {bytes};"),
        None => String::new(),
    };
    let guarded = conn
        .execute_batch(&format!(
            "PRAGMA query_only = ON; PRAGMA temp_store = FILE; {most}"
        ))
        .and_then(|()| conn.progress_handler(STEPS_AT_ONCE, Some(move || !goes_on())))
        .and_then(|()| conn.authorizer(Some(allow_reading)));
    guarded.map_err(|error| store.failed("guarding a query", error))?;
    let mut statement = prepare_single(conn, sql)?;
    let columns = statement
        .column_names()
        .into_iter()
        .map(str::to_owned)
        .collect();
    let answer = read(&mut statement, bounds.rows).map_err(|error| match error.sqlite_error() {
        Some(_) => failed_query(store, error),
        None => StoreError::QueryFailed(error.to_string()),
    })?;
    let Some((rows, truncated)) = answer else {
        return Err(exceeds(QueryLimit::Row));
    };
    Ok(QueryResult {
        columns,
        rows,
        truncated,
    })
}

/// The error of a query: errors of the file keep their kind, all others are attributed to the query.
fn failed_query(store: &Store, error: rusqlite::Error) -> StoreError {
    if let Some(limit) = limit_of(&error) {
        return exceeds(limit);
    }
    match store.failed("answering a query", error) {
        StoreError::Sqlite { source, .. } => StoreError::QueryFailed(source.to_string()),
        other => other,
    }
}

/// Steps of SQLite's engine between two questions whether the query may go on: well below a millisecond.
const STEPS_AT_ONCE: i32 = 5_000;

fn limit_of(error: &rusqlite::Error) -> Option<QueryLimit> {
    match error.sqlite_error_code()? {
        ErrorCode::OperationInterrupted => Some(QueryLimit::Stopped),
        ErrorCode::OutOfMemory => Some(QueryLimit::Memory),
        _ => None,
    }
}

fn prepare_single<'a>(conn: &'a Connection, sql: &str) -> Result<Statement<'a>, StoreError> {
    let mut batch = rusqlite::Batch::new(conn, sql);
    let classify = |error: rusqlite::Error| match error.sqlite_error_code() {
        Some(ErrorCode::AuthorizationForStatementDenied) => refused("it would do more than read"),
        _ => match limit_of(&error) {
            Some(limit) => exceeds(limit),
            None => StoreError::QueryFailed(error.to_string()),
        },
    };
    let statement = batch
        .next()
        .map_err(classify)?
        .ok_or_else(|| refused("it is empty"))?;
    if !statement.readonly() {
        return Err(refused("it would do more than read"));
    }
    // Text after the first statement is refused even if it is no SQL.
    match batch.next() {
        Ok(None) => Ok(statement),
        _ => Err(refused("there is a second statement")),
    }
}

/// The rows, and whether there are more; `None` if already the first row is too long.
fn read(
    statement: &mut Statement<'_>,
    max_rows: usize,
) -> rusqlite::Result<Option<(Vec<Vec<SqlValue>>, bool)>> {
    let width = statement.column_count();
    let mut found: Vec<Vec<SqlValue>> = Vec::new();
    let mut bytes = 0;
    let mut rows = statement.query([])?;
    while let Some(row) = rows.next()? {
        // The length is read before the value is copied: a single value may fill the memory.
        let lengths = (0..width).map(|column| row.get_ref(column).map(length));
        bytes += lengths.sum::<rusqlite::Result<usize>>()?;
        if bytes > MOST_RESULT_BYTES && found.is_empty() {
            return Ok(None);
        }
        if found.len() == max_rows || bytes > MOST_RESULT_BYTES {
            return Ok(Some((found, true)));
        }
        let values = (0..width).map(|column| row.get_ref(column).map(value));
        found.push(values.collect::<rusqlite::Result<_>>()?);
    }
    Ok(Some((found, false)))
}

/// Length of a value's text, bytes; 0 for NULL and numbers.
fn length(value: ValueRef<'_>) -> usize {
    match value {
        ValueRef::Null | ValueRef::Integer(_) | ValueRef::Real(_) => 0,
        ValueRef::Text(text) => text.len(),
        ValueRef::Blob(bytes) => 2 * bytes.len(),
    }
}

fn value(value: ValueRef<'_>) -> SqlValue {
    match value {
        ValueRef::Null => SqlValue::Null,
        ValueRef::Integer(integer) => SqlValue::Integer(integer),
        ValueRef::Real(real) => SqlValue::Real(real),
        ValueRef::Text(text) => SqlValue::Text(String::from_utf8_lossy(text).into_owned()),
        ValueRef::Blob(bytes) => SqlValue::of_bytes(bytes),
    }
}

/// Pragmas that only describe the schema.
const READING_PRAGMAS: &[&str] = &[
    "table_info",
    "table_xinfo",
    "table_list",
    "index_list",
    "index_info",
    "foreign_key_list",
];

fn allow_reading(context: AuthContext<'_>) -> Authorization {
    let allowed = match context.action {
        AuthAction::Select | AuthAction::Read { .. } | AuthAction::Recursive => true,
        AuthAction::Function { function_name } => function_name != "load_extension",
        AuthAction::Pragma { pragma_name, .. } => READING_PRAGMAS.contains(&pragma_name),
        _ => false,
    };
    if allowed {
        Authorization::Allow
    } else {
        Authorization::Deny
    }
}
