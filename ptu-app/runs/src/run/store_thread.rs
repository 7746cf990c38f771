//! The writer: one thread owns the database. It stores the records of a run in order, and prints lines about
//! them once they are in the file.

mod beside;
mod records;
#[cfg(test)]
mod tests;

use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, SyncSender};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use fault_db::{Id, RunEnd, RunRecord, RunWriter, Store, StoreError};

use self::beside::{keep_beside, keep_rest};
pub(super) use self::records::Entry;
pub use self::records::LinePrinter;
use self::records::{RecordedIds, keep};
use crate::failure::{Failure, RunTrouble, Trouble, prevented_by};
use crate::stop::Stop;

/// Entries that may wait for the disk; beyond that the bench waits for the writer.
const QUEUE: usize = 4096;
/// Steps reach the file at least this often.
const FLUSH: Duration = Duration::from_millis(250);

/// How long a run under way waits for another writer: a run that gave up would lose all that is still to come, and while it
/// waits only the bench waits with it.
#[derive(Clone, Copy)]
struct BusyTimeout {
    /// After this time the bench is stopped: a unit is not driven for a run that may be lost.
    stops_ms: u32,
    /// After so long what was measured is kept in another file.
    gives_up: Duration,
}

const BUSY_TIMEOUT: BusyTimeout = BusyTimeout {
    stops_ms: 30_000,
    gives_up: Duration::from_secs(180),
};

/// The sender's side of the writer thread.
pub struct RunStore {
    entries: SyncSender<Entry>,
    thread: JoinHandle<Result<(Store, Option<Trouble>), Failure>>,
    /// The run's id.
    pub id: Id,
}

impl RunStore {
    /// Begins the run: its row is on the disk when this returns. Lines about the run go to `line_printer`. Should
    /// writing fail later, `stop` is pressed at once: a unit is not driven for a run that is not stored.
    ///
    /// # Errors
    /// The database does not take the run.
    pub fn begin(
        store: Store,
        record: RunRecord,
        line_printer: Option<LinePrinter>,
        stop: &Stop,
    ) -> Result<Self, Failure> {
        Self::begin_with(BUSY_TIMEOUT, store, record, line_printer, stop)
    }

    fn begin_with(
        busy_timeout: BusyTimeout,
        store: Store,
        record: RunRecord,
        line_printer: Option<LinePrinter>,
        stop: &Stop,
    ) -> Result<Self, Failure> {
        let (entries, receiver) = mpsc::sync_channel(QUEUE);
        let (begun, beginning) = mpsc::sync_channel(1);
        let stop = stop.clone();
        let thread = std::thread::Builder::new()
            .name("store".into())
            .spawn(move || {
                let mut kept = RecordedIds::default();
                kept.lines.line_printer = line_printer;
                let waits = (busy_timeout, &stop);
                let beside = write(&store, &record, &receiver, kept, &begun, waits)?;
                Ok(beside.map_or((store, None), |(store, lost)| (store, Some(lost))))
            })
            .map_err(|error| Failure::bench(RunTrouble::NoThread(error.to_string())))?;
        match beginning.recv() {
            Ok(id) => Ok(Self {
                entries,
                thread,
                id,
            }),
            Err(_) => Err(match thread.join() {
                Ok(Err(error)) => error,
                _ => Failure::bench(RunTrouble::WriterEnded),
            }),
        }
    }

    pub(super) fn record(&self, entry: Entry) {
        // A send fails only after the writer has ended with an error, which `finish` returns.
        let _ = self.entries.send(entry);
    }

    /// Ends the run and gives back the store that holds the run: the history, or the file beside, with a sentence that says
    /// why and where.
    ///
    /// # Errors
    /// The first error of writing.
    pub fn finish(self, end: RunEnd) -> Result<(Store, Option<Trouble>), Failure> {
        self.record(Entry::Finish(end));
        drop(self.entries);
        let ended = self.thread.join();
        ended.unwrap_or_else(|_| Err(Failure::bench(RunTrouble::WriterEnded)))
    }
}

fn write(
    store: &Store,
    record: &RunRecord,
    entries: &Receiver<Entry>,
    mut kept: RecordedIds,
    begun: &SyncSender<Id>,
    (busy_timeout, stop): (BusyTimeout, &Stop),
) -> Result<Option<(Store, Trouble)>, Failure> {
    // Nothing is lost yet: a file that is locked, or has two names, is refused at once.
    let mut writer = RunWriter::begin(store, record)?;
    store.set_busy_timeout_ms(busy_timeout.stops_ms)?;
    let _ = begun.send(writer.id());
    let result = write_entries(&mut writer, &mut kept, entries, (busy_timeout, stop));
    let Err((error, at_hand)) = result else {
        return Ok(None);
    };
    stop.press_because(prevented_by(&error));
    if !matches!(error, StoreError::Locked(_)) {
        kept.hold_all(at_hand.map(|entry| *entry).into_iter().chain(entries));
        return keep_beside((store, &writer), record, kept, Arc::new(error)).map(Some);
    }
    kept.before = kept.occurrences.len();
    let rest = keep_rest(&mut writer, kept, record, at_hand, entries);
    // Empties the queue so that no sender blocks.
    entries.iter().for_each(drop);
    Err(match rest {
        Some(rest) => {
            let error = Arc::new(error);
            Failure::bench(Trouble::RestKept { error, rest })
        }
        None => error.into(),
    })
}

/// Records all entries that come. An entry that the database did not take comes back with the error.
fn write_entries(
    writer: &mut RunWriter<'_>,
    kept: &mut RecordedIds,
    entries: &Receiver<Entry>,
    (busy_timeout, stop): (BusyTimeout, &Stop),
) -> Result<(), (StoreError, Option<Box<Entry>>)> {
    let mut flushed = Instant::now();
    loop {
        let entry = match entries.recv_timeout(FLUSH.saturating_sub(flushed.elapsed())) {
            Ok(entry) => Some(entry),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => {
                let done = retry_while_locked(busy_timeout, stop, |_| writer.flush());
                done.map_err(|error| (error, None))?;
                kept.lines.stored();
                return Ok(());
            }
        };
        if let Some(entry) = entry {
            let is_end = matches!(entry, Entry::Finish(_));
            let done = retry_while_locked(busy_timeout, stop, |again| {
                keep(writer, kept, &entry, again)
            });
            match done {
                Ok(()) if is_end => {
                    kept.lines.stored();
                    return Ok(());
                }
                Ok(()) => kept.hold(entry),
                Err(error) => return Err((error, Some(Box::new(entry)))),
            }
        }
        if flushed.elapsed() >= FLUSH {
            let done = retry_while_locked(busy_timeout, stop, |_| writer.flush());
            done.map_err(|error| (error, None))?;
            flushed = Instant::now();
        }
        if writer.waiting_steps() == 0 {
            kept.lines.stored();
        }
    }
}

/// Repeats the work until the file is free. A unit is not driven meanwhile for longer than a
/// moment.
fn retry_while_locked(
    busy_timeout: BusyTimeout,
    stop: &Stop,
    mut work: impl FnMut(bool) -> Result<(), StoreError>,
) -> Result<(), StoreError> {
    let begun = Instant::now();
    let mut again = false;
    loop {
        match work(again) {
            Err(error @ StoreError::Locked(_)) if begun.elapsed() < busy_timeout.gives_up => {
                stop.press_because(prevented_by(&error));
                again = true;
            }
            done => return done,
        }
    }
}
