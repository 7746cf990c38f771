//! The last seal of a file.

use super::Store;
use crate::backend::{Backend, SqlResult};
use crate::error::StoreError;
use crate::seal::{SealHead, head_of, hex, known_heads, own_file_id};

impl Store {
    /// The last entry of this file's chain; `None` for a server, which has no chain of its own, and for a
    /// file never opened for writing.
    pub fn head(&self) -> Result<Option<SealHead>, StoreError> {
        const DOING: &str = "reading the last seal";
        let Backend::File(_) = &self.backend else {
            return Ok(None);
        };
        let read = || -> SqlResult<_> {
            let Some(file) = own_file_id(&self.backend)? else {
                return Ok(None);
            };
            let head = head_of(&self.backend, file)?;
            Ok(head.map(|(entries, hash)| SealHead {
                file,
                entries,
                seal: hex(&hash),
            }))
        };
        read().map_err(|error| self.failed(DOING, error))
    }

    /// Holds the chains of another file against what this one has seen of them; what was rewritten or cut there.
    ///
    /// # Errors
    /// One of them cannot be read.
    pub fn seen_otherwise(&self, other: &Store) -> Result<Vec<String>, StoreError> {
        const DOING: &str = "comparing chains of seals";
        if !matches!(&self.backend, Backend::File(_)) {
            return Ok(Vec::new());
        }
        let known = known_heads::seen_by(&self.backend);
        let known = known.map_err(|error| self.failed(DOING, error))?;
        let look = || {
            let own = own_file_id(&other.backend)?;
            known_heads::broken(&other.backend, &known, own)
        };
        let broken = look().map_err(|error| other.failed(DOING, error))?;
        Ok(broken
            .into_iter()
            .map(|(_, what)| what.to_string())
            .collect())
    }
}
