//! Writes a file under a temporary name and renames it when it is complete.

use std::fs::{File, OpenOptions};
use std::io::{BufWriter, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use fault_db::AtomicFile;

use crate::failure::Failure;
use crate::platform;

/// Names tried beside one that is taken.
const BESIDE: u32 = 1000;

/// A file being written beside its place: whatever stands there stays until the new one is whole. Dropped
/// before it is finished it leaves nothing behind.
#[derive(Debug)]
pub struct NewFile {
    file: BufWriter<File>,
    part: AtomicFile,
    place: PathBuf,
}

impl NewFile {
    /// Begins a file that is to stand at `place`.
    ///
    /// # Errors
    /// What stands there cannot be replaced, or no file can be made in that folder.
    pub fn begin(place: &Path) -> Result<Self, Failure> {
        let cannot =
            |why: String| Failure::usage(format!("cannot write {}: {why}", place.display()));
        place
            .file_name()
            .ok_or_else(|| cannot("it has no file name".into()))?;
        let folder = place
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty());
        if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
            return Err(cannot(format!("there is no folder {}", folder.display())));
        }
        let before = match std::fs::metadata(place) {
            Ok(about) if about.is_dir() => return Err(cannot("it is a folder".into())),
            Ok(about) if !about.is_file() => return Err(cannot("it is no regular file".into())),
            Ok(about) => {
                // A file without write permission is not replaced either.
                let opened = OpenOptions::new().append(true).open(place);
                opened.map_err(|error| cannot(error.to_string()))?;
                Some(about.permissions())
            }
            Err(_) => None,
        };
        // What a link leads to is replaced, not the link.
        let place = platform::real_path(place).unwrap_or_else(|_| place.to_path_buf());
        let part = AtomicFile::begin(&place);
        let opened = File::create_new(part.path());
        let file = opened.map_err(|error| cannot(error.to_string()))?;
        if let Some(permissions) = before {
            file.set_permissions(permissions)
                .map_err(|error| cannot(error.to_string()))?;
        }
        Ok(Self {
            file: BufWriter::new(file),
            part,
            place,
        })
    }

    /// The same where nothing may stand yet.
    ///
    /// # Errors
    /// As [`NewFile::begin`]; or something does.
    pub fn begin_new(place: &Path) -> Result<Self, Failure> {
        if place.exists() {
            return Err(Failure::usage(format!(
                "{} is there already; name another file, or say --force to replace it",
                place.display()
            )));
        }
        Self::begin(place)
    }

    /// Makes the file readable and writable by its owner only.
    ///
    /// # Errors
    /// The disk's.
    pub fn keep_to_owner(&self) -> Result<(), Failure> {
        platform::keep_to_owner(self.file.get_ref())
            .map_err(|error| cannot_write(&self.place, &error))
    }

    /// Holds what was written so far to be on the disk: nothing but its name is missing then.
    ///
    /// # Errors
    /// The disk is full or gone.
    pub fn settle(&mut self) -> Result<(), Failure> {
        let done = (self.file.flush()).and_then(|()| self.file.get_ref().sync_all());
        done.map_err(|error| cannot_write(&self.place, &error))
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    /// The disk is full or gone.
    pub fn finish(mut self) -> Result<(), Failure> {
        self.settle()?;
        let Self { part, place, .. } = self;
        part.replace().map_err(|error| cannot_write(&place, &error))
    }

    /// Puts the file in its place, or under a name beside it that is free (`sheet.pdf`, `sheet-2.pdf` …):
    /// nothing is replaced. Tells which it was.
    ///
    /// # Errors
    /// The disk is full or gone, or all names are taken.
    pub fn finish_beside(mut self) -> Result<PathBuf, Failure> {
        self.settle()?;
        let beside = (2..BESIDE).map(|number| numbered(&self.place, number));
        for name in std::iter::once(self.place.clone()).chain(beside) {
            match self.part.publish_as(&name) {
                Ok(()) => return Ok(name),
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(cannot_write(&name, &error)),
            }
        }
        Err(cannot_write(&self.place, &"it is there already"))
    }
}

impl Write for NewFile {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.file.flush()
    }
}

impl Seek for NewFile {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        self.file.seek(to)
    }
}

/// A name that is free: this one, or with a number as [`NewFile::finish_beside`] has it, for what is written as it comes.
pub fn free_beside(place: &Path) -> PathBuf {
    let beside = (2..BESIDE).map(|number| numbered(place, number));
    let mut names = std::iter::once(place.to_path_buf()).chain(beside);
    let free = names.find(|name| !name.exists());
    free.unwrap_or_else(|| place.to_path_buf())
}

/// The failure of a file that broke off.
pub fn cannot_write(place: &Path, error: &dyn std::fmt::Display) -> Failure {
    Failure::bench(format!("cannot write {}: {error}", place.display()))
}

/// The name with a number before its ending.
fn numbered(path: &Path, number: u32) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_os_string();
    name.push(format!("-{number}"));
    if let Some(ending) = path.extension() {
        name.push(".");
        name.push(ending);
    }
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(place: &Path, text: &str) -> NewFile {
        let mut file = NewFile::begin(place).expect("begun");
        file.write_all(text.as_bytes()).expect("written");
        file
    }

    #[test]
    fn the_old_file_stays_until_the_new_one_is_complete() {
        let folder = tempfile::tempdir().expect("folder");
        let names = || std::fs::read_dir(folder.path()).expect("read").count();
        let (place, link) = (folder.path().join("a.json"), folder.path().join("b.json"));
        std::fs::write(&place, "old").expect("written");
        std::os::unix::fs::symlink(&place, &link).expect("linked");
        let mut mode = std::fs::metadata(&place).expect("there").permissions();
        std::os::unix::fs::PermissionsExt::set_mode(&mut mode, 0o640);
        std::fs::set_permissions(&place, mode).expect("set");
        let read = || std::fs::read_to_string(&place).expect("there");
        let mut given_up = written(&link, "half");
        given_up.settle().expect("on the disk");
        assert_eq!(read(), "old");
        drop(given_up);
        assert_eq!((read(), names()), ("old".to_owned(), 2));
        written(&link, "new").finish().expect("finished");
        assert_eq!((read(), names()), ("new".to_owned(), 2));
        assert!(link.is_symlink(), "a link is not replaced");
        let after = std::fs::metadata(&place).expect("there").permissions();
        let after = std::os::unix::fs::PermissionsExt::mode(&after) & 0o777;
        assert_eq!(after, 0o640, "who may read it is as before");
    }

    #[test]
    fn a_file_that_cannot_be_replaced_is_reported_before_writing() {
        let folder = tempfile::tempdir().expect("folder");
        let told = |place: &Path| NewFile::begin(place).expect_err("refused").message;
        assert!(told(folder.path()).ends_with("it is a folder"));
        assert!(told(&folder.path().join("no/where.csv")).contains("there is no folder"));
        assert!(told(Path::new("/dev/full")).ends_with("it is no regular file"));
        let place = folder.path().join("a.csv");
        written(&place, "1").finish().expect("finished");
        let failure = NewFile::begin_new(&place).expect_err("there already");
        assert!(failure.message.contains("--force"), "{}", failure.message);
    }

    #[test]
    fn an_existing_file_is_not_overwritten_if_another_name_is_free() {
        let folder = tempfile::tempdir().expect("folder");
        let wanted = folder.path().join("trace.v2.csv");
        let names: Vec<_> = (0..3)
            .map(|_| written(&wanted, "1").finish_beside().expect("made"))
            .map(|path| path.file_name().expect("named").to_owned())
            .collect();
        assert_eq!(names, ["trace.v2.csv", "trace.v2-2.csv", "trace.v2-3.csv"]);
        assert_eq!(std::fs::read_dir(folder.path()).expect("read").count(), 3);
    }
}
