//! A file that appears under its name only when it is complete: it is written beside its target under a
//! temporary name and then renamed, so a crash leaves either the old file or the new one.

use std::fs::File;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use rusqlite::{Connection, OpenFlags};
use tempfile::{Builder, NamedTempFile};

use crate::error::StoreError;
use crate::files::databases::is_of_database;
use crate::files::held_file::{make_locked, remove_abandoned};
use crate::files::platform;
use crate::schema;

/// Stands in the temporary name between the file's name and the random letters; only this program uses it.
const MARK: &str = ".ptu-";
/// Number of random letters in the temporary name.
const RANDOM: usize = 16;

/// An unfinished file. It is removed if dropped before [`replace`](Self::replace) or [`publish_as`](Self::publish_as).
#[derive(Debug)]
pub struct AtomicFile {
    beside: NamedTempFile,
    to: PathBuf,
}

impl AtomicFile {
    /// Begins a file that is to be called `to`, in the folder of `to`. Removes unfinished files that killed programs
    /// left there.
    ///
    /// # Errors
    /// The file system allows no file in that folder.
    pub fn begin(to: &Path) -> std::io::Result<Self> {
        Self::make(to, false)
    }

    /// The file to write to.
    pub fn file(&self) -> &File {
        self.beside.as_file()
    }

    /// Gives the file its name, replacing an existing file; readers see either the old or the new
    /// one, complete. What was written must be on the disk already ([`std::fs::File::sync_all`]).
    ///
    /// # Errors
    /// The file system refuses; the old file is still there.
    pub fn replace(self) -> std::io::Result<()> {
        self.beside
            .persist(&self.to)
            .map_err(|failed| failed.error)?;
        sync_names(&self.to);
        Ok(())
    }

    /// Gives the file a name that must be free. What was written must be on the disk already.
    ///
    /// # Errors
    /// [`ErrorKind::AlreadyExists`], or an error of the file system; the file is returned, so that another name can be
    /// tried.
    pub fn publish_as(self, name: &Path) -> Result<(), (std::io::Error, Self)> {
        let Self { beside, to } = self;
        match beside.persist_noclobber(name) {
            Ok(_) => {
                sync_names(name);
                Ok(())
            }
            Err(failed) => Err((
                failed.error,
                Self {
                    beside: failed.file,
                    to,
                },
            )),
        }
    }

    /// Copies a whole database, compacted, into an unfinished file beside `to`.
    pub(crate) fn copy(
        conn: &Connection,
        to: &Path,
        doing: &'static str,
    ) -> Result<Self, StoreError> {
        let part = Self::make(to, true).map_err(|error| cannot_write(to, error.to_string()))?;
        let name = part.beside.path().to_str();
        let name = name.ok_or_else(|| StoreError::CannotOpen {
            path: to.to_path_buf(),
            reason: "the name is not UTF-8".to_owned(),
        })?;
        if platform::LOCKS_BIND_ALL {
            let _ = part.file().unlock();
        }
        // An error here concerns the target: the source was readable a moment ago.
        conn.execute("VACUUM INTO ?1", [name])
            .map_err(|error| StoreError::from_sqlite(to, doing, error))?;
        Ok(part)
    }

    /// Checks that a file to be created is not there yet, and that its folder exists and is writable.
    ///
    /// # Errors
    /// [`StoreError::TargetExists`], or [`StoreError::CannotWrite`] with the system's reason, which SQLite does not give.
    pub(crate) fn can_be_made(to: &Path) -> Result<(), StoreError> {
        let is_of_database = is_of_database(to);
        // Tested after `is_of_database`: a file that another program makes meanwhile exists, whatever it belongs to.
        if to.exists() {
            let path = to.to_path_buf();
            return Err(StoreError::TargetExists(path));
        }
        if is_of_database {
            return Err(cannot_write(to, "it belongs to a database".to_owned()));
        }
        let folder = to
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty() && !folder.is_dir());
        if let Some(folder) = folder {
            let reason = format!("there is no folder {}", folder.display());
            return Err(cannot_write(to, reason));
        }
        // Tried under a temporary name: another program may take the final name the next moment.
        let made = Self::make(to, true).map(drop);
        made.map_err(|error| cannot_write(to, error.to_string()))
    }

    /// Removes the unfinished files that killed programs left in the folder of `to`.
    pub(crate) fn remove_left(to: &Path) {
        remove_abandoned(folder_of(to), is_part);
    }

    fn make(to: &Path, is_private: bool) -> std::io::Result<Self> {
        Self::remove_left(to);
        let mut name = to.file_name().unwrap_or_default().to_owned();
        name.push(MARK);
        // An absolute path, because SQLite does not take `file:x` for the name of a file.
        let folder = std::path::absolute(folder_of(to))?;
        let beside = Builder::new()
            .prefix(&name)
            .suffix(".part")
            .rand_bytes(RANDOM)
            .make_in(folder, |path| make_locked(path, is_private))?;
        Ok(Self {
            beside,
            to: to.to_path_buf(),
        })
    }

    /// The schema version of what was copied.
    pub(crate) fn version(&self) -> Result<i32, StoreError> {
        let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        Connection::open_with_flags(self.beside.path(), flags)
            .and_then(|copy| schema::user_version(&copy))
            .map_err(|error| StoreError::from_sqlite(&self.to, "reading a copy", error))
    }

    /// Gives the copy its name, which must still be free.
    ///
    /// # Errors
    /// The name is taken, or the file system refuses.
    pub(crate) fn publish(self) -> Result<(), StoreError> {
        let path = self.to.clone();
        let published = self.publish_as(&path);
        published.map_err(|(error, _)| match error.kind() {
            ErrorKind::AlreadyExists => StoreError::TargetExists(path),
            _ => StoreError::Io {
                path,
                reason: error.to_string(),
            },
        })
    }
}

fn cannot_write(path: &Path, reason: String) -> StoreError {
    StoreError::CannotWrite {
        path: path.to_path_buf(),
        reason,
    }
}

/// Creates an empty file that only its owner can read. SQLite would use the umask; the files that it creates
/// beside a database get that database's rights.
///
/// # Errors
/// The file exists, or cannot be created.
pub(crate) fn make_private(path: &Path) -> std::io::Result<()> {
    let mut options = std::fs::OpenOptions::new();
    options.write(true).create_new(true);
    platform::for_owner(&mut options);
    options.open(path).map(drop)
}

/// Makes a new name of a file survive a power cut, too; not every file system can sync a folder.
fn sync_names(file: &Path) {
    if let Ok(folder) = std::fs::File::open(folder_of(file)) {
        let _ = folder.sync_all();
    }
}

fn folder_of(file: &Path) -> &Path {
    let folder = file.parent().filter(|folder| *folder != Path::new(""));
    folder.unwrap_or(Path::new("."))
}

/// Whether [`AtomicFile::make`] gives such a name.
fn is_part(name: &str) -> bool {
    let name = name.strip_suffix(".part");
    let random = name.and_then(|name| name.rsplit_once(MARK));
    random.is_some_and(|(_, letters)| letters.len() == RANDOM)
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use super::*;

    /// Goal: unfinished files of dead programs are removed, and none that is still being written.
    #[test]
    fn a_file_that_nobody_writes_any_more_is_removed() {
        let dir = tempfile::tempdir().expect("a directory");
        let name = |name: &str| dir.path().join(name);
        let left = [
            "a.pdf.ptu-0123456789abcdEF.part",
            "b.db.ptu-0123456789abcdEF.part",
        ]
        .map(name);
        let journal = name("b.db.ptu-0123456789abcdEF.part-journal");
        let mine = name("presentation2024.part");
        for file in left.iter().chain([&journal, &mine]) {
            std::fs::write(file, "half").expect("written");
        }
        let under_way = AtomicFile::begin(&name("c.pdf")).expect("begun");
        drop(AtomicFile::begin(&name("d.pdf")).expect("begun"));
        assert!(under_way.beside.path().exists() && mine.exists());
        assert!(left.iter().chain([&journal]).all(|file| !file.exists()));
    }

    /// Goal: the target is replaced only by a complete file; an abandoned one leaves it unchanged.
    #[test]
    fn a_file_is_replaced_whole_or_not_at_all() {
        let dir = tempfile::tempdir().expect("a directory");
        let to = dir.path().join("report.json");
        let names = || std::fs::read_dir(dir.path()).expect("read").count();
        let read = || std::fs::read_to_string(&to).expect("there");
        std::fs::write(&to, "old").expect("written");
        let given_up = AtomicFile::begin(&to).expect("begun");
        given_up.file().write_all(b"ne").expect("written");
        drop(given_up);
        assert_eq!((read(), names()), ("old".to_owned(), 1));
        let whole = AtomicFile::begin(&to).expect("begun");
        whole.file().write_all(b"new").expect("written");
        assert_eq!(read(), "old");
        whole.replace().expect("replaced");
        assert_eq!((read(), names()), ("new".to_owned(), 1));
    }
}
