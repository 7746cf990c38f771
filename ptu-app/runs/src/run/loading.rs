//! Scripts are loaded by a process of their own, which has hard limits: a few characters of the script language
//! can ask for more time, memory or stack than any machine has, and must not take the program with them.
//!
//! The process is this program again, with [`WORD`] as its only argument: what to load comes on its standard
//! input as JSON, and what was loaded goes out as lines of JSON.

use std::borrow::Cow;
use std::fmt::Display;
use std::io::{BufRead as _, BufReader, BufWriter, Read, Write as _};
use std::path::PathBuf;
use std::process::{Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use btu_rig::procedure::Procedure;
use btu_rig::procedure::loader::{self, LoadError, LoadEvent, Loaded, Scripts};
use btu_rig::train::TrainData;
use protocol::config::UnitConfig;
use protocol::line::Line;
use serde::{Deserialize, Serialize};

use crate::failure::{Failure, RunTrouble};
use crate::platform;

/// The word that makes the program load scripts and nothing else.
pub const WORD: &str = "load-scripts";

/// Processor time that all scripts together may take, s, with one more second for each
/// [`SCRIPTS_A_SECOND`] of them.
const MOST_TIME_S: u64 = 9;
/// See [`MOST_TIME_S`].
const SCRIPTS_A_SECOND: u64 = 50;
/// Permitted time by the clock over permitted processor time: the machine may have other work.
const BUSY: u32 = 6;
/// Memory that the process may take, MiB.
const MOST_MEMORY_MIB: u64 = 512;
/// Stack of the thread that evaluates scripts, bytes: scripts that nest and call as deep as they
/// may take a fraction of it.
const STACK: usize = 16 << 20;
/// Longest line of what is loaded, bytes: the plan of one procedure.
const LONGEST_LINE: u64 = 8 << 20;
/// Most that may be loaded in all, bytes of lines.
const MOST_LOADED: u64 = 256 << 20;
/// Lines that were read and not taken yet, at most.
const QUEUE: usize = 16;
/// Part of the last words of a broken-off process that is kept, bytes.
const LAST_WORDS: u64 = 64 << 10;

/// Scripts to load, and the configuration, line and train to load them for.
#[derive(Serialize, Deserialize)]
struct Order<'a> {
    scripts: Cow<'a, Scripts>,
    unit: Cow<'a, UnitConfig>,
    line: Cow<'a, Line>,
    train: Cow<'a, TrainData>,
}

/// Lines that the process prints.
#[derive(Serialize, Deserialize)]
enum LoaderLine<'a> {
    /// The process evaluates the script of this path from now on.
    Evaluates(Cow<'a, str>),
    Loaded(Box<Procedure>),
    Done {
        errors: Vec<LoadError>,
        need_cars: Vec<String>,
        printed: Vec<String>,
    },
}

static PROGRAM: OnceLock<PathBuf> = OnceLock::new();

/// From now on scripts are loaded by a process of `program`, which calls [`serve`] when it is started with [`WORD`].
/// Until then they are loaded in this process, as is good for scripts that are known.
pub fn load_apart(program: PathBuf) {
    // The first caller has set the same program.
    let _ = PROGRAM.set(program);
}

/// Loads scripts as [`loader::load`] does. A script that takes too much gives an error at its first line, and nothing
/// else is loaded then.
///
/// # Errors
/// No process can be had.
pub fn load(
    scripts: &Scripts,
    unit: &UnitConfig,
    line: &Line,
    train: &TrainData,
) -> Result<Loaded, Failure> {
    let Some(program) = PROGRAM.get() else {
        return Ok(loader::load(scripts, unit, line, train));
    };
    let order = Order {
        scripts: Cow::Borrowed(scripts),
        unit: Cow::Borrowed(unit),
        line: Cow::Borrowed(line),
        train: Cow::Borrowed(train),
    };
    let most_s = most_time_s(scripts);
    let mut command = Command::new(program);
    let mut child = platform::without_window(&mut command)
        .arg(WORD)
        .env("RUST_BACKTRACE", "0")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(cannot)?;
    let (Some(input), Some(output), Some(words)) =
        (child.stdin.take(), child.stdout.take(), child.stderr.take())
    else {
        return Err(cannot("it has no standard streams"));
    };
    std::thread::scope(|scope| {
        // A process that ends before it has read its order says why itself.
        scope.spawn(move || serde_json::to_writer(BufWriter::new(input), &order));
        let words = scope.spawn(move || last_words(words));
        let (sender, lines) = sync_channel(QUEUE);
        scope.spawn(move || read_lines(output, &sender));
        let heard = listen(&lines, most_s);
        drop(lines);
        if heard.is_err() {
            // The process may have ended by itself.
            let _ = child.kill();
        }
        let status = child.wait().map_err(cannot)?;
        let words = words.join().unwrap_or_default();
        match heard {
            Ok(loaded) => Ok(loaded),
            Err(Broken { at: None, .. }) => Err(cannot(reason(status, &words, most_s))),
            Err(Broken { at: Some(at), why }) => {
                let message = why.unwrap_or_else(|| reason(status, &words, most_s));
                Ok(Loaded {
                    errors: vec![LoadError {
                        file: at,
                        line: 1,
                        column: 1,
                        message,
                    }],
                    ..Loaded::default()
                })
            }
        }
    })
}

fn cannot(error: impl Display) -> Failure {
    Failure::bench(RunTrouble::NotLoadedApart(error.to_string()))
}

/// A process that broke off.
struct Broken {
    /// Path of the script that it evaluated.
    at: Option<String>,
    /// Why it was broken off; `None` if it ended by itself.
    why: Option<String>,
}

/// Takes what the process says until it is done.
fn listen(lines: &Receiver<Option<Vec<u8>>>, most_s: u64) -> Result<Loaded, Broken> {
    let until = Instant::now() + Duration::from_secs(most_s) * BUSY;
    let mut loaded = Loaded::default();
    let mut at = None;
    let mut bytes = 0;
    loop {
        let broken = |at, why: &str| {
            Err(Broken {
                at,
                why: Some(why.to_owned()),
            })
        };
        let line = match lines.recv_timeout(until.saturating_duration_since(Instant::now())) {
            Ok(Some(line)) => line,
            Ok(None) => return broken(at, "declares more than a procedure can hold"),
            Err(RecvTimeoutError::Timeout) => return broken(at, &too_long(most_s)),
            Err(RecvTimeoutError::Disconnected) => return Err(Broken { at, why: None }),
        };
        bytes += line.len() as u64;
        if bytes > MOST_LOADED {
            return broken(
                at,
                "the procedures up to here hold more than memory is meant for",
            );
        }
        match serde_json::from_slice(&line) {
            Ok(LoaderLine::Evaluates(path)) => at = Some(path.into_owned()),
            Ok(LoaderLine::Loaded(procedure)) => loaded.procedures.push(Arc::new(*procedure)),
            Ok(LoaderLine::Done {
                errors,
                need_cars,
                printed,
            }) => {
                return Ok(Loaded {
                    errors,
                    need_cars,
                    printed,
                    ..loaded
                });
            }
            Err(error) if error.to_string().starts_with("recursion limit") => {
                return broken(at, "declares conditions within conditions too deeply");
            }
            // Numbers that JSON cannot hold, such as NaN.
            Err(error) => return broken(at, &format!("what it declares cannot be used: {error}")),
        }
    }
}

/// Hands over line by line; `None` for a line that is too long.
fn read_lines(output: impl Read, lines: &SyncSender<Option<Vec<u8>>>) {
    let mut output = BufReader::new(output);
    loop {
        let mut line = Vec::new();
        let read = (&mut output)
            .take(LONGEST_LINE)
            .read_until(b'\n', &mut line);
        let line = match read {
            Ok(0) | Err(_) => return,
            Ok(_) if line.ends_with(b"\n") => Some(line),
            Ok(length) if length as u64 == LONGEST_LINE => None,
            // The process broke off within a line.
            Ok(_) => return,
        };
        let is_last = line.is_none();
        if lines.send(line).is_err() || is_last {
            return;
        }
    }
}

fn last_words(mut words: impl Read) -> String {
    let mut kept = Vec::new();
    // What cannot be read says nothing.
    let _ = (&mut words).take(LAST_WORDS).read_to_end(&mut kept);
    // The writer must not block on a full pipe.
    let _ = std::io::copy(&mut words, &mut std::io::sink());
    String::from_utf8_lossy(&kept).into_owned()
}

fn most_time_s(scripts: &Scripts) -> u64 {
    MOST_TIME_S + scripts.len() as u64 / SCRIPTS_A_SECOND
}

fn too_long(most_s: u64) -> String {
    format!("takes longer than {most_s} s to load; does a loop or a long text or list go too far?")
}

/// Sentence that says why a process broke off.
fn reason(status: ExitStatus, words: &str, most_s: u64) -> String {
    if platform::ended_by_time(status) {
        return too_long(most_s);
    }
    let said = |parts: &[&str]| parts.iter().any(|part| words.contains(part));
    if said(&["overflowed its stack"]) {
        return "holds values within values too deeply while it is loaded".into();
    }
    if said(&[
        "memory allocation of",
        "capacity overflow",
        "out of memory",
        "Out of memory",
    ]) {
        return format!(
            "needs more than {MOST_MEMORY_MIB} MB of memory while it is loaded; does a text or a list \
             go too far?"
        );
    }
    // The line before what a panic says names a place in a program, which does not help here.
    let mut lines = (words.lines()).filter(|line| !line.is_empty() && !line.starts_with("thread "));
    let first = lines.next().unwrap_or("nothing was said");
    format!("the script language broke off ({status}): {first}")
}

/// The loading process: loads the scripts that its standard input names, within its limits.
///
/// # Errors
/// Input is not understood, output is no longer read, or a limit cannot be set.
pub fn serve() -> Result<(), Failure> {
    platform::limit_memory(MOST_MEMORY_MIB << 20).map_err(cannot)?;
    let order = serde_json::from_reader(BufReader::new(std::io::stdin().lock()));
    let order: Order<'static> = order.map_err(cannot)?;
    let most_s = most_time_s(&order.scripts);
    platform::limit_time(most_s).map_err(cannot)?;
    let thread = std::thread::Builder::new().stack_size(STACK);
    let done = thread.spawn(move || say_all(&order));
    let done = done.map_err(cannot)?;
    match done.join() {
        Ok(said) => said.map_err(cannot),
        // The panic has said what it was.
        Err(_) => Err(cannot("it broke off")),
    }
}

#[expect(
    clippy::disallowed_methods,
    reason = "what another process of ours reads"
)]
fn say_all(order: &Order<'_>) -> std::io::Result<()> {
    let mut output = BufWriter::new(std::io::stdout().lock());
    let mut say = |said: &LoaderLine<'_>, at_once: bool| -> std::io::Result<()> {
        serde_json::to_writer(&mut output, said)?;
        output.write_all(b"\n")?;
        match at_once {
            true => output.flush(),
            false => Ok(()),
        }
    };
    let mut went_well = Ok(());
    let Order {
        scripts,
        unit,
        line,
        train,
    } = order;
    let loaded = loader::load_each(scripts, unit, line, train, &mut |told| {
        let done = match told {
            // This script may be the last thing that the process tells.
            LoadEvent::Evaluates(path) => say(&LoaderLine::Evaluates(Cow::Borrowed(path)), true),
            LoadEvent::Loaded(procedure) => say(&LoaderLine::Loaded(procedure), false),
        };
        if went_well.is_ok() {
            went_well = done;
        }
    });
    went_well?;
    say(
        &LoaderLine::Done {
            errors: loaded.errors,
            need_cars: loaded.need_cars,
            printed: loaded.printed,
        },
        true,
    )
}
