//! Hours of service, and a million steps, in one process: its memory stays what it was.

#![allow(
    clippy::print_stdout,
    reason = "figures, for whoever asks with --nocapture"
)]

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, Stdio};
use std::time::Instant;

use crate::common::{Place, number};

/// Sections of line 8.
const SECTIONS: u64 = 12;
/// Journeys over line 8 that take more than 8 hours of service together.
const ROUNDS: u64 = 20;
const HOURS: f64 = 8.0;
/// Procedures of which a repetition takes the tester little time, and how many steps one of each has.
const QUICK: [&str; 6] = [
    "ptu/identity",
    "tcms/driving_control",
    "tcms/emergency_line",
    "ptu/markers",
    "ptu/limit_speed",
    "tcms/power_cut",
];
const STEPS: u64 = 106;
/// A process's own memory; pages of its program's file come and go as the system has room for them.
const OWN: &str = "RssAnon";
/// Memory that caches, queues and the recorder's ring may still take after the first tenth, kB.
const FILLS_UP_KB: u64 = 16 << 10;
/// Steps that a run holds, to write them again should its file be lost, a kilobyte each; of a longer run none.
const HELD_STEPS: u64 = 100_000;

/// A process that says in a line that one thing more is done.
struct Followed {
    done: u64,
    /// After each tenth.
    memory_kb: Vec<u64>,
    last_line: String,
}

impl Followed {
    /// Follows what `child` says in `lines`; `amount` of them contain each of the words.
    fn follow(child: &Child, lines: impl Read, words: &[&str], amount: u64, last: &str) -> Self {
        let pid = child.id().to_string();
        let (mut done, mut memory_kb) = (0, Vec::new());
        let mut last_line = String::new();
        for line in BufReader::new(lines).lines() {
            let line = line.expect("text");
            done += u64::from(words.iter().all(|word| line.contains(word)));
            let tenths = memory_kb.len() as u64;
            if done * 10 >= amount * (tenths + 1) && tenths < 10 {
                memory_kb.push(fuzzing::memory_kb(&pid, OWN));
            }
            if line.contains(last) {
                last_line = line;
                break;
            }
        }
        Self {
            done,
            memory_kb,
            last_line,
        }
    }

    /// Tells what it was, and panics if memory grew by more than what fills up, and what is held on purpose. A process
    /// that has just ended has none.
    fn judge(&self, name: &str, held_kb: u64, began: Instant) {
        let took = began.elapsed().as_secs_f64();
        println!("{name}: {} done in {took:.1} s", self.done);
        for (tenth, kb) in self.memory_kb.iter().enumerate() {
            println!("  memory after {:>3} %, kB: {kb:>8}", 10 * (tenth + 1));
        }
        let told = self.memory_kb.iter().copied().filter(|&kb| kb > 0);
        let told: Vec<u64> = told.collect();
        assert!(told.len() >= 9, "{:?}", self.memory_kb);
        let most = told[0] + FILLS_UP_KB + held_kb;
        assert!(told.iter().all(|&kb| kb <= most), "{name}: {told:?}");
    }
}

/// Goal: a train may be in service for a day. Method: one process drives line 8 from end to end, again and again, with
/// the doors at each station.
#[test]
#[ignore = "long suite: runs for long"]
fn eight_hours_of_service_take_no_more_memory() {
    let rounds = fuzzing::amount(1).min(ROUNDS);
    let sections = rounds * SECTIONS;
    let service = vec!["all"; rounds as usize].join(",");
    let (place, began) = (Place::new(), Instant::now());
    let mut child = place
        .command(&["train", "--pty", "--service", &service])
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("ptu starts");
    let notes = child.stderr.take().expect("its notes");
    let words = ["stopped after", "doors opened and closed"];
    let followed = Followed::follow(&child, notes, &words, sections, "is over after");
    let mut cab = child.stdin.take().expect("a cab");
    // A service that broke off ends by itself.
    let _ = writeln!(cab, "quit");
    assert!(child.wait().expect("its end").success());
    assert_eq!(followed.done, sections, "{}", followed.last_line);
    let mut numbers = followed.last_line.split(' ').rev();
    let seconds: f64 = numbers
        .find_map(|word| word.parse().ok())
        .expect("how long it was");
    let hours = seconds / 3600.0;
    followed.judge(&format!("sections in {hours:.1} h of service"), 0, began);
    assert!(rounds < ROUNDS || hours >= HOURS, "{hours} h");
}

/// Goal: a bench may test for days. Method: one process repeats six procedures in one run, and records each step.
#[test]
#[ignore = "long suite: runs for long"]
fn a_million_steps_take_no_more_memory() {
    let repeat = fuzzing::amount(20);
    let steps = repeat * STEPS;
    let (place, began) = (Place::new(), Instant::now());
    let repeat = repeat.to_string();
    let arguments = [&["run", "--json", "--repeat", &repeat], &QUICK[..]].concat();
    let mut child = place
        .command(&arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("ptu starts");
    let events = child.stdout.take().expect("its events");
    let words = [r#""event":"step_finished""#, r#""verdict":"passed""#];
    let followed = Followed::follow(&child, events, &words, steps, r#""event":"run_finished""#);
    assert!(child.wait().expect("its end").success());
    assert_eq!(followed.done, steps);
    let run: serde_json::Value = serde_json::from_str(&followed.last_line).expect("an event");
    let hours = number(&run["bench_time_us"]) / 3.6e9;
    let held_kb = steps.min(HELD_STEPS) - (steps / 10).min(HELD_STEPS);
    let name = format!("steps in {hours:.1} h of bench time");
    followed.judge(&name, held_kb, began);
}
