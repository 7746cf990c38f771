//! `--db`: selects the history, a file or a server.

use std::path::{Path, PathBuf};

use clap::Args;
use fault_db::{Address, Store, StoreError};

use ptu_report::words::Words;
use ptu_runs::clock;
use ptu_runs::failure::{Asked, Failure, FileTrouble};
use ptu_runs::{owner_only, stdio};

/// Environment variable that names the history of commands without `--db`.
const VARIABLE: &str = "PTU_DB";
/// Place of `--db` among the options: after all but the terminal's and `--help`.
const LAST: usize = 998;

/// Option that names the history.
#[derive(Debug, Args)]
pub struct Database {
    /// Database file, or postgres://USER@HOST/DATABASE [default: history.db in the user's data directory]
    /// [env: PTU_DB]
    // Read by this module, not by clap, which would show the option as required wherever the variable is set.
    #[arg(long, value_name = "FILE", global = true, display_order = LAST)]
    db: Option<PathBuf>,
}

/// The server's address, if the path is an address; `None` for the path of a file.
fn as_address(path: &Path) -> Option<Result<Address, StoreError>> {
    let text = path.to_string_lossy();
    Address::is_meant(&text).then(|| text.parse())
}

/// The path of a second file beside `--db`; refuses a server's address, which would be taken for a file's name.
pub fn only_file(path: &Path) -> Result<&Path, Failure> {
    match as_address(path) {
        None => Ok(path),
        Some(address) => Err(StoreError::NotAFile(address?.to_string().into()).into()),
    }
}

impl Database {
    /// What the user named, or else `history.db` in the user's data directory.
    fn path(&self) -> Result<PathBuf, Failure> {
        let Some(path) = self.named() else {
            let file = directories::ProjectDirs::from("", "", "ptu")
                .map(|directories| directories.data_dir().join("history.db"));
            return file.ok_or_else(|| Failure::usage(FileTrouble::NoUserFolder("--db")));
        };
        match path.as_os_str().is_empty() {
            true => Err(Failure::usage(Asked::VariableEmpty(VARIABLE.to_string()))),
            false => Ok(path),
        }
    }

    /// What the user named by the option or the variable.
    fn named(&self) -> Option<PathBuf> {
        let variable = || std::env::var_os(VARIABLE).map(PathBuf::from);
        self.db.clone().or_else(variable)
    }

    /// Path of the database file; refuses a server, for what a server cannot do.
    pub fn file(&self) -> Result<PathBuf, Failure> {
        let path = self.path()?;
        only_file(&path)?;
        Ok(path)
    }

    /// The server's address if the database is on a server, else `None`.
    pub fn server(&self) -> Result<Option<Address>, Failure> {
        Ok(as_address(&self.path()?).transpose()?)
    }

    /// The server's address if the database is on a server; refuses a file that does not exist.
    fn server_or_there(&self) -> Result<Option<Address>, Failure> {
        let (server, path) = (self.server()?, self.path()?);
        match server.is_none() && !path.exists() {
            true => Err(StoreError::Missing(path).into()),
            false => Ok(server),
        }
    }

    /// Opens an existing database for writing; a mistyped name makes no new file.
    pub fn open(&self) -> Result<Store, Failure> {
        self.server_or_there()?;
        self.open_or_make()
    }

    /// Refuses a named file that does not exist, as its name may be mistyped; the user's own file may still be made.
    pub fn check_named(&self) -> Result<(), Failure> {
        match self.named() {
            Some(_) => self.server_or_there().map(drop),
            None => self.path().map(drop),
        }
    }

    /// Opens the database for writing, and makes the file if it is not there: for commands that add runs.
    pub fn open_or_make(&self) -> Result<Store, Failure> {
        match self.server()? {
            None => self.open_file(),
            Some(address) => Ok(Store::connect(&address, clock::ids())?),
        }
    }

    /// Opens the database file for writing, and makes it and the user's own data directory if they are not there.
    pub fn open_file(&self) -> Result<Store, Failure> {
        let path = self.file()?;
        if self.named().is_none() {
            owner_only::folder_of(&path)?;
        }
        if let Some(told) = owner_only::told_if_shared(&path) {
            stdio::note(&Words::shown().told(&told));
        }
        Ok(Store::open(&path, clock::open_options())?)
    }

    /// Opens the database for reading; a note names what was added to a file by hand.
    pub fn open_read_only(&self) -> Result<Store, Failure> {
        if let Some(address) = self.server()? {
            return Ok(Store::connect_read_only(&address)?);
        }
        let path = self.path()?;
        let store = Store::open_read_only(&path)?;
        for stranger in store.foreign_objects()? {
            stdio::note(&format!(
                "{} was altered by hand, and what it says may be: {stranger}; `ptu db check` says more",
                path.display()
            ));
        }
        Ok(store)
    }
}
