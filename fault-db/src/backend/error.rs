//! Errors of a backend, which do not yet name the file or server.

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

/// A row outside its columns' domain: its table, its name for a person, and the reason.
#[derive(Debug)]
pub(crate) struct Refusal {
    pub table: &'static str,
    pub shown: String,
    pub reason: String,
}

impl Refusal {
    /// The error of reading a row outside its columns' domain.
    pub fn of(table: &'static str, shown: String, reason: String) -> SqlError {
        SqlError::Refused(Box::new(Self {
            table,
            shown,
            reason,
        }))
    }

    /// Name of the row, as "fault event 0197…".
    pub fn row(&self) -> String {
        format!("{} {}", self.table.replace('_', " "), self.shown)
    }
}
