//! A file of runs while it is written.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use fault_db::{open_regular_file, read_regular_file};
use serde::de::{DeserializeOwned, IgnoredAny};

use super::Head;
use super::record::{Found, head_record, in_order};
use crate::failure::{Failure, KeepTrouble, Why};
use crate::new_file::kind;
use crate::stdio;
use crate::whole_file;

/// A file has at most this many bytes: some twenty thousand runs of the suite.
pub(super) const MOST_BYTES: u64 = 1 << 30;

/// A file of runs, open at its end.
pub(super) struct RunsFile {
    path: PathBuf,
    /// The open file, and the first error of writing to the file.
    state: Mutex<(File, Option<Failure>)>,
}

impl RunsFile {
    /// Reads a file, which is made if it is not there, and opens it for more runs: the runs by their names, and the file.
    /// Damage in the file is reported.
    ///
    /// # Errors
    /// The file cannot be read or written, another process writes it, it is a file of another kind, or it holds runs
    /// of another program or other scripts.
    pub fn open<R: DeserializeOwned>(
        path: &Path,
        head: &Head,
    ) -> Result<(BTreeMap<String, R>, Self), Failure> {
        let wrong = |why| Failure::usage(KeepTrouble::Unusable(path.display().to_string(), why));
        if path.exists() {
            // Refuses a device or pipe.
            open_regular_file(path).map_err(|error| wrong(Why::of(error)))?;
        }
        let mut options = OpenOptions::new();
        let options = options.read(true).write(true).create(true).truncate(false);
        let mut file = options.open(path).map_err(|error| wrong(Why::of(error)))?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => return Err(wrong(Why::OtherWriter)),
            // A file system without locks.
            Err(TryLockError::Error(_)) | Ok(()) => {}
        }
        let mut bytes = Vec::new();
        let read = Read::by_ref(&mut file)
            .take(MOST_BYTES + 1)
            .read_to_end(&mut bytes);
        read.map_err(|error| wrong(Why::of(error)))?;
        if bytes.len() as u64 > MOST_BYTES {
            return Err(wrong(Why::MoreBytes(MOST_BYTES)));
        }
        let first = head_record(head);
        // A program was killed while it wrote its first record.
        let is_new = bytes.len() < first.len() && first.starts_with(&bytes);
        let found = match is_new {
            true => None,
            false => Some(Found::<R>::read(&bytes).map_err(|why| wrong(Why::Said(why)))?),
        };
        if let Some(why) = found
            .as_ref()
            .and_then(|found| head.other_maker(&found.head))
        {
            return Err(wrong(Why::Said(why)));
        }
        for told in found.iter().flat_map(|found| &found.told) {
            stdio::note(&format!("{}: {told}", path.display()));
        }
        let end = found.as_ref().map_or(0, |found| found.end);
        let ready = file
            .set_len(end as u64)
            .and_then(|()| file.seek(SeekFrom::End(0)));
        ready.map_err(|error| wrong(Why::of(error)))?;
        if found.as_ref().is_none_or(|found| found.head != *head) {
            file.write_all(&first)
                .map_err(|error| wrong(Why::of(error)))?;
        }
        let runs = found.map(|found| found.runs).unwrap_or_default();
        let runs = runs.into_iter().map(|(name, (run, _))| (name, run));
        let file = Self {
            path: path.to_owned(),
            state: Mutex::new((file, None)),
        };
        Ok((runs.collect(), file))
    }

    /// Appends the record of a run, so that a program that is killed loses no other run. False once writing has failed.
    pub fn append(&self, record: &[u8]) -> bool {
        let Ok(mut state) = self.state.lock() else {
            return false;
        };
        let (file, failure) = &mut *state;
        if failure.is_none()
            && let Err(error) = file.write_all(record)
        {
            *failure = Some(Failure::bench(KeepTrouble::Unwritten(
                self.path.display().to_string(),
                error.to_string(),
            )));
        }
        failure.is_none()
    }

    /// The first error of writing, if there was one.
    pub fn take_failure(&self) -> Option<Failure> {
        self.state.lock().ok()?.1.take()
    }

    /// Puts the file's runs in order, now that all are there.
    ///
    /// # Errors
    /// The file cannot be read or written.
    pub fn put_in_order(&self, head: &Head) -> Result<(), Failure> {
        let cannot = |why: &dyn Display| {
            Failure::bench(KeepTrouble::Unordered(
                self.path.display().to_string(),
                why.to_string(),
            ))
        };
        let bytes = read_regular_file(&self.path, MOST_BYTES).map_err(|error| cannot(&error))?;
        let found = Found::<IgnoredAny>::read(&bytes).map_err(|error| cannot(&error))?;
        let runs = found.runs.iter();
        let ordered = in_order(head, runs.map(|(name, (_, at))| (name, &bytes[at.clone()])));
        if ordered != bytes {
            whole_file::write(&self.path, kind::RUNS, ordered)?;
        }
        Ok(())
    }
}
