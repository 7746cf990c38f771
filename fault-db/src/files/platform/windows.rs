//! Windows. The rights of a user's folders keep other users from the files in them.

use std::ffi::OsString;
use std::fs::{File, FileType, Metadata, OpenOptions};
use std::path::{Path, PathBuf};

use postgres::config::Host;

use super::Identity;

/// Environment variable with the name of the user who is logged in.
pub(crate) const LOGGED_IN: &str = "USERNAME";

/// Whether a lock on a file also stops programs that do not ask for the lock.
pub(crate) const LOCKS_BIND_ALL: bool = true;

/// Does nothing: the folder's rights decide who may read a new file.
pub(crate) fn for_owner(_: &mut OpenOptions) {}

/// Does nothing: the folder's rights decide who may read a file.
///
/// # Errors
/// Never.
#[expect(clippy::unnecessary_wraps, reason = "it can fail elsewhere")]
pub(crate) fn for_all(_: &File) -> std::io::Result<()> {
    Ok(())
}

/// Always `None`; none is needed, as Windows does not let an open file be removed or replaced.
pub(crate) fn identity(_: &Metadata) -> Option<Identity> {
    None
}

/// Always false: on Windows rights are lists, which are not read here. libpq does not read them either.
pub(crate) fn is_open_to_others(_: &Metadata) -> bool {
    false
}

/// Kind of a file that is neither regular nor a folder; always `None`, as Windows does not say.
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
/// The name is a folder, which holds no socket on Windows.
pub(crate) fn host(Host::Tcp(name): &Host) -> Result<String, &'static str> {
    match name.starts_with('/') {
        true => Err("on Windows a server is reached by host name, not by a folder"),
        false => Ok(name.clone()),
    }
}
