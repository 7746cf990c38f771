//! `--db`: selects the history, a file or a server.

use std::path::{Path, PathBuf};

use clap::Args;
use fault_db::{Address, Store, StoreError};

use ptu_report::words::Words;
use ptu_runs::clock;
use ptu_runs::failure::{Asked, Failure, FileTrouble};
use ptu_runs::{owner_only, stdio};

/// Variable with the history of commands that are given none.
const VARIABLE: &str = "PTU_DB";
/// Place among the options: after all but `--help`.
const LAST: usize = 998;

/// Which history.
#[derive(Debug, Args)]
pub struct Database {
    /// Database file, or postgres://USER@HOST/DATABASE [default: history.db in the user's data directory]
    /// [env: PTU_DB]
    // Read by us: clap would show a variable that is set as an option that has to be given.
    #[arg(long, value_name = "FILE", global = true, display_order = LAST)]
    db: Option<PathBuf>,
}

/// The server that was named where a file could have been, if it was one.
fn as_address(path: &Path) -> Option<Result<Address, StoreError>> {
    let text = path.to_string_lossy();
    Address::is_meant(&text).then(|| text.parse())
}

/// A file that is named beside `--db`; not a server, whose address would be taken for a file's name.
pub fn only_file(path: &Path) -> Result<&Path, Failure> {
    match as_address(path) {
        None => Ok(path),
        Some(address) => Err(StoreError::NotAFile(address?.to_string().into()).into()),
    }
}

impl Database {
    /// What the user named, or the user's own file.
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

    /// What the user named, if anything.
    fn named(&self) -> Option<PathBuf> {
        let variable = || std::env::var_os(VARIABLE).map(PathBuf::from);
        self.db.clone().or_else(variable)
    }

    /// Path of a database in a file; for what a server does not do.
    pub fn file(&self) -> Result<PathBuf, Failure> {
        let path = self.path()?;
        only_file(&path)?;
        Ok(path)
    }

    /// The server, if it is one; for what tells a server from a file by itself.
    pub fn server(&self) -> Result<Option<Address>, Failure> {
        Ok(as_address(&self.path()?).transpose()?)
    }

    /// The server, if it is one; a file has to be there.
    fn server_or_there(&self) -> Result<Option<Address>, Failure> {
        let (server, path) = (self.server()?, self.path()?);
        match server.is_none() && !path.exists() {
            true => Err(StoreError::Missing(path).into()),
            false => Ok(server),
        }
    }

    /// Opens one that is there for writing: a name that is mistyped makes none.
    pub fn open(&self) -> Result<Store, Failure> {
        self.server_or_there()?;
        self.open_or_make()
    }

    /// A file that was named has to be there, as the name may be mistyped; the user's own may be made.
    pub fn check_named(&self) -> Result<(), Failure> {
        match self.named() {
            Some(_) => self.server_or_there().map(drop),
            None => self.path().map(drop),
        }
    }

    /// Opens it for writing, and makes a file if need be: for what brings runs in.
    pub fn open_or_make(&self) -> Result<Store, Failure> {
        match self.server()? {
            None => self.open_file(),
            Some(address) => Ok(Store::connect(&address, clock::ids())?),
        }
    }

    /// Opens a database in a file for runs, and makes the user's own data directory if need be.
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

    /// Opens it for reading.
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
