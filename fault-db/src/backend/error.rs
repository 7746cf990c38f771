//! Errors of a backend, before the file or server they concern is known.

/// An error of a file, of a server, or of a value in a row.
#[derive(Debug)]
pub(crate) enum SqlError {
    File(rusqlite::Error),
    Server(postgres::Error),
    Value { column: usize, reason: String },
}

pub(crate) type SqlResult<T> = Result<T, SqlError>;

impl From<rusqlite::Error> for SqlError {
    fn from(error: rusqlite::Error) -> Self {
        Self::File(error)
    }
}

impl From<postgres::Error> for SqlError {
    fn from(error: postgres::Error) -> Self {
        Self::Server(error)
    }
}
