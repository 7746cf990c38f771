//! Several writes in one transaction.

use rusqlite::Connection;

use crate::error::StoreError;
use crate::store::Store;

impl Store {
    /// Commits all writes of `work` to this file at once, or none if `work` fails. Meant for many small writes, as a
    /// commit costs more than a small write. Other writers of the file wait until it is done.
    ///
    /// A single write that fails within `work` is rolled back alone, and `work` decides whether to go on. If everything
    /// is rolled back, so is what a [`RunWriter`](crate::RunWriter) wrote within: drop that writer.
    pub fn transaction<T>(
        &self,
        work: impl FnOnce() -> Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        let done = self.write("writing several things at once", |_| work());
        if done.is_err() {
            // Channel lists read within `work` may have been rolled back.
            self.channel_sets.borrow_mut().clear();
        }
        done
    }

    /// Runs a write within an open transaction; rolled back alone if it fails.
    pub(crate) fn write_within<T>(
        &self,
        doing: &'static str,
        conn: &Connection,
        work: impl FnOnce(&Connection) -> Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        let say = |sql: &str| {
            let said = conn.prepare_cached(sql).and_then(|mut sql| sql.execute([]));
            said.map(drop).map_err(|error| self.failed(doing, error))
        };
        say("SAVEPOINT part")?;
        match work(conn) {
            Ok(result) => {
                say("RELEASE part")?;
                Ok(result)
            }
            Err(error) => {
                // If even this fails, SQLite has rolled back everything, and the commit will fail.
                let _ = say("ROLLBACK TO part").and_then(|()| say("RELEASE part"));
                Err(error)
            }
        }
    }
}
