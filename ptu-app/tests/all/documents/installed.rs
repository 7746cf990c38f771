//! Command lines of code blocks as an ordinary user has them after an installation: a copy of the program alone, an empty
//! folder, a home of its own, and no repository around.
//!
//! `cargo test --workspace --test all documents::installed -- --nocapture` prints all of them with their exit codes.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use super::command_line::CommandLine;
use super::{Block, Document, RUN, SHOWN, none, root};
use crate::common::{Place, Said, install, text};
use fuzzing::draw;
use serde_json::Value;

/// Lines that are read and not run, by a part of the line, with the reason.
const NOT_RUN: [(&str, &str); 20] = [
    ("serial:", "a unit on a port"),
    ("tcp:", "a unit on a network"),
    ("lockstep:", "a unit on a port"),
    ("ptu record ", "what a unit on a port has recorded"),
    ("postgres", "a server"),
    ("ato-under-test ", "serves until it is stopped"),
    ("ptu train ", "serves until it is stopped"),
    ("ptu signal devices", "a sound card"),
    ("ptu signal play ", "a sound card"),
    ("ptu signal record ", "a sound card"),
    ("ptu signal calibrate ", "a sound card"),
    ("ptu campaign", "hours, or what others counted in hours"),
    ("--monte-carlo ", "hours"),
    (
        "ptu run --signals sampled ",
        "the suite by samples takes minutes; `sampled` has parts of it",
    ),
    ("sbatch", "a cluster"),
    ("sudo ", "root"),
    ("apt install ", "root"),
    ("duckdb ", "a program of others"),
    ("cargo ", "the sources"),
    (" scripts/", "the sources"),
];
/// Files that a reader has before: name and content.
const GIVEN: [(&str, &str); 2] = [("pin.txt", "739156\n"), ("noisy.toml", "noise_mv = 1.0\n")];
/// PIN for commands that ask for one at a terminal.
const PIN: &str = "739156";

/// Where an installed program is used.
struct Installed {
    place: Place,
}

impl Installed {
    fn new() -> Self {
        let place = Place::new();
        for folder in ["bin", "home", "work"] {
            fs::create_dir(place.path(folder)).expect("a folder");
        }
        install(&place.path("bin/ptu"));
        for (name, content) in GIVEN {
            place.write(&format!("work/{name}"), content);
        }
        Self { place }
    }

    fn says(&self, line: &str) -> Said {
        let system = ["/usr/bin", "/bin"].map(PathBuf::from);
        let path = [self.place.path("bin")].into_iter().chain(system);
        let mut command = Command::new("sh");
        command
            .args(["-c", line])
            .current_dir(self.place.path("work"))
            .stdin(std::process::Stdio::null())
            .env_clear()
            .env("PATH", std::env::join_paths(path).expect("no colons"))
            .env("HOME", self.place.path("home"))
            .env("PTU_PIN", PIN)
            .env("LANG", "C.UTF-8");
        Said::from(command.output().expect("a shell"))
    }
}

/// The line with an id of this reader for each of the document: of the trace, or of the runs, one after the other.
fn with_ids(line: &str, runs: &[String]) -> String {
    let is_id = |word: &&str| {
        let has = |is: fn(&char) -> bool| word.chars().any(|c| is(&c));
        word.len() >= 4
            && word.chars().all(|c| c.is_ascii_hexdigit())
            && has(char::is_ascii_digit)
            && has(char::is_ascii_alphabetic)
    };
    let mut runs = runs.iter().map(String::as_str);
    let mut id = || match line.starts_with("ptu trace") {
        true => "latest",
        false => runs.next().unwrap_or("latest"),
    };
    let mut words = Vec::new();
    for word in line.split(' ') {
        // What stands behind an option is no id: `--older-than 365d`.
        let is_value = words
            .last()
            .is_some_and(|before: &&str| before.starts_with("--"));
        words.push(if is_id(&word) && !is_value {
            id()
        } else {
            word
        });
    }
    words.join(" ")
}

/// Runs the lines of blocks one after the other; what is wrong with them.
#[allow(
    clippy::print_stdout,
    reason = "the table of what was run, with --nocapture"
)]
fn run(document: &Document, blocks: &[Block<'_>], installed: &Installed) -> Vec<String> {
    let mut wrong = Vec::new();
    let runs = installed.says("ptu runs list --json").out;
    let runs: Vec<Value> = serde_json::from_str(&runs).unwrap_or_default();
    let runs: Vec<String> = (runs.iter().rev())
        .map(|run| text(&run["id"]).to_owned())
        .collect();
    for block in document
        .blocks()
        .iter()
        .filter(|block| block.info == "toml")
    {
        // A file that a document shows whole, its name in the first line: the reader has it.
        let name = (block.lines.first()).and_then(|(_, line)| line.strip_prefix("# "));
        if let Some(name) = name.filter(|name| name.ends_with(".toml")) {
            let lines: Vec<_> = block.lines.iter().map(|(_, line)| *line).collect();
            (installed.place).write(&format!("work/{name}"), &lines.join("\n"));
        }
    }
    let lines = blocks.iter().flat_map(|block| &block.lines);
    for (number, line) in lines {
        let place = document.at(*number);
        let is_window = line.trim() == "ptu";
        if line.trim().is_empty() {
            continue;
        }
        let words = format!(" {line}");
        if let Some((_, why)) = NOT_RUN.iter().find(|(part, _)| words.contains(part)) {
            println!("{place}: {line}: not run, {why}");
            continue;
        }
        if is_window {
            println!("{place}: {line}: not run, a window");
            continue;
        }
        let begun = std::time::Instant::now();
        let said = installed.says(&with_ids(line, &runs));
        let took = begun.elapsed().as_secs_f64();
        println!("{place}: {line}: exit {:?} in {took:.1} s", said.code);
        if said.code != Some(CommandLine::of(line).exit) || said.err.contains("panicked") {
            wrong.push(format!("{place}: {line}\n{}", said.all()));
        }
    }
    wrong
}

/// Documents changed by the last commit or since, and one in three of the others.
fn drawn(guides: Vec<Document>) -> Vec<Document> {
    let mut git = Command::new("git");
    git.args(["diff", "--name-only", "HEAD~1"])
        .current_dir(root());
    let changed = git
        .output()
        .map_or_else(|_| String::new(), |said| Said::from(said).out);
    let is_changed = |guide: &Document| changed.lines().any(|name| root().join(name) == guide.path);
    let (mut all, others): (Vec<_>, Vec<_>) = guides.into_iter().partition(is_changed);
    all.extend(draw::drawn(others, 3));
    all
}

/// Goal: a reader types what a document says, and it works. Method: a block marked to be run works by itself; the others
/// of a document follow each other, after a run that found a fault and one that found none. A check runs a part.
#[test]
fn every_command_line_of_the_documents_works_from_an_installed_program() {
    let guides = drawn(Document::guides());
    let wrong = std::sync::Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for document in &guides {
            let wrong = &wrong;
            scope.spawn(move || {
                let blocks = document.blocks().into_iter();
                let blocks = blocks.filter(|block| matches!(block.info, RUN | SHOWN));
                let (alone, following): (Vec<_>, Vec<_>) =
                    blocks.partition(|block| block.info == RUN);
                for block in alone {
                    let found = run(document, &[block], &Installed::new());
                    wrong.lock().expect("no panic").extend(found);
                }
                if following.is_empty() {
                    return;
                }
                let installed = Installed::new();
                let begin = "ptu run atp/overspeed";
                installed
                    .says(&format!("{begin} --inject eb_relay.slow"))
                    .exits(1);
                installed.says(begin).exits(0);
                let found = run(document, &following, &installed);
                wrong.lock().expect("no panic").extend(found);
            });
        }
    });
    none(&wrong.into_inner().expect("no panic"));
}
