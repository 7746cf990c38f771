//! A copy of a file, made while other programs may write to it.

use std::path::Path;

use crate::error::StoreError;
use crate::store::Store;
use crate::store::atomic_file::AtomicFile;
use crate::store::file::copy_to;

impl Store {
    /// Copies the file as it is now, compacted, while others may write to it.
    pub fn backup(&self, to: &Path) -> Result<(), StoreError> {
        let conn = self.file()?;
        AtomicFile::can_be_made(to)?;
        copy_to(conn, to, "backing up")
    }
}
