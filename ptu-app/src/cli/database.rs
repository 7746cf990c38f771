//! `--db`: which history, in a file or on a server.

use std::path::PathBuf;

use clap::Args;
use fault_db::{Address, Store, StoreError};

use crate::clock;
use crate::failure::Failure;

/// Which history.
#[derive(Debug, Args)]
pub struct Database {
    /// Database file, or postgres://USER@HOST/DATABASE [default: history.db in the user's data directory]
    // Hidden in help because an address may hold a password.
    #[arg(
        long,
        value_name = "FILE",
        env = "PTU_DB",
        hide_env_values = true,
        global = true
    )]
    db: Option<PathBuf>,
}

/// Where it is.
enum Place {
    File(PathBuf),
    Server(Address),
}

impl Database {
    fn place(&self) -> Result<Place, Failure> {
        let Some(path) = &self.db else {
            let file = directories::ProjectDirs::from("", "", "ptu")
                .map(|directories| directories.data_dir().join("history.db"));
            return file.map(Place::File).ok_or_else(|| {
                Failure::usage("no user data directory; name a database with --db")
            });
        };
        Ok(match path.to_str().filter(|text| Address::is_meant(text)) {
            Some(text) => Place::Server(text.parse()?),
            None => Place::File(path.clone()),
        })
    }

    /// Its path, of a file; for what a server does not do.
    pub(in crate::cli) fn file(&self) -> Result<PathBuf, Failure> {
        match self.place()? {
            Place::File(path) => Ok(path),
            Place::Server(address) => Err(StoreError::NotAFile {
                path: address.to_string().into(),
            }
            .into()),
        }
    }

    /// Opens it for writing; the user's own data directory is made if need be.
    pub(in crate::cli) fn open(&self) -> Result<Store, Failure> {
        match self.place()? {
            Place::File(_) => self.open_file(),
            Place::Server(address) => Ok(Store::connect(&address, clock::ids())?),
        }
    }

    /// The same, of a file: for runs.
    pub(in crate::cli) fn open_file(&self) -> Result<Store, Failure> {
        let path = self.file()?;
        if let Some(folder) = path.parent().filter(|_| self.db.is_none()) {
            std::fs::create_dir_all(folder).map_err(|error| {
                Failure::bench(format!("cannot make {}: {error}", folder.display()))
            })?;
        }
        Ok(Store::open(&path, clock::open_options())?)
    }

    /// Opens it for reading.
    pub(in crate::cli) fn open_read_only(&self) -> Result<Store, Failure> {
        Ok(match self.place()? {
            Place::File(path) => Store::open_read_only(&path)?,
            Place::Server(address) => Store::connect_read_only(&address)?,
        })
    }
}
