//! A user's SQL query: one `SELECT`, on a connection that can only read, within limits.

mod file;
mod server;

use serde::Serialize;

use crate::backend::Backend;
use crate::error::{QueryLimit, StoreError};
use crate::id::Id;
use crate::seal::hex;
use crate::store::Store;

/// A value of a result.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum SqlValue {
    /// NULL.
    Null,
    /// An integer.
    Integer(i64),
    /// A floating-point number.
    Real(f64),
    /// Text. Bytes are text, too: an id in its hyphenated form, any others in hex.
    Text(String),
}

impl SqlValue {
    /// The text for bytes: an id as it is printed, any others in hex.
    pub(crate) fn of_bytes(bytes: &[u8]) -> Self {
        Self::Text(match <[u8; 16]>::try_from(bytes) {
            Ok(id) => Id::from_bytes(id).to_string(),
            Err(_) => hex(bytes),
        })
    }

    /// Length of the value's text, bytes.
    pub(crate) fn bytes(&self) -> usize {
        match self {
            Self::Text(text) => text.len(),
            Self::Null | Self::Integer(_) | Self::Real(_) => 0,
        }
    }
}

/// A result: column names and rows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct QueryResult {
    /// Names of the columns.
    pub columns: Vec<String>,
    /// The rows.
    pub rows: Vec<Vec<SqlValue>>,
    /// Whether there are more rows than were asked for.
    pub truncated: bool,
}

/// Limits of a query.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct QueryBounds {
    /// Greatest number of rows that are read.
    pub rows: usize,
    /// Memory of the database engine, bytes. The limit holds for the whole process from then on and cannot be
    /// raised again, which suits a program that asks once and ends. A server has a limit of its own.
    pub memory_bytes: Option<u64>,
    /// Time limit on a server, ms. On a file the caller stops the query.
    pub server_ms: Option<u32>,
}

impl Store {
    /// Runs one `SELECT`; any statement that could change the history is refused. Reads at most `max_rows`,
    /// so that a careless query cannot fill the memory.
    pub fn query_read_only(&self, sql: &str, max_rows: usize) -> Result<QueryResult, StoreError> {
        let bounds = QueryBounds {
            rows: max_rows,
            ..QueryBounds::default()
        };
        self.query_within(sql, bounds, || true)
    }

    /// Runs one `SELECT` within limits. On a file the query runs while `goes_on` returns true; it is called
    /// frequently, but not within one SQL function. Sorting and intermediate tables use the disk.
    ///
    /// # Errors
    /// [`StoreError::QueryExceeds`] if a limit is exceeded; or an error of the query, the file or the server.
    pub fn query_within(
        &self,
        sql: &str,
        bounds: QueryBounds,
        goes_on: impl FnMut() -> bool + Send + 'static,
    ) -> Result<QueryResult, StoreError> {
        match &self.backend {
            Backend::File(_) => file::answer(self, sql, bounds, goes_on),
            Backend::Server(server) => {
                let mut goes_on = goes_on;
                server::answer(server, self.path(), sql, bounds, &mut goes_on)
            }
        }
    }
}

fn exceeds(limit: QueryLimit) -> StoreError {
    StoreError::QueryExceeds(limit)
}

/// The error for SQL that does more than read.
fn refused(reason: &str) -> StoreError {
    StoreError::QueryRefused(reason.to_owned())
}
