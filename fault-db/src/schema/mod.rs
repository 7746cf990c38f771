//! The schema of a file: one SQL text per version, applied in order; `user_version` counts them.

pub(crate) mod derived_columns;
pub(crate) mod full_text;
pub(crate) mod guard;
pub(crate) mod packed;
pub(crate) mod sql_functions;
mod statistics;
pub(crate) mod views;

use rusqlite::Connection;
use rusqlite::config::DbConfig;

/// SQLite's application id of this program's files: the letters `FTDB`.
pub const APPLICATION_ID: i32 = 0x4654_4442;

/// The schema version this crate reads and writes.
pub const SCHEMA_VERSION: i32 = STEPS.len() as i32;

/// SQL of each schema version: the first creates everything, each later one changes the schema before it.
const STEPS: &[&str] = &[concat!(
    include_str!("tables.sql"),
    include_str!("triggers.sql"),
    include_str!("views.sql"),
)];

/// Fills the derived tables.
pub(crate) const DERIVED: &str = include_str!("derived.sql");

/// Fills the full-text index of notes.
pub(crate) const WORDS: &str = include_str!("words.sql");

/// Creates a file's tables, or migrates those of an earlier version, in the caller's transaction.
pub(crate) fn bring_up_to_date(conn: &Connection) -> Result<(), rusqlite::Error> {
    bring_to(conn, STEPS)
}

/// The tables, indexes, views and triggers of this version, in an empty database.
pub(crate) fn create(conn: &Connection, version: i32) -> Result<(), rusqlite::Error> {
    let version = usize::try_from(version).unwrap_or_default();
    bring_to(conn, &STEPS[..version.min(STEPS.len())])
}

fn bring_to(conn: &Connection, steps: &[&str]) -> Result<(), rusqlite::Error> {
    let from = usize::try_from(user_version(conn)?).unwrap_or(steps.len());
    // Off for the program's own SQL, which may widen the check of a column, as no `ALTER TABLE` can.
    let defensive = conn.db_config(DbConfig::SQLITE_DBCONFIG_DEFENSIVE)?;
    conn.set_db_config(DbConfig::SQLITE_DBCONFIG_DEFENSIVE, false)?;
    let steps_left = steps.get(from..).unwrap_or_default();
    let done = (steps_left.iter()).try_for_each(|step| conn.execute_batch(step));
    conn.set_db_config(DbConfig::SQLITE_DBCONFIG_DEFENSIVE, defensive)?;
    done?;
    conn.pragma_update(None, "user_version", steps.len() as i64)
}

/// The file's own schema version; 0 for a new one.
pub(crate) fn user_version(conn: &Connection) -> Result<i32, rusqlite::Error> {
    conn.query_row("PRAGMA user_version", [], |row| row.get(0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::sql_functions;

    /// A made-up next version: a column with a value in each row, and an index.
    const NEXT: &[&str] = &[
        STEPS[0],
        "ALTER TABLE run ADD COLUMN depot TEXT NOT NULL DEFAULT '';
         UPDATE run SET depot = 'depot ' || seq;
         CREATE INDEX run_by_depot ON run(depot);",
    ];

    /// SQL that inserts `count` runs of a unit.
    fn runs(count: u32) -> String {
        format!(
            "INSERT INTO unit VALUES (1, 'ATC-1', 'atc', 'sg100', '{{}}');
            WITH RECURSIVE n(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM n WHERE n < {count})
            INSERT INTO run(id, unit, unit_kind, unit_config_name, sw_versions, line, train, seed, operator, source,
                started_at_us, app_version, scripts_sha256, unit_config_sha256, owner)
            SELECT randomblob(16), 1, 'atc', 'sg100', '{{}}', 'line8', '', 1, '', 'sim', n, '', '', '', '' FROM n;"
        )
    }

    fn in_memory() -> Connection {
        let conn = Connection::open_in_memory().expect("a database in memory");
        sql_functions::register(&conn).expect("functions");
        conn
    }

    #[test]
    fn the_sql_names_our_application_id() {
        let sql = format!("PRAGMA application_id = {APPLICATION_ID};");
        assert!(STEPS[0].contains(&sql));
    }

    #[test]
    fn a_file_is_migrated_once_and_keeps_its_rows() {
        let conn = in_memory();
        bring_up_to_date(&conn).expect("created");
        conn.execute_batch(&runs(2_000)).expect("runs");
        bring_to(&conn, NEXT).expect("migrated");
        bring_to(&conn, NEXT).expect("nothing left to do");
        assert_eq!(user_version(&conn).expect("a version"), 2);
        let last = "SELECT depot FROM run ORDER BY started_at_us DESC LIMIT 1";
        let last: String = conn.query_row(last, [], |row| row.get(0)).expect("a row");
        assert_eq!(last, "depot 2000");
    }

    /// Goal: a program killed in the middle of a migration leaves the file as it was. Method: the disk as it would be
    /// then, with part of the work in the log and no commit; a page cache that is too small drives that part to the
    /// disk.
    #[test]
    fn a_file_whose_migration_was_interrupted_is_unchanged() {
        let dir = tempfile::tempdir().expect("a directory");
        let path = dir.path().join("a.db");
        let conn = Connection::open(&path).expect("made");
        sql_functions::register(&conn).expect("functions");
        conn.execute_batch("PRAGMA journal_mode = WAL")
            .expect("set");
        bring_up_to_date(&conn).expect("created");
        // Enough runs to overflow the page cache, even while caches of other tests lend it pages.
        conn.execute_batch(&runs(20_000)).expect("runs");
        let begin = "PRAGMA wal_checkpoint(TRUNCATE); PRAGMA cache_size = 5; BEGIN IMMEDIATE";
        conn.execute_batch(begin).expect("begun");
        bring_to(&conn, NEXT).expect("nearly done");

        let killed = dir.path().join("killed.db");
        let log = |path: &std::path::Path| path.with_extension("db-wal");
        std::fs::copy(&path, &killed).expect("the file");
        let written = std::fs::copy(log(&path), log(&killed)).expect("its log");
        assert!(written > 100_000, "{written}: the work was under way");
        let found = Connection::open(&killed).expect("opens");
        assert_eq!(user_version(&found).expect("readable"), SCHEMA_VERSION);
        let one = |sql: &str| found.query_row(sql, [], |row| row.get::<_, String>(0));
        assert_eq!(one("PRAGMA integrity_check").expect("checked"), "ok");
        let depot = one("SELECT depot FROM run").expect_err("not a column yet");
        assert!(depot.to_string().contains("no such column"), "{depot}");
        sql_functions::register(&found).expect("functions");
        bring_to(&found, NEXT).expect("and it can be brought up to date");
        assert_eq!(user_version(&found).expect("readable"), 2);
    }
}
