//! The child process that carries samples: what it says, and its end.

use std::io::Read;
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use crate::failure::{Failure, RunTrouble, SoundTrouble, Why};
use crate::platform::shorten_pipe;
use crate::stop::Stop;

/// How often a request to stop is looked for.
const LOOK: Duration = Duration::from_millis(5);
/// Bytes that are kept of a line that the process says.
const LONGEST: usize = 300;

/// A running process that carries samples.
pub(super) struct Carried {
    child: Arc<Mutex<Child>>,
    pub(super) input: Option<ChildStdin>,
    pub(super) output: Option<ChildStdout>,
    /// How often the process had too few samples to play, or we took recorded ones too late.
    pub(super) gaps: Arc<AtomicU64>,
    last_words: Arc<Mutex<String>>,
    over: Arc<AtomicBool>,
}

impl Carried {
    /// Starts the process. When `stop` is pressed it is ended at once, whatever this thread waits for.
    pub(super) fn start(command: &mut Command, plays: bool, stop: &Stop) -> Result<Self, Failure> {
        let name = command.get_program().to_string_lossy().into_owned();
        Self::spawn(command, plays, stop)
            .map_err(|error| Failure::bench(RunTrouble::NotStarted(name, error.to_string())))
    }

    /// As [`Self::start`]; the error is what the system says.
    pub(super) fn spawn(command: &mut Command, plays: bool, stop: &Stop) -> std::io::Result<Self> {
        let pipe = |wanted: bool| {
            if wanted {
                Stdio::piped()
            } else {
                Stdio::null()
            }
        };
        let mut child = command
            .stdin(pipe(plays))
            .stdout(pipe(!plays))
            .stderr(Stdio::piped())
            .spawn()?;
        let (input, output) = (child.stdin.take(), child.stdout.take());
        if let Some(input) = &input {
            shorten_pipe(input);
        }
        let (gaps, last_words) = (Arc::<AtomicU64>::default(), Arc::<Mutex<String>>::default());
        if let Some(words) = child.stderr.take() {
            let (gaps, last_words) = (gaps.clone(), last_words.clone());
            std::thread::spawn(move || listen(words, &gaps, &last_words));
        }
        let carried = Self {
            child: Arc::new(Mutex::new(child)),
            input,
            output,
            gaps,
            last_words,
            over: Arc::default(),
        };
        let (child, over, stop) = (carried.child.clone(), carried.over.clone(), stop.clone());
        std::thread::spawn(move || {
            while !over.load(Ordering::Relaxed) {
                if stop.presses() > 0 {
                    end(&child);
                    return;
                }
                std::thread::sleep(LOOK);
            }
        });
        Ok(carried)
    }

    /// Closes the input of the process and waits until it has ended by itself.
    pub(super) fn wait(&mut self) {
        self.input = None;
        loop {
            let ended =
                (self.child.lock()).map_or(true, |mut child| !matches!(child.try_wait(), Ok(None)));
            if ended {
                return;
            }
            std::thread::sleep(LOOK);
        }
    }

    /// Last line in which the process said why it failed, once it has ended.
    pub(super) fn last_words(&mut self) -> Option<String> {
        self.wait();
        // The last line may still be on its way.
        std::thread::sleep(4 * LOOK);
        let words = self.last_words.lock().ok()?;
        Some(words.clone()).filter(|words| !words.is_empty())
    }

    /// Why the process ended, in its own words.
    pub(super) fn failed(&mut self, what: &'static str, device: &str) -> Failure {
        let why = self.last_words().map_or(Why::ProgramEnded, Why::Said);
        Failure::bench(SoundTrouble::Device(what, device.to_owned(), why))
    }
}

impl Drop for Carried {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        end(&self.child);
    }
}

fn end(child: &Mutex<Child>) {
    if let Ok(mut child) = child.lock() {
        // The process may have ended by itself.
        let _ = child.kill();
        let _ = child.wait();
    }
}

/// Counts the gaps that the process tells, and keeps the last line that tells a failure.
fn listen(mut words: ChildStderr, gaps: &AtomicU64, last: &Mutex<String>) {
    let mut buffer = [0; 512];
    let mut line = Vec::new();
    while let Ok(count @ 1..) = words.read(&mut buffer) {
        for byte in &buffer[..count] {
            if !matches!(byte, b'\n' | b'\r') {
                if line.len() < LONGEST {
                    line.push(*byte);
                }
                continue;
            }
            let said = String::from_utf8_lossy(&line).trim().to_owned();
            line.clear();
            let lower = said.to_ascii_lowercase();
            if lower.contains("underrun") || lower.contains("overrun") {
                gaps.fetch_add(1, Ordering::Relaxed);
                continue;
            }
            let tells_why = ["fail", "error", "refused"]
                .iter()
                .any(|word| lower.contains(word));
            if tells_why && let Ok(mut last) = last.lock() {
                *last = said;
            }
        }
    }
}
