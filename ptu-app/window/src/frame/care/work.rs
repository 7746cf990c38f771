//! Work on the fault history that its dialog begins, on a thread of its own.

use std::path::{Path, PathBuf};

use fault_db::{Address, Store, StoreError, SyncOptions};

use crate::PageContext;
use crate::parts::{Done, Job, Told};
use ptu_report::care::{self, Said};
use ptu_report::words::{Words, fill};
use ptu_runs::clock;
use ptu_runs::failure::{Failure, FileTrouble};
use ptu_runs::platform::computer_name;

/// Exchanges the history with a server.
pub fn sync(job: &mut Job, context: &mut PageContext<'_>, address: Address, traces: bool) {
    let words = context.words;
    let said = (words.care.connecting.to_owned(), words.care.failed);
    job.begin(context, said, move |paths, told| {
        let store = paths.open()?;
        let server = Store::connect(&address, clock::ids())?;
        let mut options = SyncOptions {
            laptop: &computer_name(),
            traces,
            as_copy: false,
            now_us: &clock::now_us,
            go_on: &mut |progress| {
                told.say(care::progress(progress, words));
                told.stop.presses() == 0
            },
        };
        let outcome = store.sync(&server, &mut options);
        let outcome = outcome.map_err(of_copy)?;
        store.close()?;
        Ok(done(care::synced(&outcome, words)))
    });
}

/// Adds the entries of another database file.
pub fn import(job: &mut Job, context: &mut PageContext<'_>, file: PathBuf) {
    let words = context.words;
    let shown = file.display().to_string();
    let said = fill(words.care.importing, &[("file", &shown)]);
    job.begin(context, (said, words.care.failed), move |paths, told| {
        let store = stopped_by(told, paths.open()?)?;
        let counts = match store.import(&file) {
            Err(StoreError::Stopped) => return Ok(stopped(words)),
            done => done.map_err(|error| of_file(&file, error))?,
        };
        // The imported rows are stored: from here on the work cannot be stopped.
        store.stop_when(|| false)?;
        // Conflicts are told only if the import added events; older conflicts were told before.
        let conflicts = match counts.events {
            0 => Vec::new(),
            _ => store.conflicts()?,
        };
        store.close()?;
        Ok(done(care::imported(&counts, &conflicts, words)))
    });
}

/// Copies the history to a file.
pub fn backup(job: &mut Job, context: &mut PageContext<'_>, file: PathBuf) {
    let words = context.words;
    let shown = file.display().to_string();
    let said = fill(words.care.backing_up, &[("file", &shown)]);
    job.begin(context, (said, words.care.failed), move |paths, told| {
        match stopped_by(told, paths.read()?)?.backup(&file) {
            Err(StoreError::Stopped) => return Ok(stopped(words)),
            done => done.map_err(|error| of_file(&file, error))?,
        }
        // The chain's head is read from the copy: another program may have added to the original meanwhile.
        let head = Store::open_read_only(&file)?.head()?;
        let text = fill(words.care.backed_up, &[("file", &shown)]);
        let notes = head.map(|head| care::chain(&head, words));
        Ok(Done::all(text, notes.into_iter().collect()))
    });
}

/// Checks the history for damage and for later changes.
pub fn check(job: &mut Job, context: &mut PageContext<'_>) {
    let words = context.words;
    let said = (words.care.checking.to_owned(), words.care.failed);
    job.begin(context, said, move |paths, told| {
        let store = match paths.is_server() {
            true => paths.read()?,
            false => stopped_by(told, paths.read()?)?,
        };
        match store.check() {
            Err(StoreError::Stopped) => Ok(stopped(words)),
            report => Ok(done(care::checked(&report?, words))),
        }
    });
}

/// The store, whose work ends when a person stops it.
fn stopped_by(told: &Told, store: Store) -> Result<Store, StoreError> {
    let stop = told.stop.clone();
    store.stop_when(move || stop.presses() > 0)?;
    Ok(store)
}

/// Result of work that was stopped before it stored anything.
fn stopped(words: &Words) -> Done {
    Done::all(words.care.nothing_done.to_owned(), Vec::new())
}

/// Turns an error about the file that the person named into a failure.
fn of_file(file: &Path, error: StoreError) -> Failure {
    let shown = file.display().to_string();
    match &error {
        StoreError::Missing(path) if path == file => Failure::bench(FileTrouble::Missing(shown)),
        StoreError::TargetExists(_) => Failure::bench(FileTrouble::Exists(shown)),
        _ => error.into(),
    }
}

/// Turns an error of a replication into a failure.
fn of_copy(error: StoreError) -> Failure {
    match error {
        StoreError::EarlierCopy { .. } | StoreError::ForkedCopy { .. } => {
            Failure::bench(FileTrouble::IsCopy)
        }
        _ => error.into(),
    }
}

fn done(said: Said) -> Done {
    Done::all(said.text, said.notes)
}
