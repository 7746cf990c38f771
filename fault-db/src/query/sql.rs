//! A question in SQL, on a connection that can only read.

use rusqlite::fallible_iterator::FallibleIterator;
use rusqlite::hooks::{AuthAction, AuthContext, Authorization};
use rusqlite::types::ValueRef;
use rusqlite::{Connection, Statement};
use serde::Serialize;

use crate::base::Base;
use crate::error::StoreError;
use crate::id::Id;
use crate::server::query;
use crate::store::Store;

/// A value of an answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum SqlValue {
    /// Nothing.
    Null,
    /// A whole number.
    Integer(i64),
    /// A number.
    Real(f64),
    /// Text; an id is its hyphenated form, other bytes are hex.
    Text(String),
}

/// An answer holds about so much text: it is printed from memory.
pub(crate) const MOST_BYTES: usize = 16 << 20;

impl SqlValue {
    /// An id as it is printed, other bytes as hex.
    pub(crate) fn of_bytes(bytes: &[u8]) -> Self {
        Self::Text(match <[u8; 16]>::try_from(bytes) {
            Ok(id) => Id::from_bytes(id).to_string(),
            Err(_) => bytes.iter().map(|byte| format!("{byte:02x}")).collect(),
        })
    }

    /// Bytes of its text.
    pub(crate) fn bytes(&self) -> usize {
        match self {
            Self::Text(text) => text.len(),
            Self::Null | Self::Integer(_) | Self::Real(_) => 0,
        }
    }
}

/// An answer: column names and rows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct QueryResult {
    /// Names of the columns.
    pub columns: Vec<String>,
    /// The rows.
    pub rows: Vec<Vec<SqlValue>>,
    /// There were more rows than asked for.
    pub truncated: bool,
}

impl Store {
    /// Answers one `SELECT`; anything that could change the history is refused. Reads at most
    /// `max_rows`, so that a careless question cannot fill the memory.
    pub fn query_read_only(&self, sql: &str, max_rows: usize) -> Result<QueryResult, StoreError> {
        if let Base::Server(server) = self.base() {
            return query::answer(server, self.path(), sql, max_rows);
        }
        // A connection of its own: the authorizer would bind this one's writer, too.
        let reader = Store::open_read_only(self.path())?;
        let conn = reader.file()?;
        let guarded = conn
            .execute_batch("PRAGMA query_only = ON")
            .and_then(|()| conn.authorizer(Some(allow_reading)));
        guarded.map_err(|error| self.failed("guarding a query", error))?;
        let mut statement = prepare_single(conn, sql)?;
        let columns = statement
            .column_names()
            .into_iter()
            .map(str::to_owned)
            .collect();
        let answer =
            read(&mut statement, max_rows).map_err(|error| match error.sqlite_error() {
                Some(_) => self.failed_query(error),
                None => StoreError::QueryFailed {
                    reason: error.to_string(),
                },
            })?;
        let (rows, truncated) = answer;
        Ok(QueryResult {
            columns,
            rows,
            truncated,
        })
    }

    /// Trouble of the file stays what it is; all else is the question's own.
    fn failed_query(&self, error: rusqlite::Error) -> StoreError {
        match self.failed("answering a query", error) {
            StoreError::Sqlite { source, .. } => StoreError::QueryFailed {
                reason: source.to_string(),
            },
            other => other,
        }
    }
}

fn prepare_single<'a>(conn: &'a Connection, sql: &str) -> Result<Statement<'a>, StoreError> {
    let refused = |reason: &str| StoreError::QueryRefused {
        reason: reason.to_owned(),
    };
    let mut batch = rusqlite::Batch::new(conn, sql);
    let sorted = |error: rusqlite::Error| match error.sqlite_error_code() {
        Some(rusqlite::ErrorCode::AuthorizationForStatementDenied) => {
            refused("it would do more than read")
        }
        _ => StoreError::QueryFailed {
            reason: error.to_string(),
        },
    };
    let statement = batch
        .next()
        .map_err(sorted)?
        .ok_or_else(|| refused("it is empty"))?;
    if !statement.readonly() {
        return Err(refused("it would do more than read"));
    }
    // A second statement counts as one even when it makes no sense.
    match batch.next() {
        Ok(None) => Ok(statement),
        _ => Err(refused("there is a second statement")),
    }
}

fn read(
    statement: &mut Statement<'_>,
    max_rows: usize,
) -> rusqlite::Result<(Vec<Vec<SqlValue>>, bool)> {
    let width = statement.column_count();
    let mut found: Vec<Vec<SqlValue>> = Vec::new();
    let mut bytes = 0;
    let mut rows = statement.query([])?;
    while let Some(row) = rows.next()? {
        if found.len() == max_rows || bytes > MOST_BYTES {
            return Ok((found, true));
        }
        let values = (0..width).map(|column| row.get_ref(column).map(value));
        let values: Vec<_> = values.collect::<rusqlite::Result<_>>()?;
        bytes += values.iter().map(SqlValue::bytes).sum::<usize>();
        found.push(values);
    }
    Ok((found, false))
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
