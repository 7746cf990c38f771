//! Linux; the macOS part follows its documentation and was never tried.

use std::ffi::OsString;
use std::fs::{File, FileType, Metadata, OpenOptions};
use std::os::unix::fs::{
    FileTypeExt as _, MetadataExt as _, OpenOptionsExt as _, PermissionsExt as _,
};
use std::path::{Path, PathBuf};

use postgres::config::Host;

use super::Identity;

/// Environment variable with the name of the user who is logged in.
pub(crate) const LOGGED_IN: &str = "USER";

/// Whether a lock on a file also stops programs that do not ask for the lock.
pub(crate) const LOCKS_BIND_ALL: bool = false;

/// Lets only its owner read and write a new file.
pub(crate) fn for_owner(options: &mut OpenOptions) {
    options.mode(0o600);
}

/// Lets all read a file, whatever the umask says.
///
/// # Errors
/// The rights of the file cannot be read or changed.
pub(crate) fn for_all(file: &File) -> std::io::Result<()> {
    let mut rights = file.metadata()?.permissions();
    rights.set_mode(rights.mode() | 0o444);
    file.set_permissions(rights)
}

#[expect(clippy::unnecessary_wraps, reason = "not every system numbers files")]
pub(crate) fn identity(about: &Metadata) -> Option<Identity> {
    Some(Identity {
        device: about.dev(),
        number: about.ino(),
        names: about.nlink(),
    })
}

/// Whether others than its owner can read or write a file.
pub(crate) fn is_open_to_others(about: &Metadata) -> bool {
    about.permissions().mode() & 0o077 != 0
}

/// Kind of a file that is neither regular nor a folder; `None` for another kind.
pub(crate) fn special_kind(kind: FileType) -> Option<&'static str> {
    let kinds = [
        (kind.is_fifo(), "a pipe"),
        (kind.is_socket(), "a socket"),
        (kind.is_char_device() || kind.is_block_device(), "a device"),
    ];
    kinds
        .iter()
        .find(|(is_it, _)| *is_it)
        .map(|(_, name)| *name)
}

/// libpq's password file of this user.
pub(crate) fn password_file(environment: &dyn Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    environment("HOME").map(|home| Path::new(&home).join(".pgpass"))
}

/// The name of a host, or the folder of its socket.
///
/// # Errors
/// Never.
#[expect(clippy::unnecessary_wraps, reason = "it can fail elsewhere")]
pub(crate) fn host(host: &Host) -> Result<String, &'static str> {
    Ok(match host {
        Host::Tcp(name) => name.clone(),
        Host::Unix(folder) => folder.to_string_lossy().into_owned(),
    })
}
