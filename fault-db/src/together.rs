//! Several writes in one commit.

use rusqlite::Connection;

use crate::error::StoreError;
use crate::store::Store;

impl Store {
    /// Commits all that `work` writes to this file at once: all of it, or nothing when `work` fails.
    /// For many writes that are worth little alone, since each commit costs more than what it writes. Others
    /// wait for the file until it is done.
    ///
    /// A single write that fails within is taken back alone; `work` decides whether to go on. What a
    /// [`RunWriter`](crate::RunWriter) wrote within is gone when all is taken back: drop it then.
    pub fn together<T>(
        &self,
        work: impl FnOnce() -> Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        let done = self.write("writing several things at once", |_| work());
        if done.is_err() {
            // What was read within may never have been.
            self.channel_sets.borrow_mut().clear();
        }
        done
    }

    /// A write inside of a transaction that is open: taken back alone when it fails.
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
                // If even this fails SQLite has taken back everything, and the commit will say so.
                let _ = say("ROLLBACK TO part").and_then(|()| say("RELEASE part"));
                Err(error)
            }
        }
    }
}
