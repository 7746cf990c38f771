//! Fault dictionaries stored in the file; none is ever deleted.

use crate::backend::values;
use crate::error::StoreError;
use crate::id::Id;
use crate::store::Store;

/// A fault dictionary as stored. The file does not look into its data.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DictionaryRecord {
    /// When it was made, microseconds since 1970, UTC.
    pub made_at_us: i64,
    /// Version of the program that made it.
    pub app_version: String,
    /// Provenance of the dictionary: SHA-256 over everything that it was made of, in hex.
    pub basis_sha256: String,
    /// Number of fault modes in it.
    pub modes: usize,
    /// The dictionary, encoded and compressed by the diagnosis.
    pub data: Vec<u8>,
}

impl Store {
    /// Stores a dictionary.
    ///
    /// # Errors
    /// The database cannot be written.
    pub fn put_dictionary(&self, record: &DictionaryRecord) -> Result<Id, StoreError> {
        const DOING: &str = "storing a fault dictionary";
        let id = self.mint()?;
        let values = values![
            id,
            record.made_at_us,
            &record.app_version,
            &record.basis_sha256,
            record.modes as i64,
            &record.data[..],
        ];
        self.write(DOING, |_| {
            self.ask(DOING, |file| {
                file.execute(
                    "INSERT INTO dictionary(id, made_at_us, app_version, basis_sha256, modes, data)
                     VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
                    &values,
                )
            })
        })?;
        Ok(id)
    }

    /// The data of the dictionary with exactly this provenance, else of any, preferring the one with the most
    /// fault modes, then the newest.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn dictionary(&self, basis_sha256: &str) -> Result<Option<Vec<u8>>, StoreError> {
        self.first(
            "reading a fault dictionary",
            "SELECT data FROM dictionary
             ORDER BY CASE WHEN basis_sha256 = ?1 THEN 0 ELSE 1 END, modes DESC, made_at_us DESC, seq DESC
             LIMIT 1",
            &values![basis_sha256],
            |row| row.get::<Vec<u8>>(0),
        )
    }
}
