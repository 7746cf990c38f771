//! The last seal of a file.

use super::Store;
use crate::backend::{Backend, SqlResult};
use crate::error::StoreError;
use crate::seal::{SealHead, head_of, hex, own_file_id};

impl Store {
    /// The last entry of this file's chain; `None` for a server, which has no chain of its own, and for a
    /// file never opened for writing.
    pub fn head(&self) -> Result<Option<SealHead>, StoreError> {
        const DOING: &str = "reading the last seal";
        let Backend::File(_) = self.backend() else {
            return Ok(None);
        };
        let read = || -> SqlResult<_> {
            let Some(file) = own_file_id(self.backend())? else {
                return Ok(None);
            };
            let head = head_of(self.backend(), file)?;
            Ok(head.map(|(entries, hash)| SealHead {
                file,
                entries,
                seal: hex(&hash),
            }))
        };
        read().map_err(|error| self.failed(DOING, error))
    }
}
