//! Places of the window's data: the database (a file or a server) and the scripts directory.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use fault_db::{Address, FileChange, Store, StoreError};

use ptu_runs::clock;
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::failure::Failure;
use ptu_runs::{keys, owner_only};

/// The database and files that pages read, and in which runs are recorded.
#[derive(Clone, Debug)]
pub struct DataPaths {
    /// The database file, or the address of a server as it is shown.
    pub database: PathBuf,
    /// The server, if the database is on one; a server is read and never written to.
    server: Option<Address>,
    /// Procedures, lines, units, trains.
    pub scripts: ScriptsDirectory,
    /// The folder of the keys of this computer's user.
    pub keys: PathBuf,
    /// The database existed at some time; shared by all clones.
    was_there: Arc<AtomicBool>,
}

impl DataPaths {
    /// Paths of a history in a file; nothing is opened yet.
    pub fn new(database: PathBuf, scripts: ScriptsDirectory) -> Self {
        Self {
            database,
            server: None,
            scripts,
            keys: keys::own_folder().unwrap_or_default(),
            was_there: Arc::default(),
        }
    }

    /// Paths of a history on a server; the window is not connected to it yet.
    pub fn of_server(server: Address, scripts: ScriptsDirectory) -> Self {
        Self {
            server: Some(server.clone()),
            ..Self::new(server.to_string().into(), scripts)
        }
    }

    /// The history is on a server, which is only read.
    pub fn is_server(&self) -> bool {
        self.server.is_some()
    }

    /// Whether there is a history to read.
    pub fn is_there(&self) -> bool {
        self.is_server() || self.database.exists()
    }

    /// The database existed and is gone.
    pub fn is_gone(&self) -> bool {
        self.was_there.load(Ordering::Relaxed) && !self.is_there()
    }

    /// Opens the database for writing. A missing database is created, but not if it existed before.
    ///
    /// # Errors
    /// The database cannot be opened, is gone, or is a server.
    pub fn open(&self) -> Result<Store, Failure> {
        if self.is_server() {
            let path = self.database.clone();
            return Err(StoreError::ReadOnly(path).into());
        }
        if self.is_gone() {
            let (path, what) = (self.database.clone(), FileChange::Gone);
            return Err(StoreError::FileChanged { path, what }.into());
        }
        owner_only::folder_of(&self.database)?;
        Ok(self.seen(Store::open(&self.database, clock::open_options())?))
    }

    fn seen(&self, store: Store) -> Store {
        self.was_there.store(true, Ordering::Relaxed);
        store
    }

    /// Opens the database for reading. A missing database is created; one of an older schema is first copied
    /// beside it, and then brought up to date.
    ///
    /// # Errors
    /// The database cannot be opened.
    pub fn read(&self) -> Result<Store, Failure> {
        if let Some(server) = &self.server {
            return Ok(self.seen(Store::connect_read_only(server)?));
        }
        if !self.database.exists() {
            self.open()?.close()?;
        }
        match Store::open_read_only(&self.database) {
            Err(StoreError::OlderSchema { .. }) => {
                self.open()?.close()?;
                Ok(self.seen(Store::open_read_only(&self.database)?))
            }
            opened => Ok(self.seen(opened?)),
        }
    }
}

/// A file that SQLite keeps beside the database.
pub fn beside(database: &Path, ending: &str) -> PathBuf {
    let mut name = database.as_os_str().to_owned();
    name.push(ending);
    name.into()
}
