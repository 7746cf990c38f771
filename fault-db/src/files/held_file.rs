//! Files that exist only while the program that made them runs. A lock shows whether it does, also from another container
//! or computer, where the number of a process means nothing.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Result};
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::files::databases::with_end;
use crate::files::platform;

/// Where a disk has no locks, a file that was not written to for this long is abandoned.
const GIVEN_UP: Duration = Duration::from_secs(3_600);

/// A file that this program made. Dropping the value removes it, and the files that SQLite keeps beside it.
#[derive(Debug)]
pub(crate) struct HeldFile {
    pub(crate) file: File,
    pub(crate) path: PathBuf,
}

impl HeldFile {
    /// Makes and locks the file.
    ///
    /// # Errors
    /// The file exists, or cannot be made.
    pub(crate) fn make(path: &Path) -> Result<Self> {
        Ok(Self {
            file: make_locked(path, false)?,
            path: path.to_path_buf(),
        })
    }
}

/// Makes a file and locks it; if `is_private`, only its owner may read it, which SQLite and the umask would not ensure.
///
/// # Errors
/// The file exists, or cannot be made.
pub(crate) fn make_locked(path: &Path, is_private: bool) -> Result<File> {
    let mut options = OpenOptions::new();
    options.read(true).write(true).create_new(true);
    if is_private {
        platform::for_owner(&mut options);
    }
    loop {
        let file = options.open(path)?;
        let _ = file.lock();
        // Another program may have removed the file as abandoned before it was locked.
        if path.exists() {
            return Ok(file);
        }
    }
}

impl Drop for HeldFile {
    fn drop(&mut self) {
        remove(&self.path);
    }
}

/// Whether the program that made a file, which all may read, still holds the file; true where that is not known.
pub(crate) fn is_held(path: &Path) -> bool {
    match File::open(path) {
        Ok(file) => file.try_lock_shared().is_err(),
        // Such files are made readable for all; one that is not readable was left by an earlier version.
        Err(error) => !matches!(
            error.kind(),
            ErrorKind::NotFound | ErrorKind::PermissionDenied
        ),
    }
}

/// Removes the abandoned files of a folder, of those whose names `is_one` accepts.
pub(crate) fn remove_abandoned(folder: &Path, is_one: impl Fn(&str) -> bool) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if !entry.file_name().to_str().is_some_and(&is_one) {
            continue;
        }
        let Ok(file) = File::open(&path) else {
            continue;
        };
        let is_old = || file.metadata().ok()?.modified().ok()?.elapsed().ok();
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {}
            Err(TryLockError::Error(_)) if is_old().is_none_or(|age| age < GIVEN_UP) => {}
            // The folder may allow files to be made, but not this one to be removed: then it stays.
            _ => remove(&path),
        }
    }
}

fn remove(path: &Path) {
    for end in ["", "-journal", "-wal", "-shm"] {
        let _ = std::fs::remove_file(with_end(path, end));
    }
}
