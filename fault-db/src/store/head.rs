//! The last seal of a file, and the comparison of chains with what this file knows of them.

use super::Store;
use crate::backend::Backend;
use crate::error::StoreError;
use crate::seal::{SealHead, head_of, hex, known_heads, own_file_id};

impl Store {
    /// The last entry of this file's chain; `None` for a server, which has no chain of its own, and for a
    /// file never opened for writing.
    pub fn head(&self) -> Result<Option<SealHead>, StoreError> {
        self.ask("reading the last seal", |backend| {
            let Some(file) = own_file_id(backend)? else {
                return Ok(None);
            };
            let head = head_of(backend, file)?;
            Ok(head.map(|(entries, hash)| SealHead {
                file,
                entries,
                seal: hex(&hash),
            }))
        })
    }

    /// Compares the chains of another file with what this file has seen of them; returns what was rewritten or cut
    /// there.
    ///
    /// # Errors
    /// One of the files cannot be read.
    pub fn seen_otherwise(&self, other: &Store) -> Result<Vec<String>, StoreError> {
        const DOING: &str = "comparing chains of seals";
        if !matches!(&self.backend, Backend::File(_)) {
            return Ok(Vec::new());
        }
        let known = self.ask(DOING, known_heads::seen_by)?;
        let broken = other.ask(DOING, |other| {
            known_heads::broken(other, &known, own_file_id(other)?)
        })?;
        Ok(broken
            .into_iter()
            .map(|(_, what)| what.to_string())
            .collect())
    }
}
