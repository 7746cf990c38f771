//! The folder in which files are saved by default.

use std::path::{Path, PathBuf};

/// The folder for documents, or the one the program was started in.
pub fn usual_folder() -> PathBuf {
    directories::UserDirs::new()
        .and_then(|folders| folders.document_dir().map(Path::to_path_buf))
        .filter(|folder| folder.is_dir())
        .or_else(|| std::env::current_dir().ok())
        .unwrap_or_default()
}
