//! A user's SQL query on a file, on a connection that can only read.

use rusqlite::fallible_iterator::FallibleIterator;
use rusqlite::hooks::{AuthAction, AuthContext, Authorization};
use rusqlite::types::ValueRef;
use rusqlite::{Connection, ErrorCode, Statement};
use serde::Serialize;

use crate::backend::Backend;
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

/// What an answer may take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct QueryBounds {
    /// Rows that are read.
    pub rows: usize,
    /// Memory of the database engine, bytes. It is the whole process's from then on, and cannot be raised
    /// again: for a program that asks and ends. A server has its own.
    pub memory_bytes: Option<u64>,
    /// Time of a server for it, ms. On a file whoever asks decides.
    pub server_ms: Option<u32>,
}

/// What there was not enough of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum QueryLimit {
    /// Whoever asked, or the server, let it go on no longer.
    #[error("it took too long")]
    Stopped,
    /// Memory.
    #[error("it needs too much memory")]
    Memory,
    /// One row is longer than an answer can be.
    #[error("a row is longer than {MOST_BYTES} bytes")]
    Row,
}

impl Store {
    /// Answers one `SELECT`; anything that could change the history is refused. Reads at most
    /// `max_rows`, so that a careless question cannot fill the memory.
    pub fn query_read_only(&self, sql: &str, max_rows: usize) -> Result<QueryResult, StoreError> {
        let bounds = QueryBounds {
            rows: max_rows,
            ..QueryBounds::default()
        };
        self.query_within(sql, bounds, || true)
    }

    /// The same within bounds. A file is asked as long as `goes_on` says so, which is called all the time,
    /// but not within one function of SQL; what its sorting and its intermediate tables take is on disk.
    ///
    /// # Errors
    /// [`StoreError::QueryExceeds`], too.
    pub fn query_within(
        &self,
        sql: &str,
        bounds: QueryBounds,
        mut goes_on: impl FnMut() -> bool + Send + 'static,
    ) -> Result<QueryResult, StoreError> {
        if let Backend::Server(server) = self.backend() {
            return query::answer(server, self.path(), sql, bounds, &mut goes_on);
        }
        // A connection of its own: the authorizer would bind this one's writer, too.
        let reader = Store::open_read_only(self.path())?;
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
        guarded.map_err(|error| self.failed("guarding a query", error))?;
        let mut statement = prepare_single(conn, sql)?;
        let columns = statement
            .column_names()
            .into_iter()
            .map(str::to_owned)
            .collect();
        let answer =
            read(&mut statement, bounds.rows).map_err(|error| match error.sqlite_error() {
                Some(_) => self.failed_query(error),
                None => StoreError::QueryFailed {
                    reason: error.to_string(),
                },
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

    /// Trouble of the file stays what it is; all else is the question's own.
    fn failed_query(&self, error: rusqlite::Error) -> StoreError {
        if let Some(limit) = limit_of(&error) {
            return exceeds(limit);
        }
        match self.failed("answering a query", error) {
            StoreError::Sqlite { source, .. } => StoreError::QueryFailed {
                reason: source.to_string(),
            },
            other => other,
        }
    }
}

/// Steps of SQLite between two looks at whether it may go on: well below a millisecond.
const STEPS_AT_ONCE: i32 = 5_000;

fn limit_of(error: &rusqlite::Error) -> Option<QueryLimit> {
    match error.sqlite_error_code()? {
        ErrorCode::OperationInterrupted => Some(QueryLimit::Stopped),
        ErrorCode::OutOfMemory => Some(QueryLimit::Memory),
        _ => None,
    }
}

pub(crate) fn exceeds(limit: QueryLimit) -> StoreError {
    StoreError::QueryExceeds { limit }
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
        _ => match limit_of(&error) {
            Some(limit) => exceeds(limit),
            None => StoreError::QueryFailed {
                reason: error.to_string(),
            },
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

/// The rows, and whether there are more; nothing if already the first is too long.
fn read(
    statement: &mut Statement<'_>,
    max_rows: usize,
) -> rusqlite::Result<Option<(Vec<Vec<SqlValue>>, bool)>> {
    let width = statement.column_count();
    let mut found: Vec<Vec<SqlValue>> = Vec::new();
    let mut bytes = 0;
    let mut rows = statement.query([])?;
    while let Some(row) = rows.next()? {
        // Its length before it is copied: one value may be as long as memory is large.
        let lengths = (0..width).map(|column| row.get_ref(column).map(length));
        bytes += lengths.sum::<rusqlite::Result<usize>>()?;
        if bytes > MOST_BYTES && found.is_empty() {
            return Ok(None);
        }
        if found.len() == max_rows || bytes > MOST_BYTES {
            return Ok(Some((found, true)));
        }
        let values = (0..width).map(|column| row.get_ref(column).map(value));
        found.push(values.collect::<rusqlite::Result<_>>()?);
    }
    Ok(Some((found, false)))
}

/// Bytes of a value as text.
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
