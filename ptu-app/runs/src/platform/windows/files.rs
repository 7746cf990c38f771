//! Access rights and identity of files. Windows closes a user's folders, and what is made in them, to other users.

use std::fs::{DirBuilder, File, Metadata};
use std::io::Result;
use std::os::windows::io::AsHandle;
use std::path::{Component, Path, PathBuf, Prefix};
use std::time::SystemTime;

/// Makes a folder and those above it, as far as they are missing.
pub fn make_folder(path: &Path) -> Result<()> {
    DirBuilder::new().recursive(true).create(path)
}

/// Leaves a file as its folder makes it.
#[expect(clippy::unnecessary_wraps, reason = "it can fail elsewhere")]
pub fn keep_to_owner(_: &File) -> Result<()> {
    Ok(())
}

/// Says nothing: the rights of files are lists here, and are inherited.
pub fn readable_by_others(_: &Path) -> Option<(String, String)> {
    None
}

/// Tells a file from another one put in its place, by the time it was made.
pub fn identity(file: &Metadata) -> u64 {
    let made = file.created().ok();
    let since = made.and_then(|made| made.duration_since(SystemTime::UNIX_EPOCH).ok());
    since.map_or(0, |since| since.as_micros() as u64)
}

/// The file that a stream of the process reads or writes.
pub fn same_file(stream: &impl AsHandle) -> Result<File> {
    stream.as_handle().try_clone_to_owned().map(File::from)
}

/// Where a path leads, links followed; as people write it (`C:\…`), where the system tells it as `\\?\C:\…`.
pub fn real_path(path: &Path) -> Result<PathBuf> {
    let real = std::fs::canonicalize(path)?;
    let mut parts = real.components();
    Ok(match parts.next() {
        Some(Component::Prefix(prefix)) => match prefix.kind() {
            Prefix::VerbatimDisk(letter) => {
                let disk = format!("{}:", char::from(letter));
                Path::new(&disk).join(parts.as_path())
            }
            _ => real,
        },
        _ => real,
    })
}
