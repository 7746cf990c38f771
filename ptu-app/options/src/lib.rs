//! Options that `ptu` and `ptu-window` share. Each of the two programs reads them from its own command line, so that
//! the same words mean the same.
//!
//! * [`Database`]: `--db`; [`ScriptsOption`]: `--scripts`;
//! * [`presets`]: defaults that a depot or a user chose, in files;
//! * [`WindowOptions`]: all options of `ptu gui`; [`Page`]: the pages of the window.

mod database;
mod page;
pub mod presets;
mod scripts;
mod window;

use std::path::PathBuf;

pub use database::{Database, only_file};
use fault_db::Address;
pub use page::Page;
use ptu_runs::failure::{Asked, Failure, FileTrouble};
pub use scripts::ScriptsOption;
pub use window::WindowOptions;

/// Path of a file of this user's settings.
///
/// # Errors
/// The user has no folder for it.
pub fn settings_file(name: &str) -> Result<PathBuf, Failure> {
    directories::ProjectDirs::from("", "", "ptu")
        .map(|directories| directories.config_dir().join(name))
        .ok_or_else(|| Failure::usage(FileTrouble::NoSettingsFolder))
}

/// Path of the file with this user's calibrations of sound devices.
///
/// # Errors
/// The user has no folder for it.
pub fn sound_file() -> Result<PathBuf, Failure> {
    settings_file("sound.json")
}

/// Refuses a command line that holds a server's password.
///
/// # Errors
/// An argument holds a password. Call this first: any other error would show the argument with the password.
pub fn refuse_password() -> Result<(), Failure> {
    let mut arguments = std::env::args_os().skip(1);
    if arguments.any(|argument| Address::holds_password(&argument.to_string_lossy())) {
        return Err(Failure::usage(Asked::Password));
    }
    Ok(())
}
