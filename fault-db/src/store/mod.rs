//! One open history, in a file or on a server: queries, transactions.

pub(crate) mod atomic_file;
pub(crate) mod file;
mod head;
mod lookup;
pub(crate) mod open_options;
mod opening;
mod place;
mod transaction;
mod under_way;

use std::cell::{RefCell, RefMut};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rusqlite::{Connection, Transaction, TransactionBehavior};

use crate::backend::{Backend, Row, Server, SqlError, SqlResult, Value};
use crate::error::{Damage, StoreError};
use crate::files::platform::Identity;
use crate::id::{Id, IdSource};
use crate::schema::SCHEMA_VERSION;
use crate::schema::guard;
use crate::seal;
use crate::signature::{Signer, sign_new_entries};
use crate::trace::{Channel, TraceCodec, TraceError};

/// SQL statements kept prepared; more than this crate repeats.
const STATEMENT_CACHE: usize = 64;

/// One open history. Not shared between threads; open it once per thread instead.
///
/// Runs are recorded in a file. Queries, and changes of faults by users, work on a server as well.
pub struct Store {
    pub(crate) backend: Backend,
    path: PathBuf,
    ids: Option<RefCell<IdSource>>,
    codec: RefCell<TraceCodec>,
    pub(crate) channel_sets: RefCell<BTreeMap<i64, Arc<[Channel]>>>,
    signer: RefCell<Option<Arc<Signer>>>,
    /// Identity of the file when it was opened.
    identity: Option<Identity>,
    /// Identity of the file's write-ahead log at that time; `None` for a store that only reads.
    log: Option<Identity>,
}

impl std::fmt::Debug for Store {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Store")
            .field("path", &self.path)
            .finish_non_exhaustive()
    }
}

impl Store {
    /// Objects in this file that this program did not make, or that were altered. Such a file is not opened for
    /// writing; a reader may be warned.
    pub fn foreign_objects(&self) -> Result<Vec<Damage>, StoreError> {
        let Backend::File(conn) = &self.backend else {
            return Ok(Vec::new());
        };
        let found = guard::foreign_objects(conn, SCHEMA_VERSION);
        found.map_err(|error| self.failed("looking at its tables", error))
    }

    /// Sets how long to wait for other writers of the file. While opening, a short wait is best; work in the background
    /// may rather wait longer than lose what it has.
    ///
    /// # Errors
    /// The store is on a server, which has no such time-out.
    pub fn set_busy_timeout_ms(&self, busy_timeout_ms: u32) -> Result<(), StoreError> {
        let timeout = std::time::Duration::from_millis(busy_timeout_ms.into());
        let set = self.file()?.busy_timeout(timeout);
        set.map_err(|error| self.failed("setting how long to wait", error))
    }

    /// Signs from now on what is recorded in this file: runs, events, notes and instruments, each in the transaction
    /// that seals it. `None` ends signing.
    pub fn sign_with(&self, signer: Option<Arc<Signer>>) {
        *self.signer.borrow_mut() = signer;
    }

    /// The signer that [`sign_with`](Self::sign_with) set.
    pub fn signer(&self) -> Option<Arc<Signer>> {
        self.signer.borrow().clone()
    }

    /// The file's path as it was given, or a server's address without the password.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether the store was opened for reading only.
    pub fn is_read_only(&self) -> bool {
        self.ids.is_none()
    }

    /// The file's id. Without the id the file's chain of seals is lost, and must not be begun again.
    fn name(&self) -> Result<Id, StoreError> {
        let name = self.ask("reading its name", seal::own_file_id)?;
        name.ok_or_else(|| StoreError::Altered {
            path: self.path.clone(),
            what: Box::new(Damage::NoName),
            more: 0,
        })
    }

    /// The file's id, under which its seals are made.
    pub(crate) fn file_id(&self) -> Result<Id, StoreError> {
        self.check_writable()?;
        self.name()
    }

    /// Checkpoints the write-ahead log and closes the file. Dropping the store closes the file, too, but cannot report
    /// an error.
    ///
    /// # Errors
    /// The log cannot be written back, or other programs do not find what was written: the file or its log was removed
    /// or replaced, or has a second name.
    pub fn close(self) -> Result<(), StoreError> {
        let written_back = self.write_back();
        let path = self.path;
        if let Backend::File(conn) = self.backend {
            conn.close()
                .map_err(|(_, error)| StoreError::from_sqlite(&path, "closing", error))?;
        }
        written_back
    }

    /// Writes the log back to the file, if that file is the one that others find under its name.
    fn write_back(&self) -> Result<(), StoreError> {
        match self.backend {
            Backend::File(_) if !self.is_read_only() => {
                self.or_keep_log_back(self.check_place())?;
                self.checkpoint()
            }
            _ => Ok(()),
        }
    }

    /// Checkpoints the write-ahead log as far as other readers allow.
    pub(crate) fn checkpoint(&self) -> Result<(), StoreError> {
        let done = self
            .file()?
            .query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |_| Ok(()));
        done.map_err(|error| self.failed("writing back the log", error))
    }

    /// Ends work on the file once `stops` returns true, within milliseconds and with [`StoreError::Stopped`]: the open
    /// transaction adds nothing, and an incomplete copy is removed. Holds until another `stops` is set.
    ///
    /// # Errors
    /// SQLite refuses, or the store is a server, whose work cannot be stopped like this.
    pub fn stop_when(
        &self,
        stops: impl FnMut() -> bool + Send + 'static,
    ) -> Result<(), StoreError> {
        let set = self.file()?.progress_handler(STEPS_AT_ONCE, Some(stops));
        set.map_err(|error| self.failed("preparing to stop", error))
    }

    /// The file's connection, for operations that only files have.
    pub(crate) fn file(&self) -> Result<&Connection, StoreError> {
        match &self.backend {
            Backend::File(conn) => Ok(conn),
            Backend::Server(_) => Err(StoreError::NotAFile(self.path.clone())),
        }
    }

    /// The server's connection, for operations that only servers have.
    pub(crate) fn server(&self) -> Result<&Server, StoreError> {
        match &self.backend {
            Backend::Server(server) => Ok(server),
            Backend::File(_) => Err(StoreError::NotAServer(self.path.clone())),
        }
    }

    /// Runs `work` in one short write transaction on the file, or in the one that is open; rolls back on an
    /// error.
    pub(crate) fn write<T>(
        &self,
        doing: &'static str,
        work: impl FnOnce(&Connection) -> Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        self.check_writable()?;
        let conn = self.file()?;
        if !conn.is_autocommit() {
            return self.write_within(doing, conn, work);
        }
        let failed = |error| self.failed(doing, error);
        // Immediate: a transaction that begins by reading cannot wait for another writer.
        let begun = Transaction::new_unchecked(conn, TransactionBehavior::Immediate);
        let transaction = begun.map_err(failed)?;
        let signer = self.signer.borrow().clone();
        let known = match &signer {
            Some(_) => self.head()?.map_or(0, |head| head.entries),
            None => 0,
        };
        let result = work(&transaction)?;
        if let Some(signer) = signer {
            self.ask("signing", |file| sign_new_entries(file, &signer, known))?;
        }
        transaction.commit().map_err(failed)?;
        Ok(result)
    }

    /// Runs `work` in one short write transaction on the file or the server; rolls back on an error.
    pub(crate) fn change<T>(
        &self,
        doing: &'static str,
        work: impl FnOnce(&Backend) -> Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        let Backend::Server(server) = &self.backend else {
            return self.write(doing, |_| work(&self.backend));
        };
        self.check_writable()?;
        let failed = |error: SqlError| self.failed(doing, error);
        server.begin().map_err(failed)?;
        match work(&self.backend) {
            Ok(result) => {
                server.batch("COMMIT").map_err(failed)?;
                Ok(result)
            }
            Err(error) => {
                // If the rollback fails, too, the server drops the connection, and the work with it.
                let _ = server.batch("ROLLBACK");
                Err(error)
            }
        }
    }

    /// Runs `work`, which reads the file or server, or writes to it in the caller's transaction.
    pub(crate) fn ask<T>(
        &self,
        doing: &'static str,
        work: impl FnOnce(&Backend) -> SqlResult<T>,
    ) -> Result<T, StoreError> {
        work(&self.backend).map_err(|error| self.failed(doing, error))
    }

    /// All rows of a result.
    pub(crate) fn select<T>(
        &self,
        doing: &'static str,
        sql: &str,
        values: &[Value<'_>],
        read: impl FnMut(Row<'_>) -> SqlResult<T>,
    ) -> Result<Vec<T>, StoreError> {
        self.ask(doing, |backend| backend.select(sql, values, read))
    }

    /// The first row of a result.
    pub(crate) fn first<T>(
        &self,
        doing: &'static str,
        sql: &str,
        values: &[Value<'_>],
        read: impl FnMut(Row<'_>) -> SqlResult<T>,
    ) -> Result<Option<T>, StoreError> {
        self.ask(doing, |backend| backend.first(sql, values, read))
    }

    /// Whether a result has a row.
    pub(crate) fn has(
        &self,
        doing: &'static str,
        sql: &str,
        values: &[Value<'_>],
    ) -> Result<bool, StoreError> {
        self.ask(doing, |backend| backend.has(sql, values))
    }

    pub(crate) fn failed(&self, doing: &'static str, error: impl Into<SqlError>) -> StoreError {
        StoreError::from_sql(&self.path, doing, error.into())
    }

    pub(crate) fn check_writable(&self) -> Result<(), StoreError> {
        if self.is_read_only() {
            return Err(StoreError::ReadOnly(self.path.clone()));
        }
        Ok(())
    }

    pub(crate) fn mint(&self) -> Result<Id, StoreError> {
        match &self.ids {
            Some(ids) => Ok(ids.borrow_mut().mint()),
            None => Err(StoreError::ReadOnly(self.path.clone())),
        }
    }

    pub(crate) fn codec(&self) -> RefMut<'_, TraceCodec> {
        self.codec.borrow_mut()
    }

    fn of_file(conn: Connection, path: &Path, ids: Option<IdSource>) -> Result<Self, StoreError> {
        conn.set_prepared_statement_cache_capacity(STATEMENT_CACHE);
        Self::of(Backend::File(conn), path, ids)
    }

    pub(crate) fn of(
        backend: Backend,
        path: &Path,
        ids: Option<IdSource>,
    ) -> Result<Self, StoreError> {
        let codec = TraceCodec::new().map_err(|error: TraceError| StoreError::Io {
            path: path.to_path_buf(),
            reason: error.to_string(),
        })?;
        Ok(Self {
            backend,
            path: path.to_path_buf(),
            ids: ids.map(RefCell::new),
            codec: RefCell::new(codec),
            channel_sets: RefCell::default(),
            signer: RefCell::default(),
            identity: Identity::at(path),
            log: None,
        })
    }
}

/// Steps of SQLite's engine between two calls of `stops`; a statement of a few rows takes about as many.
const STEPS_AT_ONCE: i32 = 50;
