//! Opens a file: for writing, which creates or migrates it, or for reading only.

use std::path::Path;

use rusqlite::{Connection, OpenFlags};

use crate::error::StoreError;
use crate::files::platform::Identity;
use crate::id::Id;
use crate::schema::SCHEMA_VERSION;
use crate::schema::guard;
use crate::store::atomic_file::make_private;
use crate::store::file::{
    READ_BUSY_TIMEOUT_MS, connect, has_write_ahead_log, identify, immutable_uri, keep_copy, set_up,
    set_up_to_record,
};
use crate::store::open_options::OpenOptions;
use crate::store::{Store, place};
use crate::{schema, seal};

impl Store {
    /// Opens a file for writing; creates it, or migrates its schema, if need be. A file of an earlier schema is copied
    /// first, to `FILE.schemaN` beside it. Only its owner may read a created file.
    pub fn open(path: &Path, options: OpenOptions) -> Result<Self, StoreError> {
        // Only a new file is created here: opening and closing an existing one would release SQLite's locks on it. If
        // none can be created, SQLite's own attempt gives the reason.
        if !path.exists() {
            let _ = make_private(path);
        }
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE
            | OpenFlags::SQLITE_OPEN_CREATE
            | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let looked = connect(path, path, flags, options.busy_timeout_ms)
            .and_then(|conn| identify(&conn, path).map(|version| (conn, version)));
        let (conn, version) = match looked {
            // On a write-protected disk SQLite fails without the reason; a file that opens for reading only is
            // read-only.
            Err(StoreError::CannotOpen { .. }) if Self::open_read_only(path).is_ok() => {
                return Err(StoreError::ReadOnly(path.to_path_buf()));
            }
            other => other?,
        };
        let failed = |error| StoreError::from_sqlite(path, "opening", error);
        // SQLite silently opens a write-protected file for reading.
        if conn.is_readonly("main").map_err(failed)? {
            return Err(StoreError::ReadOnly(path.to_path_buf()));
        }
        refuse_foreign_objects(&conn, path)?;
        if (1..SCHEMA_VERSION).contains(&version) {
            keep_copy(&conn, path, version)?;
        }
        let OpenOptions {
            ids,
            synchronous,
            max_pages,
            ..
        } = options;
        set_up(&conn, version, synchronous).map_err(failed)?;
        let mut store = Self::of_file(conn, path, Some(ids))?;
        // A file with two names is refused: what is written under one is lost to the other.
        store.check_place()?;
        store.bring_up_to_date(version)?;
        store.log = Identity::at(&place::log_of(path));
        set_up_to_record(store.file()?, max_pages).map_err(failed)?;
        Ok(store)
    }

    /// Opens a file for reading only; never creates, migrates or locks it.
    ///
    /// In a read-only directory the file is read as it is, provided that no other program left unfinished
    /// work beside it.
    pub fn open_read_only(path: &Path) -> Result<Self, StoreError> {
        if !path.exists() {
            return Err(StoreError::Missing(path.to_path_buf()));
        }
        let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let looked = connect(path, path, flags, READ_BUSY_TIMEOUT_MS)
            .and_then(|conn| identify(&conn, path).map(|version| (conn, version)));
        let (conn, version) = match looked {
            // A write-ahead log needs a file beside the database, which this directory refuses.
            Err(StoreError::CannotOpen { .. } | StoreError::ReadOnly(_))
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
            0 => Err(StoreError::Missing(path.to_path_buf())),
            found if found < SCHEMA_VERSION => {
                let known = SCHEMA_VERSION;
                Err(StoreError::OlderSchema {
                    path: path.to_path_buf(),
                    found,
                    known,
                })
            }
            _ => Self::of_file(conn, path, None),
        }
    }

    /// Creates the tables of a new file, or migrates those of an earlier version, and begins its chain of
    /// seals, in one transaction; returns the file's id, which is given once.
    fn bring_up_to_date(&self, version: i32) -> Result<Id, StoreError> {
        const DOING: &str = "bringing it up to date";
        if version < SCHEMA_VERSION {
            let minted = self.mint()?;
            return self.write(DOING, |conn| {
                let failed = |error| self.failed(DOING, error);
                // Another program may have migrated the file meanwhile.
                let from = schema::user_version(conn).map_err(failed)?;
                if from == SCHEMA_VERSION {
                    return self.name();
                }
                schema::bring_up_to_date(conn).map_err(failed)?;
                if from > 0 {
                    return self.name();
                }
                self.ask(DOING, |file| seal::begin(file, minted))
            });
        }
        self.name()
    }
}

/// Refuses to write to a file that holds objects which no version of this program made.
fn refuse_foreign_objects(conn: &Connection, path: &Path) -> Result<(), StoreError> {
    let look = || {
        // One snapshot: another program may be migrating the file this moment.
        let _snapshot = conn.unchecked_transaction()?;
        match schema::user_version(conn)? {
            0 => Ok(Vec::new()),
            version => guard::foreign_objects(conn, version),
        }
    };
    let foreign_objects =
        look().map_err(|error| StoreError::from_sqlite(path, "opening", error))?;
    match &foreign_objects[..] {
        [] => Ok(()),
        [first, rest @ ..] => Err(StoreError::Altered {
            path: path.to_path_buf(),
            what: Box::new(first.clone()),
            more: rest.len(),
        }),
    }
}
