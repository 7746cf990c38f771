//! Files a person asks for: where they usually go, and never over another.

use std::fs::File;
use std::path::{Path, PathBuf};

use crate::failure::Failure;

/// Names tried beside one that is taken.
const BESIDE: u32 = 1000;

/// The folder for documents, or the one the program was started in.
pub fn usual_folder() -> PathBuf {
    directories::UserDirs::new()
        .and_then(|folders| folders.document_dir().map(Path::to_path_buf))
        .filter(|folder| folder.is_dir())
        .or_else(|| std::env::current_dir().ok())
        .unwrap_or_default()
}

/// A new file of this name, or of one beside it (`sheet.pdf`, `sheet-2.pdf` …): nothing is written over.
///
/// # Errors
/// It cannot be made, or all names are taken.
pub fn new_file(wanted: &Path) -> Result<(File, PathBuf), Failure> {
    let beside = (2..BESIDE).map(|n| numbered(wanted, n));
    for path in std::iter::once(wanted.to_path_buf()).chain(beside) {
        match File::create_new(&path) {
            Ok(file) => return Ok((file, path)),
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(cannot_write(&path, &error)),
        }
    }
    Err(cannot_write(wanted, &"it is there already"))
}

/// A file that was to be written, and why it was not.
pub fn cannot_write(path: &Path, why: &dyn std::fmt::Display) -> Failure {
    Failure::bench(format!("cannot write {}: {why}", path.display()))
}

/// The name with a number before its ending.
fn numbered(path: &Path, number: u32) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_os_string();
    name.push(format!("-{number}"));
    if let Some(ending) = path.extension() {
        name.push(".");
        name.push(ending);
    }
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_written_over_and_a_folder_that_is_not_there_is_told() {
        let folder = tempfile::tempdir().expect("folder");
        let wanted = folder.path().join("trace.v2.csv");
        let names: Vec<_> = (0..3)
            .map(|_| new_file(&wanted).expect("made").1)
            .map(|path| path.file_name().expect("named").to_owned())
            .collect();
        assert_eq!(names, ["trace.v2.csv", "trace.v2-2.csv", "trace.v2-3.csv"]);
        let failure = new_file(&folder.path().join("no/where.csv")).expect_err("no folder");
        assert!(failure.message.contains("where.csv"), "{}", failure.message);
    }
}
