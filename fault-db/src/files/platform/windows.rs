//! Windows. What is made in a user's folders is closed to other users by the rights of those folders.

use std::ffi::OsString;
use std::fs::{File, FileType, Metadata, OpenOptions};
use std::path::{Path, PathBuf};

use postgres::config::Host;

use super::Identity;

/// The variable with the name of who is logged in.
pub(crate) const LOGGED_IN: &str = "USERNAME";

/// Whether a lock keeps those from a file who do not ask for it.
pub(crate) const LOCKS_BIND_ALL: bool = true;

/// Leaves it to the folder who may read a file that is made.
pub(crate) fn for_owner(_: &mut OpenOptions) {}

/// Leaves it to the folder who may read a file.
///
/// # Errors
/// Never.
#[expect(clippy::unnecessary_wraps, reason = "it can fail elsewhere")]
pub(crate) fn for_all(_: &File) -> std::io::Result<()> {
    Ok(())
}

/// Windows tells no identity here: an open file can be neither removed nor replaced.
pub(crate) fn identity(_: &Metadata) -> Option<Identity> {
    None
}

/// Rights are not looked at: they are lists on Windows. libpq does not look at them either.
pub(crate) fn is_open_to_others(_: &Metadata) -> bool {
    false
}

/// Kind of a file that is neither regular nor a folder: Windows does not say.
pub(crate) fn special_kind(_: FileType) -> Option<&'static str> {
    None
}

/// libpq's password file of this user.
pub(crate) fn password_file(environment: &dyn Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    environment("APPDATA").map(|folder| Path::new(&folder).join(r"postgresql\pgpass.conf"))
}

/// The name of a host.
///
/// # Errors
/// A folder is named; it holds no socket here.
pub(crate) fn host(Host::Tcp(name): &Host) -> Result<String, &'static str> {
    match name.starts_with('/') {
        true => Err("on Windows a server is reached by host name, not by a folder"),
        false => Ok(name.clone()),
    }
}
