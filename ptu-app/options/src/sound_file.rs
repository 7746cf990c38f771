//! The file in which this user's calibrations of sound devices are.

use std::path::PathBuf;

use ptu_runs::failure::{Failure, FileTrouble};

/// The file, in the user's configuration.
///
/// # Errors
/// The user has no folder for it.
pub fn usual() -> Result<PathBuf, Failure> {
    directories::ProjectDirs::from("", "", "ptu")
        .map(|directories| directories.config_dir().join("sound.json"))
        .ok_or_else(|| Failure::usage(FileTrouble::NoSettingsFolder))
}
