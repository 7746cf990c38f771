//! Reads and writes whole files, and says which one could not be read or written.

use std::fmt::Display;
use std::io::Write as _;
use std::path::Path;

use fault_db::read_regular_file;

use crate::failure::{Failure, FileTrouble, Why};
use crate::new_file::{Kind, NewFile, cannot_write, head, kind};
use crate::platform;

/// Longest script, data file or other text that is read, bytes.
pub const LONGEST_FILE: u64 = 4 << 20;
/// Letters at its beginning by which the kind of a text is known.
const TEXT_HEAD: usize = 5;

/// Reads a file, or says which one could not be read.
///
/// # Errors
/// The file cannot be read, is longer than scripts and data files are, or is not UTF-8.
pub fn read(file: &Path) -> Result<String, Failure> {
    read_within(file, LONGEST_FILE)
}

/// Reads a file of up to `most` bytes as [`read`] does.
///
/// # Errors
/// As [`read`].
pub fn read_within(file: &Path, most: u64) -> Result<String, Failure> {
    let bytes = read_regular_file(file, most).map_err(|error| cannot_read(file, Why::of(error)))?;
    String::from_utf8(bytes).map_err(|_| cannot_read(file, Why::NoText))
}

pub(crate) fn cannot_read(file: &Path, why: Why) -> Failure {
    Failure::usage(FileTrouble::Unread(file.display().to_string(), why))
}

/// Finds out whether a file of a kind can be written, leaving an existing file as it is.
///
/// # Errors
/// The file cannot be written; the error says why.
pub fn check_writable(file: &Path, kind: Kind<'_>) -> Result<(), Failure> {
    NewFile::begin(file, kind).map(drop)
}

/// Writes a file of a kind whole: until it is, what stood there stays. Says which one could not be written.
///
/// # Errors
/// The file cannot be written.
pub fn write(file: &Path, kind: Kind<'_>, content: impl AsRef<[u8]>) -> Result<(), Failure> {
    let mut new = NewFile::begin(file, kind)?;
    new.write_all(content.as_ref())
        .map_err(|error| cannot_write(file, &error))?;
    new.finish()
}

/// Writes a text whole, never over a file that begins otherwise; the folder is made if need be.
///
/// # Errors
/// The file or its folder cannot be written.
pub fn write_text(file: &Path, text: impl AsRef<[u8]>) -> Result<(), Failure> {
    if let Some(folder) = file.parent() {
        std::fs::create_dir_all(folder).map_err(|error| cannot_write(file, &error))?;
    }
    let begins: String = head(text.as_ref()).chars().take(TEXT_HEAD).collect();
    write(file, &[&begins], text)
}

/// Keeps a value as JSON in a file whose folder is made if need be: whole, or as it was.
///
/// # Errors
/// The file or its folder cannot be written.
pub fn keep(file: &Path, value: &impl serde::Serialize) -> Result<(), Failure> {
    let failed = |error: &dyn Display| cannot_write(file, error);
    if let Some(folder) = file.parent() {
        platform::make_folder(folder).map_err(|error| failed(&error))?;
    }
    let content = serde_json::to_vec_pretty(value).map_err(|error| failed(&error))?;
    let mut new = NewFile::begin(file, kind::OWN)?;
    new.keep_to_owner()?;
    new.write_all(&content).map_err(|error| failed(&error))?;
    new.finish()
}
