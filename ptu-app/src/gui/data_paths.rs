//! Where the window's data are: the database file and the scripts directory.

use std::path::PathBuf;

use fault_db::{Store, StoreError};

use ptu_bench::clock;
use ptu_bench::data::ScriptsDirectory;
use ptu_bench::failure::Failure;
use ptu_bench::owner_only;

/// The files that pages read and runs are recorded in.
#[derive(Clone, Debug)]
pub struct DataPaths {
    /// The database file.
    pub database: PathBuf,
    /// Procedures, lines, units.
    pub scripts: ScriptsDirectory,
}

impl DataPaths {
    /// The database, to be written to; made if it is not there.
    ///
    /// # Errors
    /// It cannot be opened.
    pub fn open(&self) -> Result<Store, Failure> {
        owner_only::folder_of(&self.database)?;
        Ok(Store::open(&self.database, clock::open_options())?)
    }

    /// The database, to be read; one that is not there yet is made, one of an older schema is copied
    /// and brought up to date.
    ///
    /// # Errors
    /// It cannot be opened.
    pub fn read(&self) -> Result<Store, Failure> {
        if !self.database.exists() {
            self.open()?.close()?;
        }
        match Store::open_read_only(&self.database) {
            Err(StoreError::OlderSchema { .. }) => {
                self.open()?.close()?;
                Ok(Store::open_read_only(&self.database)?)
            }
            opened => Ok(opened?),
        }
    }
}
