//! A file's last sync with each server.

use serde::Serialize;

use crate::backend::{from_row, values};
use crate::error::StoreError;
use crate::store::Store;

/// A file's last sync with one server.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LastSync {
    /// The server's address as it was reached, without a password.
    pub server: String,
    /// Time of the sync, µs since 1970.
    pub at_us: i64,
    /// Number of the file's entries that the server does not have yet, including traces.
    pub waiting: u64,
}

impl Store {
    /// The last sync of a file with each server it has met, the latest first.
    ///
    /// # Errors
    /// The file cannot be read, or is a server.
    pub fn last_syncs(&self) -> Result<Vec<LastSync>, StoreError> {
        self.file()?;
        self.select(
            "looking up the last sync",
            "SELECT s.address, s.last_at_us, (SELECT count(*) FROM outbox o
                WHERE o.seq > CASE o.what WHEN 'trace' THEN s.sent_traces ELSE s.sent END)
             FROM sync_server s ORDER BY s.last_at_us DESC, s.id",
            &values![],
            |row| Ok(from_row!(row => LastSync: server, at_us, waiting)),
        )
    }
}
