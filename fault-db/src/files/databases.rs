//! Recognises files that are databases or belong to one, so that the program never overwrites them.

use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use crate::files::platform::Identity;
use crate::files::regular_file::open_regular_file;

/// Files that SQLite keeps beside a database, by the ends of their names.
const BESIDE: [&str; 3] = ["-wal", "-shm", "-journal"];
/// First bytes of an SQLite database.
const MAGIC: &[u8] = b"SQLite format 3\0";

/// Databases that this program opened.
static OPENED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Notes that this program opened a database.
pub(crate) fn note_opened(database: &Path) {
    let mut opened = OPENED.lock().unwrap_or_else(PoisonError::into_inner);
    if !opened.iter().any(|known| known == database) {
        opened.push(database.to_path_buf());
    }
}

/// Whether a file is an SQLite database, or a file that SQLite keeps beside one: by its content, whatever its name, and
/// through links.
pub fn is_of_database(place: &Path) -> bool {
    let of = |end: &&str| {
        let name = place.file_name()?.to_str()?.strip_suffix(*end)?;
        Some(place.with_file_name(name))
    };
    is_database(place) || BESIDE.iter().filter_map(of).any(|of| is_database(&of))
}

fn is_database(place: &Path) -> bool {
    // A database that is open here is not opened again: closing it would release SQLite's locks.
    let opened = OPENED.lock().unwrap_or_else(PoisonError::into_inner);
    let parts = |database: &PathBuf| ["", "-wal", "-shm"].map(|end| with_end(database, end));
    if opened.iter().flat_map(parts).any(|of| is_same(&of, place)) {
        return true;
    }
    let mut head = [0; MAGIC.len()];
    let read = open_regular_file(place).and_then(|mut file| file.read_exact(&mut head));
    read.is_ok() && head == MAGIC
}

/// A path with `end` added to its name: `a.db` and `-wal` give `a.db-wal`.
pub(crate) fn with_end(path: &Path, end: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(end);
    name.into()
}

/// Whether two paths lead to one file.
fn is_same(a: &Path, b: &Path) -> bool {
    match (Identity::at(a), Identity::at(b)) {
        (Some(here), Some(there)) => here.is_same(&there),
        // The system gives files no numbers: compare the paths.
        _ => std::fs::canonicalize(a).is_ok_and(|a| std::fs::canonicalize(b).is_ok_and(|b| a == b)),
    }
}
