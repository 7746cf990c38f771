//! Which runs are under way: the program that records a run holds a lock file beside the database.

use std::path::PathBuf;

use crate::backend::Backend;
use crate::error::StoreError;
use crate::files::databases::with_end;
use crate::files::held_file::{HeldFile, is_held, remove_abandoned};
use crate::files::platform::for_all;
use crate::id::Id;
use crate::store::Store;

impl Store {
    /// Whether a run without an end is under way. A server has no run that is.
    pub(crate) fn is_under_way(&self, run: Id) -> bool {
        matches!(&self.backend, Backend::File(_)) && is_held(&self.lock_of(run))
    }

    /// Tells other programs that a run is under way, until the result is dropped.
    pub(crate) fn hold_run(&self, run: Id) -> Result<HeldFile, StoreError> {
        let locks = self.locks();
        if let (Some(folder), Some(begins)) = (locks.parent(), locks.file_name()) {
            let begins = begins.to_string_lossy();
            remove_abandoned(folder, |name| {
                name.starts_with(&*begins) && name.ends_with(".lock")
            });
        }
        let lock = self.lock_of(run);
        // The lock file is empty; every user of the history must be able to see that it is locked.
        let made = HeldFile::make(&lock).and_then(|held| for_all(&held.file).map(|()| held));
        made.map_err(|error| StoreError::CannotWrite {
            path: lock.clone(),
            reason: error.to_string(),
        })
    }

    /// Path of the lock file that [`Self::hold_run`] makes.
    fn lock_of(&self, run: Id) -> PathBuf {
        with_end(&self.locks(), &format!("{}.lock", run.short()))
    }

    /// Beginning of the paths of all lock files, beside the database.
    fn locks(&self) -> PathBuf {
        let real = std::fs::canonicalize(self.path());
        with_end(real.as_deref().unwrap_or(self.path()), ".run-")
    }
}
