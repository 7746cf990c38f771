//! Keys of technicians and benches: the private key in a file of its own, protected by a PIN, and the depot's list of
//! public keys.

mod file;
mod list;

use std::path::PathBuf;

pub use file::{KeyFile, NewKey, public_name};
pub use list::{KeyEntry, KeyList, Standing, day_argument, day_of, day_text};

use crate::failure::Failure;

/// The folder of one's own keys and of the list of those that are trusted.
///
/// # Errors
/// There is no user data directory.
pub fn own_folder() -> Result<PathBuf, Failure> {
    script_files::own_folder()
        .and_then(|scripts| scripts.parent().map(|data| data.join("keys")))
        .ok_or_else(|| Failure::usage("no user data directory; name a file or folder with --keys"))
}

/// The list in the folder of one's own keys.
pub const TRUSTED: &str = "trusted.keys";
