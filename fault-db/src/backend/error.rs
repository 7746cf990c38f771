//! Errors of a backend, before the file or server they concern is known.

use crate::domain::Refusal;

/// An error of a file, of a server, of a value in a row, or of a row outside its domain.
#[derive(Debug)]
pub(crate) enum SqlError {
    File(rusqlite::Error),
    Server(postgres::Error),
    Value { column: usize, reason: String },
    Refused(Box<Refusal>),
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
