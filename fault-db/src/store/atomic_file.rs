//! A file that appears under its name only when it is complete: it is written beside its target under a
//! temporary name and then renamed, so a crash leaves either the old file or the new one.

use std::hash::{BuildHasher as _, DefaultHasher, Hash as _, Hasher as _, RandomState};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::Duration;

use rusqlite::{Connection, OpenFlags};

use crate::error::StoreError;
use crate::files::regular_file::make_private;
use crate::schema;

/// An unfinished file that has not been written to for this long is abandoned.
const GIVEN_UP: Duration = Duration::from_secs(3_600);

/// Ends of the names of unfinished files, and of what SQLite keeps beside one while it fills it.
const ENDINGS: [&[u8]; 4] = [b".part", b".part-journal", b".part-wal", b".part-shm"];

/// An unfinished file. Dropped before [`replace`](Self::replace) or [`publish_as`](Self::publish_as), it is
/// removed.
#[derive(Debug)]
pub struct AtomicFile {
    beside: PathBuf,
    to: PathBuf,
}

impl AtomicFile {
    /// Begins a file that is to be called `to`. Only a unique name in the same folder is chosen yet.
    /// Unfinished files that killed programs left in the folder are removed.
    pub fn begin(to: &Path) -> Self {
        for left in left_in(folder_of(to)) {
            // Without the right to remove it there may still be the right to write beside it.
            let _ = std::fs::remove_file(left);
        }
        Self::of(to)
    }

    /// The temporary name to write to.
    pub fn path(&self) -> &Path {
        &self.beside
    }

    /// Renames it to its name, replacing an existing file; readers see either the old or the new one,
    /// complete. What was written must be on the disk already ([`std::fs::File::sync_all`]).
    ///
    /// # Errors
    /// Of the file system; the old file is still there then.
    pub fn replace(self) -> std::io::Result<()> {
        std::fs::rename(&self.beside, &self.to)?;
        sync_names(&self.to);
        Ok(())
    }

    /// Gives it a name that must be free. What was written must be on the disk already.
    ///
    /// # Errors
    /// [`ErrorKind::AlreadyExists`], or of the file system; another name can be tried then.
    pub fn publish_as(&self, name: &Path) -> std::io::Result<()> {
        match std::fs::hard_link(&self.beside, name) {
            // No hard links on this file system.
            Err(error)
                if !matches!(error.kind(), ErrorKind::AlreadyExists | ErrorKind::NotFound) =>
            {
                self.rename(name)?;
            }
            done => done?,
        }
        sync_names(name);
        Ok(())
    }

    /// Copies a whole file, compacted, beside `to`.
    pub(crate) fn copy(
        conn: &Connection,
        to: &Path,
        doing: &'static str,
    ) -> Result<Self, StoreError> {
        let part = Self::begin(to);
        let name = part.beside.to_str().ok_or_else(|| StoreError::CannotOpen {
            path: to.to_path_buf(),
            reason: "the name is not UTF-8".to_owned(),
        })?;
        // SQLite fills an empty file; if none can be made, its own error says why.
        let _ = make_private(&part.beside);
        // An error here concerns the target: the source was readable a moment ago.
        conn.execute("VACUUM INTO ?1", [name])
            .map_err(|error| StoreError::from_sqlite(to, doing, error))?;
        Ok(part)
    }

    /// Checks that the folder of a file to be created exists and is writable.
    ///
    /// # Errors
    /// [`StoreError::CannotWrite`] with the system's reason, which SQLite does not give.
    pub(crate) fn can_be_made(to: &Path) -> Result<(), StoreError> {
        let cannot = |reason| StoreError::CannotWrite {
            path: to.to_path_buf(),
            reason,
        };
        let folder = to
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty() && !folder.is_dir());
        if let Some(folder) = folder {
            return Err(cannot(format!("there is no folder {}", folder.display())));
        }
        // Not under its own name, which another program may take the next moment.
        let part = Self::of(to);
        make_private(&part.beside).map_err(|error| cannot(error.to_string()))
    }

    fn of(to: &Path) -> Self {
        let mut name = to.as_os_str().to_owned();
        let random = RandomState::new().hash_one(to) as u32;
        let process = std::process::id();
        name.push(format!(".{process}-{:08x}{random:08x}.part", processes()));
        Self {
            beside: name.into(),
            to: to.to_path_buf(),
        }
    }

    /// The schema version of what was copied.
    pub(crate) fn version(&self) -> Result<i32, StoreError> {
        let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        Connection::open_with_flags(&self.beside, flags)
            .and_then(|copy| schema::user_version(&copy))
            .map_err(|error| StoreError::from_sqlite(&self.to, "reading a copy", error))
    }

    /// Gives the copy its name, which must still be free.
    ///
    /// # Errors
    /// The name is taken; or of the file system.
    pub(crate) fn publish(self) -> Result<(), StoreError> {
        let published = self.publish_as(&self.to);
        published.map_err(|error| match error.kind() {
            ErrorKind::AlreadyExists => StoreError::TargetExists {
                path: self.to.clone(),
            },
            _ => StoreError::Io {
                path: self.to.clone(),
                reason: error.to_string(),
            },
        })
    }

    /// [`publish_as`](Self::publish_as) on a file system without hard links, such as a memory stick's: an
    /// empty file reserves the name first.
    fn rename(&self, name: &Path) -> std::io::Result<()> {
        make_private(name)?;
        let renamed = std::fs::rename(&self.beside, name);
        if renamed.is_err() {
            let _ = std::fs::remove_file(name);
        }
        renamed
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        // After publishing the first is the second link, if it exists; the others are there where SQLite failed.
        for end in ["", "-journal", "-wal", "-shm"] {
            let mut name = self.beside.as_os_str().to_owned();
            name.push(end);
            let _ = std::fs::remove_file(name);
        }
    }
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

/// Abandoned unfinished files of a folder.
fn left_in(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let left = entries.filter(|entry| {
        let maker = maker(entry.file_name().as_encoded_bytes());
        maker.is_some_and(|maker| is_gone(maker) || is_given_up(entry))
    });
    left.map(|entry| entry.path()).collect()
}

/// The process that writes an unfinished file, from the end of its name: the process namespace, and its
/// number.
fn maker(name: &[u8]) -> Option<(u32, u32)> {
    let name = ENDINGS.iter().find_map(|end| name.strip_suffix(*end))?;
    let end = name.iter().rposition(|byte| *byte == b'.')?;
    let (process, name) = std::str::from_utf8(&name[end + 1..])
        .ok()?
        .split_once('-')?;
    let is_ours = name.len() == 16 && name.bytes().all(|digit| digit.is_ascii_hexdigit());
    let among = is_ours.then(|| u32::from_str_radix(&name[..8], 16).ok())?;
    Some((among?, process.parse().ok()?))
}

/// Identifies the set of processes that can be looked up here (this computer, this boot, this container); 0
/// if none can be.
fn processes() -> u32 {
    // Other users' processes are visible, too, unless `/proc` is mounted to hide them.
    if !Path::new("/proc/1").exists() {
        return 0;
    }
    let boot = std::fs::read("/proc/sys/kernel/random/boot_id");
    let space = std::fs::read_link("/proc/self/ns/pid");
    match (boot, space) {
        (Ok(boot), Ok(space)) => {
            let mut hasher = DefaultHasher::new();
            (boot, space).hash(&mut hasher);
            (hasher.finish() as u32).max(1)
        }
        _ => 0,
    }
}

/// Whether the process is dead, as far as it can be looked up here.
fn is_gone((among, process): (u32, u32)) -> bool {
    among != 0 && among == processes() && !Path::new(&format!("/proc/{process}")).exists()
}

fn is_given_up(entry: &std::fs::DirEntry) -> bool {
    let written = entry.metadata().and_then(|file| file.modified());
    let since = written.ok().and_then(|at| at.elapsed().ok());
    since.is_some_and(|since| since > GIVEN_UP)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: a copy whose process is dead is removed; one of another computer may still be being written.
    #[test]
    fn a_copy_is_left_by_a_process_of_this_computer_that_is_gone() {
        let dir = tempfile::tempdir().expect("a directory");
        let name = |of: &str, process: u32, among: u32| {
            let name = format!("{of}.{process}-{among:08x}01234567.part");
            let path = dir.path().join(name);
            std::fs::write(&path, "half").expect("written");
            path
        };
        let here = processes();
        let journal = dir
            .path()
            .join(format!("c.db.{}-{here:08x}01234567.part-journal", u32::MAX));
        std::fs::write(&journal, "half").expect("written");
        let mut dead = [
            name("b.db", u32::MAX, here),
            name("a.pdf", u32::MAX, here),
            journal,
        ];
        name("b.db", std::process::id(), here);
        name("b.db", u32::MAX, here ^ 1);
        std::fs::write(dir.path().join("mine.part"), "whole").expect("written");
        let mut left = left_in(dir.path());
        left.sort();
        dead.sort();
        let expected = if here == 0 { vec![] } else { dead.to_vec() };
        assert_eq!(left, expected);
    }

    /// Goal: the target is replaced only by a complete file; an abandoned one leaves it unchanged.
    #[test]
    fn a_file_is_replaced_whole_or_not_at_all() {
        let dir = tempfile::tempdir().expect("a directory");
        let to = dir.path().join("report.json");
        let names = || std::fs::read_dir(dir.path()).expect("read").count();
        let read = || std::fs::read_to_string(&to).expect("there");
        std::fs::write(&to, "old").expect("written");
        let given_up = AtomicFile::begin(&to);
        std::fs::write(given_up.path(), "ne").expect("written");
        drop(given_up);
        assert_eq!((read(), names()), ("old".to_owned(), 1));
        let whole = AtomicFile::begin(&to);
        std::fs::write(whole.path(), "new").expect("written");
        assert_eq!(read(), "old");
        whole.replace().expect("replaced");
        assert_eq!((read(), names()), ("new".to_owned(), 1));
    }

    /// Goal: without hard links, too, an existing file is not replaced.
    #[test]
    fn without_hard_links_an_existing_file_is_not_replaced() {
        let dir = tempfile::tempdir().expect("a directory");
        let part = |to: &str| {
            let part = AtomicFile {
                beside: dir.path().join(format!("{to}.part")),
                to: dir.path().join(to),
            };
            std::fs::write(&part.beside, "new").expect("written");
            part
        };
        let read = |name: &str| std::fs::read_to_string(dir.path().join(name)).expect("there");
        std::fs::write(dir.path().join("taken"), "old").expect("written");
        let rename = |name: &str| part(name).rename(&dir.path().join(name));
        let refused = rename("taken").expect_err("taken");
        assert_eq!(refused.kind(), ErrorKind::AlreadyExists);
        assert_eq!(read("taken"), "old");
        rename("free").expect("renamed");
        assert_eq!(read("free"), "new");
        let names = std::fs::read_dir(dir.path()).expect("read").count();
        assert_eq!(names, 2, "nothing is left beside them");
    }
}
