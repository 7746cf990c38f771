//! Fuzzing for tests: feeds a reader of external bytes with damaged inputs and checks for no panic, no hang and bounded
//! memory. Also draws the part that a check tests ([`draw`]).
//!
//! The inputs are damaged copies of a corpus: sound examples, and inputs that once broke a reader, kept in
//! `tests/corpus/NAME/` of the reader's crate. Everything follows from a seed, so that a failure can be repeated.
//!
//! A check feeds a part of the usual number of inputs, and all of them with `CHECK_SEED=all`. `CAMPAIGN=N` feeds N
//! times the usual number ([`amount`]); `CAMPAIGN_SEED` sets another seed ([`seed`]).

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "says what a search for panics found"
)]

pub mod draw;
mod mutate;

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use mutate::Dice;

/// Longest time that a reader may take for one input.
const HANG: Duration = Duration::from_secs(10);
/// Interval at which the watch thread looks at the clock.
const LOOK: Duration = Duration::from_millis(500);
/// Memory that a reader may hold at a time, bytes.
const MOST_MEMORY: u64 = 512 << 20;
/// A check feeds one in this many of the damaged inputs.
const PART_OF_A_CHECK: u64 = 4;
/// Bytes of a failing input that are printed.
const SHOWN: usize = 200;

/// Number of inputs or runs of a test: the usual number, times the number in `CAMPAIGN`.
pub fn amount(of_the_check: u64) -> u64 {
    of_the_check * set("CAMPAIGN").unwrap_or(1)
}

/// Seed of what is drawn: `CAMPAIGN_SEED`, else 1.
pub fn seed() -> u64 {
    set("CAMPAIGN_SEED").unwrap_or(1)
}

fn set(name: &str) -> Option<u64> {
    std::env::var(name).ok().and_then(|text| text.parse().ok())
}

pub struct Fuzz {
    name: String,
    corpus: Vec<Vec<u8>>,
    longest: usize,
}

impl Fuzz {
    /// Test of the reader called `name`, with sound examples of what it reads. `manifest` is the folder of the crate
    /// whose `tests/corpus/NAME/` keeps the inputs that once broke the reader: `env!("CARGO_MANIFEST_DIR")`.
    ///
    /// # Panics
    /// There is no example, or a kept input cannot be read.
    pub fn new(
        name: &str,
        manifest: &str,
        examples: impl IntoIterator<Item = impl Into<Vec<u8>>>,
    ) -> Self {
        let mut corpus: Vec<Vec<u8>> = examples.into_iter().map(Into::into).collect();
        assert!(!corpus.is_empty(), "{name} has no example");
        let kept = Path::new(manifest).join("tests/corpus").join(name);
        let entries = std::fs::read_dir(kept).into_iter().flatten().flatten();
        let mut kept: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
        kept.sort();
        let read = |file| std::fs::read(file).expect("a kept input can be read");
        corpus.extend(kept.iter().map(read));
        let longest = corpus.iter().map(Vec::len).max().unwrap_or(0);
        Self {
            name: name.to_owned(),
            corpus,
            longest: 2 * longest + 64,
        }
    }

    /// Feeds the reader: first the corpus as it is, then `runs` damaged inputs, or in a check a part of them.
    ///
    /// # Panics
    /// The reader panicked, or took too much memory. Ends the process if the reader takes too long.
    pub fn run(self, runs: u64, mut read: impl FnMut(&[u8])) {
        let runs = match set("CAMPAIGN") {
            Some(times) => runs * times,
            None if draw::draws_all() => runs,
            None => runs.div_ceil(PART_OF_A_CHECK),
        };
        let seed = seed();
        let mut dice = Dice::new(seed, &self.name);
        let watch = Watch::begin(&self.name);
        let began = Instant::now();
        let mut input = Vec::new();
        let mut most_memory = 0;
        let corpus = self.corpus.len() as u64;
        for run in 0..corpus + runs {
            match usize::try_from(run).ok().and_then(|at| self.corpus.get(at)) {
                Some(example) => input.clone_from(example),
                None => dice.damaged(&self.corpus, self.longest, &mut input),
            }
            watch.begins(&input);
            let mut fed = Ok(());
            // Measures the memory of this thread alone: other tests of the program take memory, too.
            let taken = allocation_counter::measure(|| {
                fed = catch_unwind(AssertUnwindSafe(|| read(&input)));
            });
            watch.ends();
            if let Err(panic) = fed {
                eprintln!(
                    "{} panicked on run {run} of seed {seed}: {}",
                    self.name,
                    keep(&self.name, &input)
                );
                resume_unwind(panic);
            }
            most_memory = most_memory.max(taken.bytes_max);
            assert!(
                taken.bytes_max <= MOST_MEMORY,
                "{} took {} MB on run {run} of seed {seed}: {}",
                self.name,
                taken.bytes_max >> 20,
                keep(&self.name, &input)
            );
        }
        println!(
            "{}: {runs} runs in {:.1} s, at most {} kB at a time",
            self.name,
            began.elapsed().as_secs_f64(),
            most_memory >> 10
        );
    }
}

/// Writes an input that broke a reader to a file; returns the file's path and the input as text.
fn keep(name: &str, input: &[u8]) -> String {
    let file = std::env::temp_dir().join(format!("fuzz-{name}-{}.bin", std::process::id()));
    let kept = match std::fs::write(&file, input) {
        Ok(()) => format!(
            "kept as {}, to be put into tests/corpus/{name}/",
            file.display()
        ),
        Err(error) => format!("could not be kept: {error}"),
    };
    let shown = &input[..input.len().min(SHOWN)];
    format!(
        "{} bytes \"{}\"…; {kept}",
        input.len(),
        shown.escape_ascii()
    )
}

/// Memory of a process, kB: the value of `key`, as `VmRSS`, of process `self` or a number; 0 where it is not told.
pub fn memory_kb(process: &str, key: &str) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix(key)?.strip_prefix(':'));
    let number = line.and_then(|line| line.split_whitespace().next());
    number.and_then(|number| number.parse().ok()).unwrap_or(0)
}

/// Aborts the process, and keeps the input, when a reader takes too long: nothing else ends an endless loop.
struct Watch {
    current: Arc<Mutex<(Vec<u8>, Option<Instant>)>>,
    /// Ends the watch thread when the watch is dropped.
    _ends: Sender<()>,
}

impl Watch {
    fn begin(name: &str) -> Self {
        let current = Arc::new(Mutex::new((Vec::new(), None)));
        let (watched, name) = (Arc::clone(&current), name.to_owned());
        let (sender, ended) = mpsc::channel::<()>();
        std::thread::spawn(move || {
            while ended.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
                let current = watched.lock().unwrap_or_else(PoisonError::into_inner);
                let (input, since): &(Vec<u8>, Option<Instant>) = &current;
                if since.is_some_and(|since| since.elapsed() > HANG) {
                    eprintln!("{name} hangs: {}", keep(&name, input));
                    std::process::abort();
                }
            }
        });
        Self {
            current,
            _ends: sender,
        }
    }

    fn begins(&self, input: &[u8]) {
        let mut current = self.current.lock().unwrap_or_else(PoisonError::into_inner);
        current.0.clear();
        current.0.extend_from_slice(input);
        current.1 = Some(Instant::now());
    }

    fn ends(&self) {
        let mut current = self.current.lock().unwrap_or_else(PoisonError::into_inner);
        current.1 = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reader_that_breaks_is_found_and_the_same_seed_finds_it_again() {
        let found = || {
            let fuzz = Fuzz::new("reader", "no folder", ["speed = 12", "limit = [1, 2]"]);
            let mut runs = 0;
            let broke = catch_unwind(AssertUnwindSafe(|| {
                fuzz.run(100_000, |input| {
                    runs += 1;
                    assert!(!input.windows(2).any(|two| two == b"[["), "broken");
                });
            }));
            (runs, broke.is_err())
        };
        let (runs, broke) = found();
        assert!(broke && runs > 2, "{runs}");
        assert_eq!(found(), (runs, broke));
    }

    #[test]
    fn a_reader_that_takes_too_much_memory_is_found() {
        let fuzz = Fuzz::new("glutton", "no folder", ["speed = 12"]);
        let broke = catch_unwind(AssertUnwindSafe(|| {
            fuzz.run(1, |_| drop(Vec::<u8>::with_capacity(513 << 20)));
        }));
        let told = broke.expect_err("taken");
        let told = told.downcast_ref::<String>().map(String::as_str);
        assert!(
            told.is_some_and(|told| told.starts_with("glutton took 513 MB on run 0")),
            "{told:?}"
        );
    }
}
