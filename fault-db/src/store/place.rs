//! Checks that other programs find the store's open file at its name, with all that was recorded in it.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rusqlite::config::DbConfig;

use super::Store;
use crate::error::{FileChange, StoreError};
use crate::files::databases::with_end;
use crate::files::platform::Identity;
use crate::id::Id;
use crate::seal::{SealHead, hash_of, hex, sealed_as};
use crate::store::atomic_file::AtomicFile;

/// Time limit of looking through the whole file; the rows of the run are read without one.
const LOOK: Duration = Duration::from_millis(200);

impl Store {
    /// Checks that the names of file and log still lead to the opened ones, and that the file has no other name.
    ///
    /// # Errors
    /// [`StoreError::FileChanged`] with what has happened to the file or its log.
    pub fn check_place(&self) -> Result<(), StoreError> {
        let Some(opened) = self.identity else {
            return Ok(());
        };
        let what = match Identity::at(&self.path) {
            None => FileChange::Removed,
            Some(now) if !opened.is_same(&now) => FileChange::Replaced,
            Some(now) if now.names > 1 && self.has_second_name() => FileChange::SecondName,
            Some(_) if self.has_lost_its_log() => FileChange::NoLog,
            Some(_) => return Ok(()),
        };
        Err(self.file_changed(what))
    }

    /// Whether the file still has another name once temporary names left by killed programs are removed.
    fn has_second_name(&self) -> bool {
        AtomicFile::remove_left(&self.path);
        Identity::at(&self.path).is_some_and(|now| now.names > 1)
    }

    fn has_lost_its_log(&self) -> bool {
        let is_same = |opened: &Identity| {
            Identity::at(&log_of(&self.path)).is_some_and(|now| opened.is_same(&now))
        };
        self.log.as_ref().is_some_and(|opened| !is_same(opened))
    }

    fn file_changed(&self, what: FileChange) -> StoreError {
        StoreError::FileChanged {
            path: self.path.clone(),
            what,
        }
    }

    /// Checks that another program finds an ended run under the store's name: the run with all its steps, and the chain
    /// of seals as it ended when the run began.
    ///
    /// # Errors
    /// The reason why not. From then on, closing the file writes nothing of the log back.
    pub(crate) fn check_holds(
        &self,
        run: Id,
        began: Option<&SealHead>,
        steps: Option<usize>,
    ) -> Result<(), StoreError> {
        self.or_keep_log_back(self.holds(run, began, steps))
    }

    /// Returns `held`; if it is an error, closing the file no longer writes the log back: a removed log would overwrite
    /// what other programs have written since.
    pub(super) fn or_keep_log_back(&self, held: Result<(), StoreError>) -> Result<(), StoreError> {
        if held.is_err() {
            let no_checkpoint = DbConfig::SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE;
            let kept = self.file()?.set_db_config(no_checkpoint, true);
            kept.map_err(|error| self.failed("closing", error))?;
        }
        held
    }

    fn holds(
        &self,
        run: Id,
        began: Option<&SealHead>,
        steps: Option<usize>,
    ) -> Result<(), StoreError> {
        self.check_place()?;
        let found = Self::open_read_only(&self.path)?;
        let is_there = || -> Result<bool, StoreError> {
            if let Some(began) = began {
                let hash = found.ask("comparing chains of seals", |file| {
                    hash_of(file, began.file, began.entries)
                })?;
                if hash.is_none_or(|hash| hex(&hash) != began.seal) {
                    return Ok(false);
                }
            }
            let there = found.run(run)?;
            let sealed = found.ask("reading the seal of a run", |file| sealed_as(file, run))?;
            let is_whole = |steps| sealed.is_some() && there.steps.len() == steps;
            Ok(there.run.verdict.is_some() && steps.is_none_or(is_whole) && found.looks_sound()?)
        };
        match is_there()? {
            true => self.check_place(),
            false => Err(self.file_changed(FileChange::WrittenOver)),
        }
    }

    /// Checks as much of the file for damage as [`LOOK`] allows.
    fn looks_sound(&self) -> Result<bool, StoreError> {
        let until = Instant::now() + LOOK;
        self.stop_when(move || Instant::now() > until)?;
        let looked = self
            .file()?
            .query_row("PRAGMA quick_check(1)", [], |row| row.get::<_, String>(0));
        match looked.map_err(|error| self.failed("checking", error)) {
            Err(StoreError::Stopped) => Ok(true),
            said => Ok(said? == "ok"),
        }
    }
}

/// The write-ahead log of a file: beside the file itself, whatever links lead to it.
pub(super) fn log_of(path: &Path) -> PathBuf {
    let real = std::fs::canonicalize(path);
    with_end(real.as_deref().unwrap_or(path), "-wal")
}
