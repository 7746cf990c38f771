//! One open database file: how it is opened, checked and written to.

use std::cell::{RefCell, RefMut};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rusqlite::{Connection, ErrorCode, OpenFlags, Transaction, TransactionBehavior};

use crate::error::StoreError;
use crate::id::{Id, IdSource};
use crate::schema::{self, APPLICATION_ID, SCHEMA_VERSION};
use crate::trace::{Channel, TraceCodec, TraceError};

/// Programs that create one file at the same time may get in each other's way this often.
const WAL_TRIES: u32 = 200;

/// How far a commit goes before it returns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Synchronous {
    /// On the disk: a commit survives a power cut. For everything that is recorded.
    Full,
    /// With the system: a commit survives the program's death, not a power cut. For benches.
    Normal,
}

/// How to open a file for writing.
#[derive(Debug)]
pub struct OpenOptions {
    ids: IdSource,
    busy_timeout_ms: u32,
    synchronous: Synchronous,
    max_pages: Option<u32>,
}

impl OpenOptions {
    /// The usual way: on the disk at each commit, five seconds' patience with other writers.
    pub fn new(ids: IdSource) -> Self {
        Self {
            ids,
            busy_timeout_ms: 5_000,
            synchronous: Synchronous::Full,
            max_pages: None,
        }
    }

    /// How long to wait for another writer before the file counts as locked.
    pub fn busy_timeout_ms(mut self, busy_timeout_ms: u32) -> Self {
        self.busy_timeout_ms = busy_timeout_ms;
        self
    }

    /// How far a commit goes.
    pub fn synchronous(mut self, synchronous: Synchronous) -> Self {
        self.synchronous = synchronous;
        self
    }

    /// Refuses to let the file grow beyond this many 4096-byte pages, like a disk of that size.
    pub fn max_pages(mut self, max_pages: u32) -> Self {
        self.max_pages = Some(max_pages);
        self
    }
}

/// One open database. Not shared between threads; open the file once per thread instead.
pub struct Store {
    pub(crate) conn: Connection,
    path: PathBuf,
    ids: Option<RefCell<IdSource>>,
    codec: RefCell<TraceCodec>,
    pub(crate) channel_sets: RefCell<BTreeMap<i64, Arc<[Channel]>>>,
}

impl std::fmt::Debug for Store {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Store")
            .field("path", &self.path)
            .finish_non_exhaustive()
    }
}

impl Store {
    /// Opens a file for writing; creates it, or brings its schema up to date, if need be. A file of
    /// an earlier schema is copied first, to `FILE.schemaN` beside it.
    pub fn open(path: &Path, options: OpenOptions) -> Result<Self, StoreError> {
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE
            | OpenFlags::SQLITE_OPEN_CREATE
            | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let looked = connect(path, path, flags, options.busy_timeout_ms)
            .and_then(|conn| identify(&conn, path).map(|version| (conn, version)));
        let (mut conn, version) = match looked {
            // On a write-protected disk SQLite fails before it can say why; what can be read but not
            // opened for writing is read-only.
            Err(StoreError::CannotOpen { .. }) if Self::open_read_only(path).is_ok() => {
                return Err(StoreError::ReadOnly {
                    path: path.to_path_buf(),
                });
            }
            other => other?,
        };
        let failed = |error| StoreError::from_sqlite(path, "opening", error);
        // SQLite opens a write-protected file for reading without a word.
        if conn.is_readonly("main").map_err(failed)? {
            return Err(StoreError::ReadOnly {
                path: path.to_path_buf(),
            });
        }
        if (1..SCHEMA_VERSION).contains(&version) {
            keep_copy(&conn, path, version)?;
        }
        set_up(&mut conn, version, &options).map_err(failed)?;
        Self::wrap(conn, path, Some(options.ids))
    }

    /// Opens a file for reading only; never creates, migrates or locks it.
    ///
    /// On a read-only directory the file is read as it stands, provided that no other program left
    /// unfinished work beside it.
    pub fn open_read_only(path: &Path) -> Result<Self, StoreError> {
        if !path.exists() {
            return Err(StoreError::Missing {
                path: path.to_path_buf(),
            });
        }
        let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let looked = connect(path, path, flags, READ_BUSY_TIMEOUT_MS)
            .and_then(|conn| identify(&conn, path).map(|version| (conn, version)));
        let (conn, version) = match looked {
            // A write-ahead log needs a file beside the database, which this directory refuses.
            Err(StoreError::CannotOpen { .. } | StoreError::ReadOnly { .. })
                if !has_write_ahead_log(path) =>
            {
                let flags = flags | OpenFlags::SQLITE_OPEN_URI;
                let conn = connect(path, &immutable_uri(path), flags, READ_BUSY_TIMEOUT_MS)?;
                let version = identify(&conn, path)?;
                (conn, version)
            }
            other => other?,
        };
        match version {
            0 => Err(StoreError::Missing {
                path: path.to_path_buf(),
            }),
            found if found < SCHEMA_VERSION => {
                let known = SCHEMA_VERSION;
                Err(StoreError::OlderSchema {
                    path: path.to_path_buf(),
                    found,
                    known,
                })
            }
            _ => Self::wrap(conn, path, None),
        }
    }

    /// The file's path, as it was given.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether it was opened for reading only.
    pub fn is_read_only(&self) -> bool {
        self.ids.is_none()
    }

    /// Moves everything into the one file and closes it. Dropping closes it too, but cannot say
    /// what went wrong.
    pub fn close(self) -> Result<(), StoreError> {
        if !self.is_read_only() {
            self.checkpoint()?;
        }
        let path = self.path;
        let closed = self.conn.close();
        closed.map_err(|(_, error)| StoreError::from_sqlite(&path, "closing", error))
    }

    /// Empties the write-ahead log as far as other readers allow.
    pub(crate) fn checkpoint(&self) -> Result<(), StoreError> {
        let done = self
            .conn
            .query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |_| Ok(()));
        done.map_err(|error| self.failed("writing back the log", error))
    }

    /// Runs `work` in one short write transaction; rolls back when it fails.
    pub(crate) fn write<T>(
        &self,
        doing: &'static str,
        work: impl FnOnce(&Connection) -> Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        if self.is_read_only() {
            return Err(StoreError::ReadOnly {
                path: self.path.clone(),
            });
        }
        let failed = |error| self.failed(doing, error);
        // Immediate: a transaction that begins by reading cannot wait for another writer.
        let begun = Transaction::new_unchecked(&self.conn, TransactionBehavior::Immediate);
        let transaction = begun.map_err(failed)?;
        let result = work(&transaction)?;
        transaction.commit().map_err(failed)?;
        Ok(result)
    }

    pub(crate) fn failed(&self, doing: &'static str, error: rusqlite::Error) -> StoreError {
        StoreError::from_sqlite(&self.path, doing, error)
    }

    pub(crate) fn mint(&self) -> Result<Id, StoreError> {
        match &self.ids {
            Some(ids) => Ok(ids.borrow_mut().mint()),
            None => Err(StoreError::ReadOnly {
                path: self.path.clone(),
            }),
        }
    }

    pub(crate) fn codec(&self) -> RefMut<'_, TraceCodec> {
        self.codec.borrow_mut()
    }

    fn wrap(conn: Connection, path: &Path, ids: Option<IdSource>) -> Result<Self, StoreError> {
        conn.set_prepared_statement_cache_capacity(STATEMENT_CACHE);
        let codec = TraceCodec::new().map_err(|error: TraceError| StoreError::Io {
            path: path.to_path_buf(),
            reason: error.to_string(),
        })?;
        Ok(Self {
            conn,
            path: path.to_path_buf(),
            ids: ids.map(RefCell::new),
            codec: RefCell::new(codec),
            channel_sets: RefCell::default(),
        })
    }
}

/// Copies of files of an earlier schema that may lie beside a file.
const MAX_COPIES: u32 = 9;

/// More than the crate has statements that repeat.
const STATEMENT_CACHE: usize = 64;

/// One page of the smallest size SQLite has.
const SMALLEST_FILE_BYTES: u64 = 512;

const READ_BUSY_TIMEOUT_MS: u32 = 5_000;

fn connect(
    path: &Path,
    name: &Path,
    flags: OpenFlags,
    busy_timeout_ms: u32,
) -> Result<Connection, StoreError> {
    if path.is_dir() {
        let reason = "it is a directory".to_owned();
        return Err(StoreError::CannotOpen {
            path: path.to_path_buf(),
            reason,
        });
    }
    let failed = |error| StoreError::from_sqlite(path, "opening", error);
    let conn = Connection::open_with_flags(name, flags).map_err(failed)?;
    conn.busy_timeout(std::time::Duration::from_millis(busy_timeout_ms.into()))
        .map_err(failed)?;
    Ok(conn)
}

/// The schema version of a file of ours, 0 for an empty one; an error for any other file. Looks
/// only, so that a file that is not ours stays as it is.
fn identify(conn: &Connection, path: &Path) -> Result<i32, StoreError> {
    // SQLite takes a file too short for its header for an empty one, and would write over it.
    if std::fs::metadata(path).is_ok_and(|file| (1..SMALLEST_FILE_BYTES).contains(&file.len())) {
        return Err(StoreError::NotADatabase {
            path: path.to_path_buf(),
        });
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

fn set_up(
    conn: &mut Connection,
    version: i32,
    options: &OpenOptions,
) -> Result<(), rusqlite::Error> {
    if version == 0 {
        // Takes effect only before the first table.
        conn.execute_batch("PRAGMA auto_vacuum = INCREMENTAL")?;
    }
    enter_wal(conn)?;
    conn.execute_batch(match options.synchronous {
        Synchronous::Full => "PRAGMA synchronous = FULL",
        Synchronous::Normal => "PRAGMA synchronous = NORMAL",
    })?;
    conn.execute_batch("PRAGMA foreign_keys = ON")?;
    if version < SCHEMA_VERSION {
        conn.set_transaction_behavior(TransactionBehavior::Immediate);
        schema::migrate(conn)?;
    }
    if let Some(pages) = options.max_pages {
        conn.query_row(&format!("PRAGMA max_page_count = {pages}"), [], |_| Ok(()))?;
    }
    Ok(())
}

/// Copies a file of an earlier schema before it is brought up to date. A copy that is there already
/// is left alone: it may be the better one.
fn keep_copy(conn: &Connection, path: &Path, version: i32) -> Result<(), StoreError> {
    let mut copies = (1..=MAX_COPIES).map(|number| {
        let mut name = path.as_os_str().to_owned();
        name.push(format!(".schema{version}"));
        if number > 1 {
            name.push(format!(".{number}"));
        }
        PathBuf::from(name)
    });
    let Some(copy) = copies.find(|copy| !copy.exists()) else {
        let mut first = path.as_os_str().to_owned();
        first.push(format!(".schema{version}"));
        return Err(StoreError::TargetExists { path: first.into() });
    };
    let name = copy.to_str().ok_or_else(|| StoreError::CannotOpen {
        path: copy.clone(),
        reason: "the name is not UTF-8".to_owned(),
    })?;
    conn.execute("VACUUM INTO ?1", [name])
        .map(drop)
        .map_err(|error| {
            // A copy cut short is worse than none.
            let _ = std::fs::remove_file(&copy);
            StoreError::from_sqlite(&copy, "keeping a copy of the older schema", error)
        })
}

/// Turns write-ahead logging on. SQLite does not wait for others while it changes a new file over;
/// waiting for a write lock in between does, as long as the busy timeout allows.
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

fn has_write_ahead_log(path: &Path) -> bool {
    let mut name = path.as_os_str().to_owned();
    name.push("-wal");
    std::fs::metadata(name).is_ok_and(|log| log.len() > 0)
}

/// `file:` with everything escaped that has a meaning in a URI.
fn immutable_uri(path: &Path) -> PathBuf {
    let mut uri = String::from("file:");
    for byte in path.as_os_str().as_encoded_bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'/' | b'.' | b'-' | b'_' | b'~' => {
                uri.push(char::from(*byte));
            }
            _ => uri.push_str(&format!("%{byte:02X}")),
        }
    }
    uri.push_str("?immutable=1");
    PathBuf::from(uri)
}
