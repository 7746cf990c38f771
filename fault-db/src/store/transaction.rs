//! Several writes in one transaction.

use rusqlite::Connection;

use crate::error::StoreError;
use crate::store::Store;

impl Store {
    /// Commits all writes of `work` to this file at once, or none if it fails. For many small writes, as each
    /// commit costs more than a small write. Others wait for the file until it is done.
    ///
    /// A single write that fails within is rolled back alone; `work` decides whether to go on. If all is
    /// rolled back, what a [`RunWriter`](crate::RunWriter) wrote within is gone, too: drop it then.
    pub fn transaction<T>(
        &self,
        work: impl FnOnce() -> Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        let done = self.write("writing several things at once", |_| work());
        if done.is_err() {
            // What was read within may have been rolled back.
            self.channel_sets.borrow_mut().clear();
        }
        done
    }

    /// A write within an open transaction, rolled back alone if it fails.
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
