//! Distributes work to threads; the result does not depend on their number.

use std::sync::Mutex;
use std::sync::MutexGuard;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use crate::stop::Stop;

/// Interval at which progress is reported.
const TELL: Duration = Duration::from_millis(100);

/// Threads this machine runs at once.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Does `work` for 0 .. `count` on `jobs` threads and gives results in order of their numbers,
/// telling how many there are now and then. After a stop nothing new is begun.
pub fn run<T: Send>(
    count: usize,
    jobs: usize,
    stop: &Stop,
    tell: &mut dyn FnMut(usize),
    work: impl Fn(usize) -> T + Sync,
) -> Vec<(usize, T)> {
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let results = Mutex::new(Vec::with_capacity(count));
    let worker = || {
        let mut mine = Vec::new();
        while stop.may_begin() {
            let i = next.fetch_add(1, Ordering::Relaxed);
            if i >= count {
                break;
            }
            mine.push((i, work(i)));
            done.fetch_add(1, Ordering::Relaxed);
        }
        if let Ok(mut results) = results.lock() {
            results.append(&mut mine);
        }
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..jobs.clamp(1, count.max(1)))
            .map(|_| scope.spawn(worker))
            .collect();
        while !workers.iter().all(|worker| worker.is_finished()) {
            tell(done.load(Ordering::Relaxed));
            std::thread::park_timeout(if count > jobs {
                TELL
            } else {
                Duration::from_millis(1)
            });
        }
    });
    tell(done.load(Ordering::Relaxed));
    let mut results = results.into_inner().unwrap_or_default();
    results.sort_by_key(|(i, _)| *i);
    results
}

/// Locks a mutex even if a thread panicked while holding it: the data are consistent at any time.
pub fn held<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_in_order_for_any_number_of_threads() {
        for jobs in [1, 3, 50] {
            let results = run(40, jobs, &Stop::default(), &mut |_| {}, |i| i * i);
            assert_eq!(results, (0..40).map(|i| (i, i * i)).collect::<Vec<_>>());
        }
    }

    #[test]
    fn after_a_stop_nothing_is_begun() {
        let stop = Stop::default();
        let results = run(1000, 1, &stop, &mut |_| {}, |i| {
            if i == 4 {
                stop.press();
            }
            i
        });
        assert_eq!(results.len(), 5);
    }
}
