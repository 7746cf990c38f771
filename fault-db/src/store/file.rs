//! SQLite files: recognises those of this program, opens them, sets them up, and keeps a copy before a migration.

use std::path::{Path, PathBuf};

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_encode};
use rusqlite::{Connection, ErrorCode, OpenFlags};

use crate::error::StoreError;
use crate::files::databases::{note_opened, with_end};
use crate::schema::{self, APPLICATION_ID, SCHEMA_VERSION, guard, sql_functions};
use crate::store::atomic_file::AtomicFile;
use crate::store::open_options::Synchronous;

/// Number of tries to enter write-ahead logging: programs that create one file at the same time disturb each other.
const WAL_TRIES: u32 = 200;

/// Greatest number of copies of earlier schemas beside a file.
const MAX_COPIES: u32 = 9;

/// Page cache: enough for the upper levels of all indexes.
pub(crate) const CACHE_KIB: u32 = 16 * 1024;

/// One page of the smallest size SQLite has.
const SMALLEST_FILE_BYTES: u64 = 512;

pub(crate) const READ_BUSY_TIMEOUT_MS: u32 = 5_000;

pub(crate) fn connect(
    path: &Path,
    name: &Path,
    flags: OpenFlags,
    busy_timeout_ms: u32,
) -> Result<Connection, StoreError> {
    let cannot_open = |reason| StoreError::CannotOpen {
        path: path.to_path_buf(),
        reason,
    };
    if path.is_dir() {
        return Err(cannot_open("it is a directory".to_owned()));
    }
    // Opening a pipe would block.
    if std::fs::metadata(path).is_ok_and(|about| !about.is_file()) {
        return Err(StoreError::NotADatabase(path.to_path_buf()));
    }
    let failed = |error| StoreError::from_sqlite(path, "opening", error);
    // An absolute path, because SQLite does not take `:memory:`, `file:x` or an empty text for the name of a file.
    let from_root = match flags.contains(OpenFlags::SQLITE_OPEN_URI) {
        true => Ok(name.to_path_buf()),
        false => std::path::absolute(name),
    };
    let name = from_root.map_err(|error| cannot_open(error.to_string()))?;
    let conn = Connection::open_with_flags(&name, flags).map_err(failed)?;
    note_opened(path);
    conn.busy_timeout(std::time::Duration::from_millis(busy_timeout_ms.into()))
        .map_err(failed)?;
    sql_functions::register(&conn).map_err(failed)?;
    let may_write = flags.contains(OpenFlags::SQLITE_OPEN_READ_WRITE);
    guard::harden(&conn, may_write).map_err(failed)?;
    conn.execute_batch(&format!("PRAGMA cache_size = -{CACHE_KIB}"))
        .map_err(failed)?;
    Ok(conn)
}

/// The schema version of a file of this program, 0 for an empty file; an error for any other file. Only reads, so that
/// a foreign file stays as it is.
pub(crate) fn identify(conn: &Connection, path: &Path) -> Result<i32, StoreError> {
    // SQLite takes a file too short for its header for an empty one, and would overwrite it.
    if std::fs::metadata(path).is_ok_and(|file| (1..SMALLEST_FILE_BYTES).contains(&file.len())) {
        return Err(StoreError::NotADatabase(path.to_path_buf()));
    }
    let failed = |error| StoreError::from_sqlite(path, "opening", error);
    // One snapshot: another program may be creating the file this moment.
    let _snapshot = conn.unchecked_transaction().map_err(failed)?;
    let pragma = |sql: &str| {
        conn.query_row(sql, [], |row| row.get::<_, i32>(0))
            .map_err(failed)
    };
    let application_id = pragma("PRAGMA application_id")?;
    let version = schema::user_version(conn).map_err(failed)?;
    let is_empty = pragma("SELECT count(*) FROM sqlite_schema")? == 0;
    let is_new = application_id == 0 && version == 0 && is_empty;
    if !is_new && application_id != APPLICATION_ID {
        return Err(StoreError::ForeignDatabase {
            path: path.to_path_buf(),
            application_id,
        });
    }
    if version > SCHEMA_VERSION {
        let known = SCHEMA_VERSION;
        return Err(StoreError::NewerSchema {
            path: path.to_path_buf(),
            found: version,
            known,
        });
    }
    Ok(version)
}

/// Sets what must be set before a file is migrated.
pub(crate) fn set_up(
    conn: &Connection,
    version: i32,
    synchronous: Synchronous,
) -> Result<(), rusqlite::Error> {
    if version == 0 {
        // Takes effect only before the first table.
        conn.execute_batch("PRAGMA auto_vacuum = INCREMENTAL")?;
    }
    enter_wal(conn)?;
    conn.execute_batch(match synchronous {
        Synchronous::Full => "PRAGMA synchronous = FULL",
        Synchronous::Normal => "PRAGMA synchronous = NORMAL",
    })?;
    conn.execute_batch("PRAGMA foreign_keys = ON")
}

/// Sets what recording needs, in a file of the current schema.
pub(crate) fn set_up_to_record(
    conn: &Connection,
    max_pages: Option<u32>,
) -> Result<(), rusqlite::Error> {
    // A statement that fires triggers keeps the pages it changes in a journal until it is done; on disk that
    // costs more than the rows. Not set earlier, because migrations sort more than fits in memory.
    conn.execute_batch("PRAGMA temp_store = MEMORY")?;
    if let Some(pages) = max_pages {
        conn.query_row(&format!("PRAGMA max_page_count = {pages}"), [], |_| Ok(()))?;
    }
    Ok(())
}

/// Copies a file of an earlier schema before its migration. An existing copy is left alone: it may be the
/// better one.
pub(crate) fn keep_copy(conn: &Connection, path: &Path, version: i32) -> Result<(), StoreError> {
    const DOING: &str = "keeping a copy of the older schema";
    let failed = |error| StoreError::from_sqlite(path, DOING, error);
    // Another program may be migrating the file, and then has made the copy.
    if schema::user_version(conn).map_err(failed)? != version {
        return Ok(());
    }
    let first = with_end(path, &format!(".schema{version}"));
    let later = (2..=MAX_COPIES).map(|number| with_end(&first, &format!(".{number}")));
    let mut copies = std::iter::once(first.clone()).chain(later);
    let Some(copy) = copies.find(|copy| !copy.exists()) else {
        return Err(StoreError::TargetExists(first));
    };
    let part = AtomicFile::copy(conn, &copy, DOING)?;
    if part.version()? != version {
        return Ok(());
    }
    match part.publish() {
        // Another program made the same copy a moment ago.
        Err(StoreError::TargetExists(_)) => Ok(()),
        done => done,
    }
}

/// Copies a whole file, compacted, to a free name.
pub(crate) fn copy_to(conn: &Connection, to: &Path, doing: &'static str) -> Result<(), StoreError> {
    AtomicFile::copy(conn, to, doing)?.publish()
}

/// Turns write-ahead logging on. SQLite does not wait for other programs while it changes the mode of a new file;
/// waiting for a write lock between two tries does, up to the busy timeout.
fn enter_wal(conn: &Connection) -> Result<(), rusqlite::Error> {
    let turn_on = || conn.query_row("PRAGMA journal_mode = WAL", [], |_| Ok(()));
    for _ in 1..WAL_TRIES {
        match turn_on() {
            Err(error) if error.sqlite_error_code() == Some(ErrorCode::DatabaseBusy) => {
                conn.execute_batch("BEGIN IMMEDIATE; COMMIT")?;
            }
            done => return done,
        }
    }
    turn_on()
}

pub(crate) fn has_write_ahead_log(path: &Path) -> bool {
    std::fs::metadata(with_end(path, "-wal")).is_ok_and(|log| log.len() > 0)
}

/// A `file:` URI with all special characters escaped.
pub(crate) fn immutable_uri(path: &Path) -> PathBuf {
    const LETTERS: AsciiSet = NON_ALPHANUMERIC
        .remove(b'/')
        .remove(b'.')
        .remove(b'-')
        .remove(b'_')
        .remove(b'~');
    let path = percent_encode(path.as_os_str().as_encoded_bytes(), &LETTERS);
    PathBuf::from(format!("file:{path}?immutable=1"))
}
