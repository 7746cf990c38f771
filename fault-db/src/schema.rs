//! The schema's versions: one SQL file each, applied in order; `user_version` counts them.

use rusqlite::Connection;
use rusqlite_migration::{M, Migrations};

/// Marks a SQLite file as ours: the letters `FTDB`.
pub const APPLICATION_ID: i32 = 0x4654_4442;

/// The schema version this crate reads and writes.
pub const SCHEMA_VERSION: i32 = STEPS.len() as i32;

const STEPS: &[M<'static>] = &[
    M::up(include_str!("schema/0001.sql")),
    M::up(include_str!("schema/0002.sql")),
    M::up(include_str!("schema/0003.sql")),
];

/// Brings a file to [`SCHEMA_VERSION`], all steps in one transaction.
pub(crate) fn migrate(conn: &mut Connection) -> Result<(), rusqlite::Error> {
    match Migrations::from_slice(STEPS).to_latest(conn) {
        Ok(()) => Ok(()),
        // Another process may have created the same file between our look and our transaction.
        Err(_) if user_version(conn)? == SCHEMA_VERSION => Ok(()),
        Err(rusqlite_migration::Error::RusqliteError { err, .. }) => Err(err),
        Err(other) => Err(rusqlite::Error::ToSqlConversionFailure(Box::new(other))),
    }
}

/// The file's own schema version; 0 for a new one.
pub(crate) fn user_version(conn: &Connection) -> Result<i32, rusqlite::Error> {
    conn.query_row("PRAGMA user_version", [], |row| row.get(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sql_names_our_application_id() {
        let sql = format!("PRAGMA application_id = {APPLICATION_ID};");
        assert!(include_str!("schema/0001.sql").contains(&sql));
    }

    #[test]
    fn the_steps_apply() {
        Migrations::from_slice(STEPS)
            .validate()
            .expect("every step applies to the one before");
    }
}
