//! A file that stands in its place only when it is whole.

use std::fs::{File, OpenOptions};
use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::failure::Failure;

/// A file being written beside its place. Dropped before [`NewFile::finish`] it leaves nothing behind.
pub struct NewFile {
    file: BufWriter<File>,
    beside: PathBuf,
    place: PathBuf,
    is_whole: bool,
}

impl NewFile {
    /// Begins a file that is to stand at `place`.
    ///
    /// # Errors
    /// There is a file already and `force` was not said, or none can be made in that folder.
    pub fn begin(place: &Path, force: bool) -> Result<Self, Failure> {
        let cannot =
            |why: String| Failure::usage(format!("cannot write {}: {why}", place.display()));
        if place.is_dir() {
            return Err(cannot("it is a folder".into()));
        }
        if !force && place.exists() {
            return Err(Failure::usage(format!(
                "{} is there already; name another file, or say --force to replace it",
                place.display()
            )));
        }
        let name = place
            .file_name()
            .ok_or_else(|| cannot("it has no file name".into()))?;
        let mut hidden = std::ffi::OsString::from(".");
        hidden.push(name);
        hidden.push(format!(".{}.part", std::process::id()));
        let beside = place.with_file_name(hidden);
        let opened = OpenOptions::new()
            .write(true)
            .create(true)
            .truncate(true)
            .open(&beside);
        let file = opened.map_err(|error| cannot(error.to_string()))?;
        Ok(Self {
            file: BufWriter::new(file),
            beside,
            place: place.to_path_buf(),
            is_whole: false,
        })
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    /// The disk is full or gone.
    pub fn finish(mut self) -> Result<(), Failure> {
        let done = self
            .file
            .flush()
            .and_then(|()| self.file.get_ref().sync_all())
            .and_then(|()| std::fs::rename(&self.beside, &self.place));
        done.map_err(|error| cannot_write(&self.place, &error))?;
        self.is_whole = true;
        Ok(())
    }
}

impl Drop for NewFile {
    fn drop(&mut self) {
        if !self.is_whole {
            // Nothing can be done about a file that cannot be removed either.
            let _ = std::fs::remove_file(&self.beside);
        }
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

/// The failure of a file that broke off.
pub fn cannot_write(place: &Path, error: &dyn std::fmt::Display) -> Failure {
    Failure::bench(format!("cannot write {}: {error}", place.display()))
}
