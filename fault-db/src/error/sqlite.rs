//! Classifies errors of a backend; those of a server are in `server`.

use std::path::Path;

use rusqlite::ErrorCode;

use super::{StoreError, server};
use crate::backend::SqlError;

impl StoreError {
    /// Classifies an error of a file or a server by what a caller can do about it.
    pub(crate) fn from_sql(path: &Path, doing: &'static str, error: SqlError) -> Self {
        match error {
            SqlError::File(error) => Self::from_sqlite(path, doing, error),
            SqlError::Server(error) => server::classify(path, doing, error),
            SqlError::Value { column, reason } => Self::Corrupt {
                path: path.to_path_buf(),
                detail: format!("{doing}: column {column}: {reason}"),
            },
            SqlError::Refused(refusal) => Self::Corrupt {
                path: path.to_path_buf(),
                detail: format!("{doing}: {}: {}", refusal.row(), refusal.reason),
            },
        }
    }

    /// Classifies an error of SQLite by what a caller can do about it.
    pub(crate) fn from_sqlite(path: &Path, doing: &'static str, source: rusqlite::Error) -> Self {
        let path = path.to_path_buf();
        let reason = source.to_string();
        match source.sqlite_error_code() {
            Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => Self::Locked(path),
            Some(ErrorCode::OperationInterrupted) => Self::Stopped,
            Some(ErrorCode::DiskFull) => Self::Full(path),
            Some(ErrorCode::ReadOnly) => Self::ReadOnly(path),
            Some(ErrorCode::NotADatabase) => Self::NotADatabase(path),
            Some(ErrorCode::DatabaseCorrupt) => Self::Malformed(path),
            Some(ErrorCode::SystemIoFailure | ErrorCode::FileLockingProtocolFailed) => {
                Self::Io { path, reason }
            }
            Some(ErrorCode::CannotOpen | ErrorCode::PermissionDenied) => {
                Self::CannotOpen { path, reason }
            }
            None if is_bad_value(&source) => Self::Corrupt {
                path,
                detail: reason,
            },
            _ => Self::Sqlite {
                path,
                doing,
                source,
            },
        }
    }
}

/// Whether a stored value has a wrong type or range: only this program writes values, so the file is damaged.
fn is_bad_value(error: &rusqlite::Error) -> bool {
    use rusqlite::Error::{FromSqlConversionFailure, IntegralValueOutOfRange, InvalidColumnType};
    matches!(
        error,
        FromSqlConversionFailure(..) | IntegralValueOutOfRange(..) | InvalidColumnType(..)
    )
}
