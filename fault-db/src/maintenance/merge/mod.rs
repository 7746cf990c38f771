//! Merges the history of one file into another. Idempotent: a row whose id is known is not added again.

mod compare_runs;
mod faults;
mod rows;
mod runs;
mod seals;
mod valid_rows;
mod validate;

use std::collections::BTreeSet;
use std::path::Path;

use rusqlite::{Connection, ErrorCode};
use serde::Serialize;

use crate::atomic_file::AtomicFile;
use crate::backend::{Backend, SqlError, SqlResult};
use crate::domain::Refusals;
use crate::error::StoreError;
use crate::file::CACHE_KIB;
use crate::id::Id;
use crate::open_options::OpenOptions;
use crate::seal::divergence::{ChainComparison, compare_chains};
use crate::seal::own_file_id;
use crate::store::Store;
use crate::sync::{Different, chain_error};
use rows::{MEASUREMENTS, RECORDINGS, SCRIPTS, STEPS};

/// The result of a merge.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct MergeCounts {
    /// Units not known before.
    pub units: usize,
    /// Runs not known before.
    pub runs: usize,
    /// Steps not known before.
    pub steps: usize,
    /// Measurements not known before.
    pub measurements: usize,
    /// Faults not known before.
    pub faults: usize,
    /// Occurrences not known before.
    pub occurrences: usize,
    /// Events not known before.
    pub events: usize,
    /// Traces not known before.
    pub traces: usize,
    /// Recordings not known before.
    pub recordings: usize,
    /// Notes on runs not known before.
    pub notes: usize,
    /// Runs that are finished on both sides with different content; ours were kept.
    pub different: Vec<Different>,
    /// Set if the other file is a copy of a file whose chain of seals is known here.
    pub copy: Option<CopyOf>,
    /// Rows of the other file outside their columns' domain, and runs that do not match their seals: they
    /// were left out, with all rows that depend on them.
    pub refused: Refusals,
}

/// How another file is a copy.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct CopyOf {
    /// The file id that both have.
    pub file: Id,
    /// The last entry of the chain of seals that both have.
    pub after: i64,
    /// Whether the copy has entries of its own after that; else it is an older state.
    pub went_on: bool,
}

impl Store {
    /// Adds all rows that the other file has and this one has not, in one transaction. Runs finished here
    /// stay as they are, because they are sealed; those that differ in the other file are listed.
    pub fn import(&self, from: &Path) -> Result<MergeCounts, StoreError> {
        let same = |path: &Path| std::fs::canonicalize(path).ok();
        if same(from).is_some() && same(from) == same(self.path()) {
            return Err(StoreError::SameFile {
                path: from.to_path_buf(),
            });
        }
        // Opening checks that the schema version is ours, and restricts the file's own SQL.
        let other = Store::open_read_only(from)?;
        match other.foreign_objects()?.into_iter().next() {
            Some(what) => Err(StoreError::Altered {
                path: from.to_path_buf(),
                what,
            }),
            None => self.merge_from(&other),
        }
    }

    /// Adds all rows of this file to another one, which is created if need be.
    pub fn export(&self, to: &Path, options: OpenOptions) -> Result<MergeCounts, StoreError> {
        if !to.exists() {
            AtomicFile::can_be_made(to)?;
        }
        let target = Store::open(to, options)?;
        let counts = target.merge_from(self)?;
        target.close()?;
        Ok(counts)
    }

    /// Adds all rows that the other store has and this one has not, in one transaction.
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
        let examined = validate::hide_invalid_rows(theirs, other.backend(), self.backend());
        let examined = examined.map_err(|error| self.error_of(other, error));
        let merged = examined.and_then(|refused| {
            let copy = self.copy_of(other)?;
            // Indexes are filled in random order, which needs more of their pages in memory than usual.
            set_cache(CACHE)?;
            self.write(DOING, |ours| {
                Merge {
                    theirs,
                    ours,
                    backend: self.backend(),
                    their_backend: other.backend(),
                    counts: MergeCounts {
                        copy,
                        refused,
                        ..MergeCounts::default()
                    },
                    fresh_runs: BTreeSet::new(),
                    sealed_runs: BTreeSet::new(),
                    different_runs: BTreeSet::new(),
                }
                .all()
                .map_err(|error| self.error_of(other, error))
            })
        });
        let _ = validate::show_all_rows(theirs);
        let _ = theirs.execute_batch("COMMIT");
        // The cache is reduced again; it would last as long as this store is open.
        let _ = set_cache(-(CACHE_KIB as i32));
        merged
    }

    /// Compares the other file's chains of seals with the ones known here.
    ///
    /// # Errors
    /// A chain was rewritten.
    fn copy_of(&self, other: &Store) -> Result<Option<CopyOf>, StoreError> {
        const DOING: &str = "comparing seals";
        let look = || -> SqlResult<_> {
            let own = own_file_id(other.backend())?;
            let all = "SELECT DISTINCT origin FROM seal ORDER BY origin";
            let origins = (other.backend()).select(all, &[], |row| row.get::<Id>(0))?;
            let compare = |origin| {
                Ok((
                    origin,
                    compare_chains(other.backend(), self.backend(), origin)?,
                ))
            };
            let stand: SqlResult<Vec<_>> = origins.into_iter().map(compare).collect();
            Ok((own, stand?))
        };
        let (own, stand) = look().map_err(|error| other.failed(DOING, error))?;
        let mut copy = None;
        for (file, stands) in stand {
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
            // A row of theirs without its parent.
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

struct Merge<'a> {
    theirs: &'a Connection,
    ours: &'a Connection,
    /// `ours` again, as a backend.
    backend: &'a Backend,
    /// `theirs` again, as a backend.
    their_backend: &'a Backend,
    counts: MergeCounts,
    /// Runs added, or finished by this merge.
    fresh_runs: BTreeSet<i64>,
    /// Runs that were finished here before: nothing is added to them.
    sealed_runs: BTreeSet<i64>,
    /// Those of them that differ in the other file.
    different_runs: BTreeSet<i64>,
}

impl Merge<'_> {
    /// Parents before children, because children need their parents' new numbers.
    fn all(mut self) -> SqlResult<MergeCounts> {
        let before = self.before()?;
        let units = self.units()?;
        let runs = self.runs(&units)?;
        self.compare(&runs)?;
        self.counts.steps = self.children(&runs, &STEPS)?;
        self.counts.measurements = self.children(&runs, &MEASUREMENTS)?;
        self.children(&runs, &SCRIPTS)?;
        // Recordings come with their traces, even later: the run's seal covers them by digest.
        self.counts.recordings = self.add(&runs, &RECORDINGS, &BTreeSet::new())?;
        self.notes(&runs)?;
        let channel_sets = self.channel_sets()?;
        let traces = self.traces(&runs, &channel_sets)?;
        self.faults(&units, &runs, &traces)?;
        self.seals(before)?;
        self.seal_the_rest(before)?;
        Ok(self.counts)
    }
}
