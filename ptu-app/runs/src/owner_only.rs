//! Creates folders and files that only their owner can read: history and settings.

use std::path::Path;

use crate::failure::{Failure, FileTrouble, Why};
use crate::platform;

/// Makes the folder in which a file is to lie, and the folders above it, as far as they are missing, for their owner alone.
///
/// # Errors
/// The folder cannot be made.
pub fn folder_of(file: &Path) -> Result<(), Failure> {
    let Some(path) = file.parent().filter(|f| !f.as_os_str().is_empty()) else {
        return Ok(());
    };
    platform::make_folder(path).map_err(|error| {
        Failure::bench(FileTrouble::Unmade(
            path.display().to_string(),
            Why::of(error),
        ))
    })
}

/// Warning of a file that others can read or write, if they can. Its rights stay as they are: somebody may
/// have given them on purpose.
pub fn told_if_shared(file: &Path) -> Option<FileTrouble> {
    let (rights, command) = platform::readable_by_others(file)?;
    let shown = file.display().to_string();
    Some(FileTrouble::OpenToOthers(shown, rights, command))
}

/// Refuses a secret that others can read.
///
/// # Errors
/// Others can read the secret.
pub fn refuse_shared(secret: &Path) -> Result<(), Failure> {
    let Some((rights, command)) = platform::readable_by_others(secret) else {
        return Ok(());
    };
    let shown = secret.display().to_string();
    Err(Failure::usage(FileTrouble::Shared(shown, rights, command)))
}
