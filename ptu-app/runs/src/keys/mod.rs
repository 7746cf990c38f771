//! Keys of technicians and benches: the private key in a file of its own, protected by a PIN, and the depot's list of
//! public keys.

mod file;
mod list;

use std::path::{Path, PathBuf};

use fault_db::Signer;

pub use file::{KeyFile, NewKey, public_name};
pub use list::{KeyEntry, KeyList, Standing, day_argument, day_of, day_text, name_argument};

use crate::failure::{Failure, FileTrouble, KeyTrouble, Sought};
use crate::{clock, owner_only};

/// The folder of one's own keys and of the list of those that are trusted.
///
/// # Errors
/// There is no user data directory.
pub fn own_folder() -> Result<PathBuf, Failure> {
    script_files::own_folder()
        .and_then(|scripts| scripts.parent().map(|data| data.join("keys")))
        .ok_or_else(|| Failure::usage(FileTrouble::NoUserFolder("--keys")))
}

/// Path of a file of keys that a person names: a name without a folder is looked for in the current folder, then in the
/// folder of one's own keys.
pub fn located(named: &Path) -> PathBuf {
    let kept = own_of(named).filter(|kept| kept.exists() && !named.exists());
    kept.unwrap_or_else(|| named.to_path_buf())
}

/// Where [`located`] looks.
pub fn sought(named: &Path) -> Sought {
    let own = own_of(named);
    let folder = own.as_deref().and_then(Path::parent);
    Sought {
        file: named.display().to_string(),
        folder: folder.map(|folder| folder.display().to_string()),
    }
}

/// The file of this name in the folder of one's own keys, if it is a name without a folder.
fn own_of(named: &Path) -> Option<PathBuf> {
    let is_bare = named.file_name() == Some(named.as_os_str());
    (is_bare.then(own_folder)?.ok()).map(|folder| folder.join(named))
}

/// The list in the folder of one's own keys.
pub const TRUSTED: &str = "trusted.keys";

/// The key in this file, if it is valid today by itself and by the list of this computer.
///
/// # Errors
/// The file is missing or readable by others, or the key is no longer valid.
pub fn usable(path: &Path) -> Result<KeyFile, Failure> {
    let file = KeyFile::read(path)?;
    owner_only::refuse_shared(&located(path))?;
    check(path, &file)?;
    Ok(file)
}

/// Signer with the key in this file.
///
/// # Errors
/// As [`usable`], or its PIN is wrong.
pub fn signer(path: &Path, pin: &str) -> Result<Signer, Failure> {
    usable(path)?.open(pin)
}

/// The key files in this folder, and in whose name each signs; the name is empty if the file cannot be read.
pub fn all_in(folder: &Path) -> Vec<(PathBuf, String)> {
    let files = folder.read_dir().ok();
    let paths = files
        .into_iter()
        .flatten()
        .flatten()
        .map(|file| file.path());
    let is_key = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "key");
    let mut keys: Vec<_> = paths.filter(is_key).collect();
    keys.sort();
    let who = |path: &PathBuf| KeyFile::read(path).map(|file| file.entry().who.clone());
    let whose: Vec<_> = keys
        .iter()
        .map(|path| who(path).unwrap_or_default())
        .collect();
    keys.into_iter().zip(whose).collect()
}

/// Refuses a key that does not hold today, by its own file or by the list of this computer.
fn check(path: &Path, file: &KeyFile) -> Result<(), Failure> {
    let (entry, now) = (file.entry(), clock::now_us());
    let listed = own_folder().ok().filter(|folder| folder.is_dir());
    let listed = listed.map(|folder| KeyList::read(&folder)).transpose()?;
    let listed = listed
        .unwrap_or_default()
        .standing(&entry.key, &entry.who, &entry.kind, now);
    for standing in [entry.standing(now), listed] {
        if !matches!(standing, Standing::Held | Standing::Unknown) {
            return Err(Failure::usage(KeyTrouble::NotHeld(
                path.display().to_string(),
                standing,
            )));
        }
    }
    Ok(())
}
