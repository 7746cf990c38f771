//! Imports from a file and exports to one; before a merge, compares the chains of seals.

use std::path::Path;

use rusqlite::ErrorCode;

use super::super::sync::chain_error;
use super::{CopyOf, Merge, MergeCounts};
use crate::backend::SqlError;
use crate::error::StoreError;
use crate::seal::divergence::{ChainComparison, compare_all_chains};
use crate::seal::{known_heads, own_file_id};
use crate::store::Store;
use crate::store::atomic_file::AtomicFile;
use crate::store::file::CACHE_KIB;
use crate::store::open_options::OpenOptions;

impl Store {
    /// Adds all rows of the other file that this file lacks, in one transaction. Runs finished here are sealed and stay
    /// as they are; those that differ in the other file are listed.
    pub fn import(&self, from: &Path) -> Result<MergeCounts, StoreError> {
        let same = |path: &Path| std::fs::canonicalize(path).ok();
        if same(from).is_some() && same(from) == same(self.path()) {
            return Err(StoreError::SameFile(from.to_path_buf()));
        }
        // Opening checks the schema version, and restricts the SQL stored in the file.
        let other = Store::open_read_only(from)?;
        match other.foreign_objects()?.into_iter().next() {
            Some(what) => Err(StoreError::Altered {
                path: from.to_path_buf(),
                what: Box::new(what),
                more: 0,
            }),
            None => self.merge_from(&other),
        }
    }

    /// Adds all rows of this file to another one, which is created if need be.
    pub fn export(&self, to: &Path, options: OpenOptions) -> Result<MergeCounts, StoreError> {
        match AtomicFile::can_be_made(to) {
            Err(StoreError::TargetExists(_)) => {}
            made => made?,
        }
        let target = Store::open(to, options)?;
        let counts = target.merge_from(self)?;
        target.close()?;
        Ok(counts)
    }

    /// Adds all rows of the other store that this store lacks, in one transaction.
    pub fn merge_from(&self, other: &Store) -> Result<MergeCounts, StoreError> {
        const DOING: &str = "merging";
        let theirs = other.file()?;
        self.check_writable()?;
        let set_cache = |size: i32| {
            let set = self
                .file()?
                .execute_batch(&format!("PRAGMA cache_size = {size}"));
            set.map_err(|error| self.failed(DOING, error))
        };
        // One read transaction, so that all tables are seen at the same moment.
        let begin = theirs.execute_batch("BEGIN");
        begin.map_err(|error| other.failed(DOING, error))?;
        let merged = self.copy_of(other).and_then(|copy| {
            // Indexes are filled in random order, which needs more of their pages in memory than usual.
            set_cache(CACHE)?;
            self.write(DOING, |conn| {
                let merge = || Merge::begin(&other.backend, &self.backend, conn)?.all(copy);
                merge().map_err(|error| self.error_of(other, error))
            })
        });
        let _ = theirs.execute_batch("COMMIT");
        // Reduced again, as the setting lasts as long as this store is open.
        let _ = set_cache(-(CACHE_KIB as i32));
        merged
    }

    /// Compares the other file's chains of seals with the ones known here.
    ///
    /// # Errors
    /// A chain was rewritten, or no longer has the entry that was known of it.
    fn copy_of(&self, other: &Store) -> Result<Option<CopyOf>, StoreError> {
        const DOING: &str = "comparing seals";
        let own = other.ask(DOING, own_file_id)?;
        let chains = other.ask(DOING, |theirs| compare_all_chains(theirs, &self.backend))?;
        let ours = self.ask(DOING, own_file_id)?;
        let known = self.ask(DOING, known_heads::seen_by)?;
        // An older copy of this file may be imported; of another file it shows that the file was replaced by a copy.
        let whole = own.filter(|own| Some(*own) != ours);
        let broken = other.ask(DOING, |theirs| known_heads::broken(theirs, &known, whole))?;
        if let Some((_, what)) = broken.into_iter().next() {
            return Err(StoreError::Altered {
                path: other.path().to_path_buf(),
                what: Box::new(what),
                more: 0,
            });
        }
        let mut copy = None;
        for (file, stands) in chains {
            let (after, went_on) = match stands {
                ChainComparison::Rewritten { .. } => {
                    return Err(chain_error(other.path(), &stands));
                }
                ChainComparison::Forked { after } => (after, true),
                ChainComparison::Behind { here, .. } => (here, false),
                ChainComparison::Extends { .. } => continue,
            };
            if own == Some(file) {
                copy = Some(CopyOf {
                    file,
                    after,
                    went_on,
                });
            }
        }
        Ok(copy)
    }

    /// Attributes an error to the file that caused it.
    fn error_of(&self, other: &Store, error: SqlError) -> StoreError {
        const DOING: &str = "merging";
        let SqlError::File(error) = error else {
            return self.failed(DOING, error);
        };
        match error.sqlite_error_code() {
            // A row of the other file without its parent.
            Some(ErrorCode::ConstraintViolation) => StoreError::Corrupt {
                path: other.path().to_path_buf(),
                detail: error.to_string(),
            },
            // A value of the wrong type.
            None => other.failed(DOING, error),
            Some(ErrorCode::DatabaseCorrupt) if !is_whole(other) => other.failed(DOING, error),
            Some(_) => self.failed(DOING, error),
        }
    }
}

/// Whether SQLite finds no damage in a file.
fn is_whole(store: &Store) -> bool {
    let checked = store.file().map(|conn| {
        let check = conn.query_row("PRAGMA quick_check(1)", [], |row| row.get::<_, String>(0));
        check.is_ok_and(|found| found == "ok")
    });
    checked.unwrap_or(false)
}

/// Page cache during a merge, as SQLite's `cache_size`: negative numbers are KiB.
const CACHE: i32 = -(64 << 10);
