//! Whether the file of a store is still the one that was opened, under its name alone.

use super::Store;
use crate::error::StoreError;
use crate::files::platform::Identity;
use crate::id::Id;
use crate::store::atomic_file::AtomicFile;

impl Store {
    /// Holds the file to be the one that has this store's name still, and to have no other name.
    ///
    /// # Errors
    /// [`StoreError::Misplaced`], and what has happened to the file.
    pub fn check_place(&self) -> Result<(), StoreError> {
        let Some(opened) = self.identity else {
            return Ok(());
        };
        let what = match Identity::at(&self.path) {
            None => "was removed",
            Some(now) if !opened.is_same(&now) => "was replaced by another file",
            Some(now) if now.names > 1 && self.has_second_name() => {
                "has a second name (a hard link)"
            }
            Some(_) => return Ok(()),
        };
        Err(StoreError::Misplaced {
            path: self.path.clone(),
            what,
        })
    }

    /// Whether another name is left once the names that killed programs left are removed.
    fn has_second_name(&self) -> bool {
        AtomicFile::remove_left(&self.path);
        Identity::at(&self.path).is_some_and(|now| now.names > 1)
    }

    /// Holds a run that has ended to be in the file that has this store's name, as another program finds it.
    ///
    /// # Errors
    /// The run is not there, and why.
    pub fn check_holds(&self, run: Id) -> Result<(), StoreError> {
        self.check_place()?;
        // What waits in a log that was removed is in the file then.
        self.checkpoint()?;
        let found = Self::open_read_only(&self.path)?.run(run)?;
        match found.run.verdict {
            Some(_) => self.check_place(),
            None => Err(StoreError::not_found("end of run", run)),
        }
    }
}
