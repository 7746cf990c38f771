//! Watches the database file: tells when a program has written to it, and when it is gone.
//!
//! The watch looks at size and time of the file and its write-ahead log. An open connection would hold a lock and keep
//! other programs from work that needs the file exclusively.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::time::{Duration, SystemTime};

use super::data_paths::{DataPaths, beside};
use ptu_runs::bench_worker::Wake;
use ptu_runs::failure::{Failure, RunTrouble};
use ptu_runs::platform::identity;

/// Interval at which the file is looked at.
const LOOK: Duration = Duration::from_secs(1);

/// Number of intervals after which a server counts as changed: a server does not tell when it was written to.
const ASK_AGAIN: u32 = 60;

#[derive(Default)]
struct Seen {
    changes: AtomicU64,
    gone: AtomicBool,
}

/// Handle of the thread that watches the database; the thread ends when the handle is dropped.
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

    /// Number of times that a change of the database was seen.
    pub fn changes(&self) -> u64 {
        self.seen.changes.load(Ordering::Relaxed)
    }

    /// The database existed and is gone.
    pub fn is_gone(&self) -> bool {
        self.seen.gone.load(Ordering::Relaxed)
    }
}

/// Identity, size and time of the last change of the database file and of its log.
#[derive(PartialEq, Eq)]
struct Stamp([Option<(u64, u64, Option<SystemTime>)>; 2]);

impl Stamp {
    fn of(database: &Path) -> Self {
        let of = |path: &Path| {
            let found = std::fs::metadata(path).ok()?;
            // An empty log does not count: a reader creates and removes one.
            (found.len() > 0).then(|| (identity(&found), found.len(), found.modified().ok()))
        };
        Self([of(database), of(&beside(database, "-wal"))])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: reading does not count as a change, or the window would read for ever. Method: the stamp before and after
    /// a reader, and after a writer.
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
