//! The schema's versions: one SQL file each, applied in order; `user_version` counts them.

use rusqlite::Connection;
use rusqlite::config::DbConfig;

/// Marks a SQLite file as ours: the letters `FTDB`.
pub const APPLICATION_ID: i32 = 0x4654_4442;

/// The schema version this crate reads and writes.
pub const SCHEMA_VERSION: i32 = STEPS.len() as i32;

const STEPS: &[&str] = &[
    include_str!("schema/0001.sql"),
    include_str!("schema/0002.sql"),
    include_str!("schema/0003.sql"),
    concat!(
        include_str!("schema/0004.sql"),
        include_str!("schema/views.sql"),
        include_str!("schema/counts.sql"),
        include_str!("schema/words.sql")
    ),
    include_str!("schema/0005.sql"),
    include_str!("schema/0006.sql"),
    concat!(
        include_str!("schema/0007.sql"),
        include_str!("schema/packed.sql")
    ),
    include_str!("schema/0008.sql"),
];

/// Recomputes the tables of counts.
pub(crate) const COUNTS: &str = concat!(
    include_str!("schema/counts.sql"),
    include_str!("schema/packed.sql")
);

/// Rebuilds the full-text index of notes.
pub(crate) const WORDS: &str = include_str!("schema/words.sql");

/// Migrates a file to another schema version, in the caller's transaction.
pub(crate) fn bring_to(conn: &Connection, version: usize) -> Result<(), rusqlite::Error> {
    let from = usize::try_from(user_version(conn)?).unwrap_or(version);
    let steps = STEPS.get(from..version).unwrap_or_default();
    // This is the program's own SQL: one step widens the check of a column, which no `ALTER TABLE` does.
    let defensive = conn.db_config(DbConfig::SQLITE_DBCONFIG_DEFENSIVE)?;
    conn.set_db_config(DbConfig::SQLITE_DBCONFIG_DEFENSIVE, false)?;
    let done = steps.iter().try_for_each(|step| conn.execute_batch(step));
    conn.set_db_config(DbConfig::SQLITE_DBCONFIG_DEFENSIVE, defensive)?;
    done?;
    conn.pragma_update(None, "user_version", version as i64)
}

/// The file's own schema version; 0 for a new one.
pub(crate) fn user_version(conn: &Connection) -> Result<i32, rusqlite::Error> {
    conn.query_row("PRAGMA user_version", [], |row| row.get(0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sql_functions;

    #[test]
    fn the_sql_names_our_application_id() {
        let sql = format!("PRAGMA application_id = {APPLICATION_ID};");
        assert!(include_str!("schema/0001.sql").contains(&sql));
    }

    #[test]
    fn the_steps_apply() {
        let conn = Connection::open_in_memory().expect("a database in memory");
        sql_functions::register(&conn).expect("functions");
        bring_to(&conn, STEPS.len()).expect("every step applies to the one before");
    }

    /// Goal: a program killed in the middle of bringing a file up to date leaves the file it found.
    /// Method: the disk as it would be then, with part of the work in the log and no commit: a page cache
    /// too small for it drives it there.
    #[test]
    fn a_file_whose_migration_was_interrupted_is_unchanged() {
        let dir = tempfile::tempdir().expect("a directory");
        let path = dir.path().join("a.db");
        let conn = Connection::open(&path).expect("made");
        let old = [
            include_str!("schema/0001.sql"),
            include_str!("schema/0002.sql"),
            include_str!("schema/0003.sql"),
        ];
        let runs = "WITH RECURSIVE n(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM n WHERE n < 2000)
            INSERT INTO run(id, unit, line, seed, operator, source, started_at_us, app_version,
                scripts_sha256, unit_config_sha256, owner)
            SELECT randomblob(16), 1, 'line8', 1, '', 'sim', n, '', '', '', '' FROM n";
        conn.execute_batch(&format!(
            "PRAGMA journal_mode = WAL; {} PRAGMA user_version = 3;
             INSERT INTO unit VALUES (1, 'ATC-1', 'atc', 'sg100', '{{}}'); {runs};
             PRAGMA wal_checkpoint(TRUNCATE); PRAGMA cache_size = 5; BEGIN IMMEDIATE",
            old.concat()
        ))
        .expect("an old file");
        sql_functions::register(&conn).expect("functions");
        let counts = include_str!("schema/counts.sql");
        for sql in [include_str!("schema/0004.sql"), counts, WORDS] {
            conn.execute_batch(sql).expect("under way");
        }
        conn.execute_batch("UPDATE run SET train = 'T' || seq; PRAGMA user_version = 4")
            .expect("nearly done");

        let killed = dir.path().join("killed.db");
        let log = |path: &std::path::Path| path.with_extension("db-wal");
        std::fs::copy(&path, &killed).expect("the file");
        let written = std::fs::copy(log(&path), log(&killed)).expect("its log");
        assert!(written > 100_000, "{written}: the work was under way");
        let found = Connection::open(&killed).expect("opens");
        assert_eq!(user_version(&found).expect("readable"), 3);
        let one = |sql: &str| found.query_row(sql, [], |row| row.get::<_, String>(0));
        assert_eq!(one("PRAGMA integrity_check").expect("checked"), "ok");
        let train = one("SELECT train FROM run").expect_err("not a column yet");
        assert!(train.to_string().contains("no such column"), "{train}");
        sql_functions::register(&found).expect("functions");
        bring_to(&found, STEPS.len()).expect("and it can be brought up to date");
        assert_eq!(user_version(&found).expect("readable"), SCHEMA_VERSION);
    }
}
