//! Limits the time and the temporary disk space that a query may use.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::time::{Duration, Instant};

use ptu_report::words::tell;
use ptu_runs::failure::{Exit, Failure, KeepTrouble};

/// Interval at which the size of the temporary files is read.
const LOOK: Duration = Duration::from_millis(50);
/// Time after the limit in which an SQL function under way must return; else the program ends.
const GRACE: Duration = Duration::from_secs(1);
/// Beginning of the names of SQLite's temporary files.
const TEMPORARY: &str = "etilqs_";

/// The bounds of one query.
pub struct Watch {
    until: Instant,
    most_time: Duration,
    most_disk: u64,
    disk: Arc<AtomicBool>,
}

impl Watch {
    /// Bounds of a query that begins now.
    pub fn begin(most_time: Duration, most_disk: u64) -> Self {
        Self {
            until: Instant::now() + most_time,
            most_time,
            most_disk,
            disk: Arc::default(),
        }
    }

    /// Runs the query `ask`; the function it is given says whether it may go on. Ends the program if the query does not
    /// return: a query only reads, and its temporary files are nameless, so the system removes them.
    pub fn over<T>(&self, ask: impl FnOnce(Box<dyn FnMut() -> bool + Send>) -> T) -> T {
        let (until, most_time) = (self.until, self.most_time);
        let (done, waits) = mpsc::channel::<()>();
        std::thread::spawn(move || {
            let left = (until + GRACE).saturating_duration_since(Instant::now());
            if waits.recv_timeout(left) == Err(mpsc::RecvTimeoutError::Timeout) {
                let failure = Failure::usage(KeepTrouble::Time(most_time.as_secs()));
                tell(&failure);
                std::process::exit(Exit::Usage.code().into());
            }
        });
        let answer = ask(self.goes_on());
        drop(done);
        answer
    }

    fn goes_on(&self) -> Box<dyn FnMut() -> bool + Send> {
        let (until, most_disk) = (self.until, self.most_disk);
        let disk = Arc::clone(&self.disk);
        let mut look = Instant::now() + LOOK;
        Box::new(move || {
            let now = Instant::now();
            if now >= look {
                look = now + LOOK;
                if temporary_bytes() > most_disk {
                    disk.store(true, Ordering::Relaxed);
                    return false;
                }
            }
            now < until
        })
    }

    /// Whether the limit of disk space, not of time, stopped the query.
    pub fn stopped_by_disk(&self) -> bool {
        self.disk.load(Ordering::Relaxed)
    }
}

/// Size of SQLite's temporary files that this process has open, bytes; they have no name in any folder.
fn temporary_bytes() -> u64 {
    let open = std::fs::read_dir("/proc/self/fd").into_iter().flatten();
    let sizes = open.flatten().filter_map(|entry| {
        let path = entry.path();
        let name = std::fs::read_link(&path).ok()?;
        let is_temporary = Path::new(&name)
            .file_name()
            .is_some_and(|name| name.as_encoded_bytes().starts_with(TEMPORARY.as_bytes()));
        is_temporary.then(|| std::fs::metadata(&path).map_or(0, |about| about.len()))
    });
    sizes.sum()
}
