//! One file's history into another's, as often as one likes: what is known by its id is not
//! added again.

mod examine;
mod faults;
mod rows;
mod runs;
mod same;
mod seals;

use std::collections::BTreeSet;
use std::path::Path;

use rusqlite::{Connection, ErrorCode};
use serde::Serialize;

use crate::base::{Base, SqlError, SqlResult};
use crate::domain::Refusals;
use crate::error::StoreError;
use crate::file::CACHE_KIB;
use crate::id::Id;
use crate::part::Part;
use crate::seal::own_name;
use crate::seal::parted::{Standing, standing};
use crate::store::{OpenOptions, Store};
use crate::sync::{Different, refusal};
use rows::{MEASUREMENTS, RECORDINGS, SCRIPTS, STEPS};

/// What a merge added, and what it did not.
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
    /// Runs that are over here and there and do not say the same; here they were left as they are.
    pub different: Vec<Different>,
    /// The other file is a copy of a file whose chain of seals is known here.
    pub copy: Option<CopyOf>,
    /// Rows of the other file that hold what no history holds, and runs that do not fit their seals: they were
    /// left out, with what hangs on them.
    pub refused: Refusals,
}

/// What another file is a copy of.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct CopyOf {
    /// The name both have.
    pub file: Id,
    /// The last entry of its chain of seals that both have.
    pub after: i64,
    /// It went on by itself after that; else it is from before.
    pub went_on: bool,
}

impl Store {
    /// Adds all that the other file has and this one has not, in one transaction. A run that is over here stays
    /// as it is: it is sealed. If the other file tells it otherwise, it is named.
    pub fn import(&self, from: &Path) -> Result<MergeCounts, StoreError> {
        let same = |path: &Path| std::fs::canonicalize(path).ok();
        if same(from).is_some() && same(from) == same(self.path()) {
            return Err(StoreError::SameFile {
                path: from.to_path_buf(),
            });
        }
        // Opening checks that its schema is the same as ours, and lets its own SQL do nothing.
        let other = Store::open_read_only(from)?;
        match other.strangers()?.into_iter().next() {
            Some(what) => Err(StoreError::Altered {
                path: from.to_path_buf(),
                what,
            }),
            None => self.merge_from(&other),
        }
    }

    /// Adds all that this file has to another one, which is created if need be.
    pub fn export(&self, to: &Path, options: OpenOptions) -> Result<MergeCounts, StoreError> {
        if !to.exists() {
            Part::can_be_made(to)?;
        }
        let target = Store::open(to, options)?;
        let counts = target.merge_from(self)?;
        target.close()?;
        Ok(counts)
    }

    /// Adds all that the other store has and this one has not, in one transaction.
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
        // One reading transaction, so that all tables are seen at the same moment.
        let begin = theirs.execute_batch("BEGIN");
        begin.map_err(|error| other.failed(DOING, error))?;
        let aside = examine::put_aside(theirs, other.base(), self.base());
        let aside = aside.map_err(|error| self.blame(other, error));
        let merged = aside.and_then(|refused| {
            let copy = self.copy_of(other)?;
            // Indexes are filled all over at once; a larger part of them than usual has to be at hand.
            set_cache(CACHE)?;
            self.write(DOING, |ours| {
                Merge {
                    theirs,
                    ours,
                    base: self.base(),
                    their_base: other.base(),
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
                .map_err(|error| self.blame(other, error))
            })
        });
        let _ = examine::take_away(theirs);
        let _ = theirs.execute_batch("COMMIT");
        // It costs memory only as long as this store is open.
        let _ = set_cache(-(CACHE_KIB as i32));
        merged
    }

    /// Holds the other file's chains of seals against what is known of them here.
    ///
    /// # Errors
    /// Its history was rewritten.
    fn copy_of(&self, other: &Store) -> Result<Option<CopyOf>, StoreError> {
        const DOING: &str = "comparing seals";
        let look = || -> SqlResult<_> {
            let own = own_name(other.base())?;
            let all = "SELECT DISTINCT origin FROM seal ORDER BY origin";
            let origins = (other.base()).select(all, &[], |row| row.get::<Id>(0))?;
            let compare = |origin| Ok((origin, standing(other.base(), self.base(), origin)?));
            let stand: SqlResult<Vec<_>> = origins.into_iter().map(compare).collect();
            Ok((own, stand?))
        };
        let (own, stand) = look().map_err(|error| other.failed(DOING, error))?;
        let mut copy = None;
        for (file, stands) in stand {
            let (after, went_on) = match stands {
                Standing::Rewritten { .. } => return Err(refusal(other.path(), &stands)),
                Standing::Parted { after } => (after, true),
                Standing::Behind { here, .. } => (here, false),
                Standing::Continued { .. } => continue,
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

    /// Names the file that is to blame for what went wrong.
    fn blame(&self, other: &Store, error: SqlError) -> StoreError {
        const DOING: &str = "merging";
        let SqlError::File(error) = error else {
            return self.failed(DOING, error);
        };
        match error.sqlite_error_code() {
            // A row of theirs without the one it belongs to.
            Some(ErrorCode::ConstraintViolation) => StoreError::Corrupt {
                path: other.path().to_path_buf(),
                detail: error.to_string(),
            },
            // A value that is not of its column's kind.
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

/// SQLite's page cache while merging, and else, in KiB; SQLite wants sizes negative, as pages are not.
const CACHE: i32 = -(64 << 10);

struct Merge<'a> {
    theirs: &'a Connection,
    ours: &'a Connection,
    /// The same as `ours`, for what is asked of a server as well.
    base: &'a Base,
    /// The same as `theirs`.
    their_base: &'a Base,
    counts: MergeCounts,
    /// Runs added, or ended meanwhile.
    fresh_runs: BTreeSet<i64>,
    /// Runs that were over here before: nothing is added to what they say.
    sealed_runs: BTreeSet<i64>,
    /// Those of them that are told otherwise there.
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
        // It comes and goes with its traces: a run's seal says what it was.
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
