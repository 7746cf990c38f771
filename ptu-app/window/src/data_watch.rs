//! Follows the database file: says when another program has written to it, and when it is gone.
//!
//! Only the file and its write-ahead log are looked at, by size and time. A connection kept open for this would hold a
//! lock, and keep other programs from what they need the file for alone.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::time::{Duration, SystemTime};

use super::data_paths::{DataPaths, beside};
use ptu_runs::bench_worker::Wake;
use ptu_runs::failure::{Failure, RunTrouble};
use ptu_runs::platform::identity;

/// Time between two looks.
const LOOK: Duration = Duration::from_secs(1);

/// Looks after which a server is asked again: it does not say when somebody has written to it.
const ASK_AGAIN: u32 = 60;

#[derive(Default)]
struct Seen {
    changes: AtomicU64,
    gone: AtomicBool,
}

/// The thread that looks; it ends when this is dropped.
pub struct DataWatch {
    seen: Arc<Seen>,
    _ends_when_dropped: Sender<()>,
}

impl DataWatch {
    /// Starts the thread; `wake` is called when something has changed, and only then.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn new(paths: DataPaths, wake: Wake) -> Result<Self, Failure> {
        let seen = Arc::<Seen>::default();
        let (sender, ended) = mpsc::channel::<()>();
        let told = seen.clone();
        std::thread::Builder::new()
            .name("database".into())
            .spawn(move || {
                let mut before = Stamp::of(&paths.database);
                let mut looks = 0;
                while ended.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
                    let now = Stamp::of(&paths.database);
                    let gone = paths.is_gone();
                    looks += 1;
                    let is_old = paths.is_server() && looks % ASK_AGAIN == 0;
                    let was_gone = told.gone.swap(gone, Ordering::Relaxed);
                    if now != before || gone != was_gone || is_old {
                        before = now;
                        told.changes.fetch_add(1, Ordering::Relaxed);
                        wake();
                    }
                }
            })
            .map_err(|error| Failure::bench(RunTrouble::NoThread(error.to_string())))?;
        Ok(Self {
            seen,
            _ends_when_dropped: sender,
        })
    }

    /// Counts the times it was seen to be another than before.
    pub fn changes(&self) -> u64 {
        self.seen.changes.load(Ordering::Relaxed)
    }

    /// The history was there and is no longer.
    pub fn is_gone(&self) -> bool {
        self.seen.gone.load(Ordering::Relaxed)
    }
}

/// Identity of the file and its log, with the time of the last change.
#[derive(PartialEq, Eq)]
struct Stamp([Option<(u64, u64, Option<SystemTime>)>; 2]);

impl Stamp {
    fn of(database: &Path) -> Self {
        let of = |path: &Path| {
            let found = std::fs::metadata(path).ok()?;
            // A reader makes an empty log, and takes it away.
            (found.len() > 0).then(|| (identity(&found), found.len(), found.modified().ok()))
        };
        Self([of(database), of(&beside(database, "-wal"))])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: reading is no change, or the window would read for ever. Method: the stamp before and after a reader, and
    /// after a writer.
    #[test]
    fn a_reader_leaves_the_stamp_and_a_writer_does_not() {
        let folder = tempfile::tempdir().expect("a folder");
        let database = folder.path().join("history.db");
        let options = ptu_runs::clock::open_options;
        fault_db::Store::open(&database, options())
            .expect("made")
            .close()
            .expect("closed");
        let before = Stamp::of(&database);
        drop(fault_db::Store::open_read_only(&database).expect("read"));
        assert!(Stamp::of(&database) == before);
        let store = fault_db::Store::open(&database, options()).expect("open");
        drop(fault_db::Store::open_read_only(&database).expect("read"));
        let open = Stamp::of(&database);
        drop(fault_db::Store::open_read_only(&database).expect("read"));
        assert!(Stamp::of(&database) == open);
        let conn = rusqlite::Connection::open(&database).expect("open");
        conn.execute_batch("PRAGMA user_version = 8")
            .expect("written");
        assert!(Stamp::of(&database) != open);
        drop(store);
    }
}
