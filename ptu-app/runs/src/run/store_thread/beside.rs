//! File beside the history for a run that the history does not hold at the end.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::Receiver;

use fault_db::{Id, RunRecord, RunWriter, Store, StoreError};

use super::records::{Entry, RecordedIds, keep};
use crate::clock;
use crate::failure::{Failure, Trouble};

/// Records the rest of a run in a file of its own, beside the history that stays busy; none if that fails, too.
pub(super) fn keep_rest(
    writer: &mut RunWriter<'_>,
    mut kept: RecordedIds,
    record: &RunRecord,
    at_hand: Option<Box<Entry>>,
    entries: &Receiver<Entry>,
) -> Option<PathBuf> {
    let path = beside(writer.path(), writer.id());
    let store = Store::open(&path, clock::open_options()).ok()?;
    let mut rest = writer.continue_in(&store, record).ok()?;
    for entry in at_hand
        .map(|entry| *entry)
        .into_iter()
        .chain(entries.iter())
    {
        // A step that was not written waits with the writer, which brought it here.
        keep(&mut rest, &mut kept, &entry, false)
            .or_else(|error| match error {
                StoreError::StepOrder { .. } => Ok(()),
                other => Err(other),
            })
            .ok()?;
        if matches!(entry, Entry::Finish(_)) {
            break;
        }
    }
    rest.flush().ok()?;
    kept.lines.stored();
    drop(rest);
    store.close().ok()?;
    Some(path)
}

/// Keeps a run that the history does not hold in a file beside it: returns that file, and what tells where and why.
///
/// # Errors
/// No such file can be made: the run is lost.
pub(super) fn keep_beside(
    (store, writer): (&Store, &RunWriter<'_>),
    record: &RunRecord,
    mut kept: RecordedIds,
    error: Arc<StoreError>,
) -> Result<(Store, Trouble), Failure> {
    let run = writer.id();
    let beside = beside(store.path(), run);
    let elsewhere = std::env::temp_dir().join(beside.file_name().unwrap_or_default());
    let made = [beside, elsewhere].into_iter().find_map(|path| {
        // A copy of the open file holds more than the run, if that file can be read still.
        let copied = match *error {
            StoreError::FileChanged { .. } => copy_with_run(store, run, &path),
            _ => None,
        };
        let made = copied.map(|copy| (copy, 0));
        let made = made.or_else(|| write_again((store, writer), record, &mut kept, &path))?;
        Some((path, made))
    });
    let (kept_in, made) = made.unzip();
    let (made, left_out) = made.unzip();
    let trouble = Trouble::NotStored {
        run,
        error,
        left_out: left_out.unwrap_or_default(),
        kept: kept_in,
    };
    let Some(made) = made else {
        return Err(Failure::bench(trouble));
    };
    kept.lines.stored();
    Ok((made, trouble))
}

/// A copy of the open file, if it holds the run whole.
fn copy_with_run(store: &Store, run: Id, path: &Path) -> Option<Store> {
    store.backup(path).ok()?;
    let copy = Store::open(path, clock::open_options()).ok();
    let is_whole = |copy: &Store| {
        let verified = copy.verify_run(run);
        verified.is_ok_and(|verified| verified.seal.is_some() && verified.changes.is_empty())
    };
    let copy = copy.filter(is_whole);
    if copy.is_none() {
        let _ = std::fs::remove_file(path);
    }
    copy
}

/// A new history with the run alone, from its records; and how many traces are missing there.
fn write_again(
    (store, writer): (&Store, &RunWriter<'_>),
    record: &RunRecord,
    kept: &mut RecordedIds,
    path: &Path,
) -> Option<(Store, usize)> {
    if path.exists() || kept.is_too_long() {
        return None;
    }
    let made = Store::open(path, clock::open_options()).ok()?;
    made.sign_with(store.signer());
    let mut again = writer.begin_again_in(&made, record).ok()?;
    let mut ids = RecordedIds::default();
    for entry in &kept.records {
        keep(&mut again, &mut ids, entry, false).ok()?;
    }
    again.flush().ok()?;
    drop(again);
    Some((made, kept.left_out))
}

/// The file beside a history in which a run of that history is kept.
fn beside(history: &Path, run: Id) -> PathBuf {
    let mut name = history.as_os_str().to_owned();
    name.push(format!(".run-{}.db", run.short()));
    PathBuf::from(name)
}
