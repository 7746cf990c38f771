//! A copy of a file, made while others write.

use std::fs::File;
use std::path::Path;

use crate::error::StoreError;
use crate::file::copy_to;
use crate::store::Store;

impl Store {
    /// Copies the file as it stands now, compacted, while others may write to it.
    pub fn backup(&self, to: &Path) -> Result<(), StoreError> {
        if to.exists() {
            return Err(StoreError::TargetExists {
                path: to.to_path_buf(),
            });
        }
        let conn = self.file()?;
        target_can_be_made(to)?;
        copy_to(conn, to, "backing up")
    }
}

/// Holds a file that is to be made to a folder that is there and lets it be made.
pub(super) fn target_can_be_made(to: &Path) -> Result<(), StoreError> {
    let cannot = |reason: String| StoreError::CannotWrite {
        path: to.to_path_buf(),
        reason,
    };
    let folder = to.parent().filter(|folder| !folder.as_os_str().is_empty());
    if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
        return Err(cannot(format!("there is no folder {}", folder.display())));
    }
    // Only trying tells for sure; SQLite would not tell why.
    File::create_new(to).map_err(|error| cannot(error.to_string()))?;
    std::fs::remove_file(to).map_err(|error| cannot(error.to_string()))
}
