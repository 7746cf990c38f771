//! Fault dictionaries stored in the file; none is ever deleted, the newest comes first.

use rusqlite::params;

use crate::backend::values;
use crate::diagnosis::Dictionary;
use crate::error::StoreError;
use crate::id::Id;
use crate::store::Store;

impl Store {
    /// Stores a dictionary.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn put_dictionary(
        &self,
        dictionary: &Dictionary,
        made_at_us: i64,
    ) -> Result<Id, StoreError> {
        const DOING: &str = "storing a fault dictionary";
        let id = self.mint()?;
        let basis = &dictionary.basis;
        let data = dictionary.to_bytes().map_err(|reason| StoreError::Io {
            path: self.path().to_path_buf(),
            reason,
        })?;
        self.write(DOING, |conn| {
            conn.prepare_cached(
                "INSERT INTO dictionary(id, made_at_us, app_version, basis_sha256, modes, data)
                 VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
            )
            .and_then(|mut insert| {
                insert.execute(params![
                    id,
                    made_at_us,
                    basis.app_version,
                    basis.sha256,
                    dictionary.modes.len(),
                    data
                ])
            })
            .map_err(|error| self.failed(DOING, error))
        })?;
        Ok(id)
    }

    /// The dictionary with exactly this provenance, else any, preferring the one with the most fault modes,
    /// then the newest; and when it was made.
    ///
    /// # Errors
    /// The file cannot be read, or its content is no dictionary.
    pub fn dictionary(&self, basis_sha256: &str) -> Result<Option<(Dictionary, i64)>, StoreError> {
        const DOING: &str = "reading a fault dictionary";
        let found = self.first(
                DOING,
                "SELECT made_at_us, data FROM dictionary
                 ORDER BY CASE WHEN basis_sha256 = ?1 THEN 0 ELSE 1 END, modes DESC, made_at_us DESC, seq DESC
                 LIMIT 1",
            &values![basis_sha256],
            |row| Ok((row.get(0)?, row.get::<Vec<u8>>(1)?)),
        )?;
        let Some((made_at_us, data)) = found else {
            return Ok(None);
        };
        let dictionary = Dictionary::from_bytes(&data).map_err(|reason| StoreError::Io {
            path: self.path().to_path_buf(),
            reason: format!("a fault dictionary is damaged: {reason}"),
        })?;
        Ok(Some((dictionary, made_at_us)))
    }
}
