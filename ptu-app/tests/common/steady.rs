//! Whether the machine let the tests run: a test in real time that fails while a processor stood still
//! has found nothing, and is made again.
//!
//! A virtual machine's processors are held up by its host, at times for longer than a unit bears to hear
//! nothing. Unit, tester and the system's own part of a pseudo-terminal run on different ones, so that
//! neither end can tell that the other was held up. One thread on each processor can.

#![allow(clippy::print_stderr, reason = "says why a test proves nothing here")]

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{Mutex, OnceLock};
use std::thread::{available_parallelism, sleep};
use std::time::{Duration, Instant};

use rustix::thread::{CpuSet, sched_setaffinity};

/// How often a processor is looked at.
const PERIOD: Duration = Duration::from_millis(5);
/// A hold-up that may matter: two of them after one another and the time between two frames are what a
/// unit bears.
const MATTERS: Duration = Duration::from_millis(60);
/// A test that keeps failing on a machine that keeps being held up is made so often at least, and until
/// so much time has gone.
const ATTEMPTS: usize = 8;
const ATTEMPTED: Duration = Duration::from_secs(10 * 60);
/// The machine is steady again when nothing was held up for so long.
const STEADY: Duration = Duration::from_secs(5);
/// After this time it will not become steadier.
const PATIENCE: Duration = Duration::from_secs(60);

/// The last hold-up that mattered: when it ended.
fn last() -> &'static Mutex<Option<Instant>> {
    static LAST: OnceLock<Mutex<Option<Instant>>> = OnceLock::new();
    LAST.get_or_init(|| {
        let processors = available_parallelism().map_or(1, usize::from);
        for processor in 0..processors {
            std::thread::spawn(move || look_at(processor));
        }
        Mutex::new(None)
    })
}

fn look_at(processor: usize) {
    let mut only = CpuSet::new();
    only.set(processor);
    // Where it is refused, the thread looks at whichever processor it is on.
    let _ = sched_setaffinity(None, &only);
    let mut before = Instant::now();
    loop {
        sleep(PERIOD);
        let now = Instant::now();
        if now - before > MATTERS {
            *last().lock().expect("no thread panics with it") = Some(now);
        }
        before = now;
    }
}

/// Whether a processor was held up since then.
fn held_up_since(began: Instant) -> bool {
    // What holds a processor up now is known when it goes on.
    sleep(2 * PERIOD);
    last()
        .lock()
        .expect("no thread panics with it")
        .is_some_and(|at| at >= began)
}

/// Waits until nothing has been held up for a while.
fn wait_until_steady() {
    let began = Instant::now();
    while began.elapsed() < PATIENCE && held_up_since(Instant::now() - STEADY) {
        sleep(Duration::from_millis(100));
    }
}

/// Makes a test in real time; again if it fails while a processor was held up.
pub fn steadily(test: impl Fn()) {
    let first_began = Instant::now();
    for attempt in 1.. {
        let began = Instant::now();
        held_up_since(began);
        let Err(panic) = catch_unwind(AssertUnwindSafe(&test)) else {
            return;
        };
        let may_repeat = attempt < ATTEMPTS || first_began.elapsed() < ATTEMPTED;
        if !may_repeat || !held_up_since(began) {
            resume_unwind(panic);
        }
        eprintln!("the machine was held up: attempt {attempt} proves nothing");
        wait_until_steady();
    }
}
