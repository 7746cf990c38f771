//! Access rights and identity of files.

use std::fs::{DirBuilder, File, Metadata, Permissions};
use std::io::Result;
use std::os::fd::AsFd;
use std::os::unix::fs::{DirBuilderExt as _, MetadataExt as _, PermissionsExt as _};
use std::path::{Path, PathBuf};

/// Makes a folder and those above it, as far as they are missing, for their owner alone.
pub fn make_folder(path: &Path) -> Result<()> {
    DirBuilder::new().recursive(true).mode(0o700).create(path)
}

/// Lets only its owner read and write a file.
pub fn keep_to_owner(file: &File) -> Result<()> {
    file.set_permissions(Permissions::from_mode(0o600))
}

/// Rights of a file that others can read or write, and the command that takes them back; none if they
/// cannot.
pub fn readable_by_others(file: &Path) -> Option<(String, String)> {
    let mode = std::fs::metadata(file).ok()?.permissions().mode() & 0o777;
    let shown = file.display();
    (mode & 0o077 != 0).then(|| (format!("mode {mode:03o}"), format!("chmod 600 {shown}")))
}

/// Tells a file from another one put in its place.
pub fn identity(file: &Metadata) -> u64 {
    file.ino()
}

/// The file that a stream of the process reads or writes.
pub fn same_file(stream: &impl AsFd) -> Result<File> {
    stream.as_fd().try_clone_to_owned().map(File::from)
}

/// Where a path leads, links followed.
pub fn real_path(path: &Path) -> Result<PathBuf> {
    std::fs::canonicalize(path)
}
