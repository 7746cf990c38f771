//! One count of a run on every surface: different steps, each once, of all that were due.

use std::collections::BTreeMap;

use quick_junit::Report;
use serde_json::Value;

use crate::common::served::{Running, Unit};
use crate::common::{Place, list, text};

/// A few procedures for a run that is broken off.
const SEVERAL: [&str; 3] = ["atp/overspeed", "twc/exchange", "tcms/link"];

/// What the rows of a run and its list of steps say, counted here.
#[derive(Debug, Default, PartialEq)]
struct Counted {
    planned: usize,
    passed: usize,
    failed: usize,
    error: usize,
    attempts: usize,
    outside: usize,
}

impl Counted {
    fn of(steps: &[Value], planned: usize) -> Self {
        let mut worst: BTreeMap<(&str, &str), usize> = BTreeMap::new();
        let mut counted = Self {
            planned,
            ..Self::default()
        };
        for step in steps {
            let verdict = text(&step["verdict"]);
            let rank = ["skipped", "passed", "error", "failed"];
            let rank = rank.iter().position(|known| *known == verdict);
            // Stopped, or a search that was not enough, is an error here.
            let rank = rank.unwrap_or(2);
            if step["kind"] != "step" {
                counted.outside += usize::from(rank > 1);
                continue;
            }
            counted.attempts += usize::from(rank > 0);
            let name = text(&step["name"]);
            let repetition = name.rfind(" (").filter(|at| name[*at..].contains('/'));
            let name = &name[..repetition.unwrap_or(name.len())];
            let known = worst.entry((text(&step["procedure"]), name)).or_default();
            *known = rank.max(*known);
        }
        let of = |rank| worst.values().filter(|worst| **worst == rank).count();
        (counted.passed, counted.error, counted.failed) = (of(1), of(2), of(3));
        counted
    }

    fn run(&self) -> usize {
        self.passed + self.failed + self.error
    }

    fn short(&self) -> String {
        match self.planned - self.run() {
            0 => self.planned.to_string(),
            _ => format!("{} of {}", self.run(), self.planned),
        }
    }

    fn sentence(&self) -> String {
        let (run, of, bad) = (self.run(), self.planned, self.failed + self.error);
        let mut said = match (of - run, bad) {
            (0, 0) => format!("{of} steps"),
            (0, _) => format!("{bad} of {of} steps did not pass"),
            (left, 0) => format!("{run} of {of} steps run, all passed; {left} not run"),
            (left, _) => format!("{run} of {of} steps run, {bad} did not pass; {left} not run"),
        };
        if self.attempts > run {
            said += &format!("; {} attempts", self.attempts);
        }
        if self.outside > 0 {
            said += &format!("; outside steps: {}", self.outside);
        }
        said
    }
}

/// Holds every surface that tells of the latest run of a place to one count; `events` = the lines of its stream.
fn agree(place: &Place, events: &str, selection: &[&str], what: &str) -> Counted {
    let listed = place.json(&[&["run", "--list", "--json"], selection].concat());
    let planned = list(&listed).iter().map(|of| list(&of["steps"]).len());
    let shown = place.json(&["runs", "show", "latest", "--json"]);
    let counted = Counted::of(list(&shown["steps"]), planned.sum());
    let (short, sentence) = (counted.short(), counted.sentence());
    let keys = |of: &Value, names: [&str; 8]| {
        names.map(|name| of[name].as_u64().unwrap_or(u64::MAX) as usize)
    };
    let told = [
        counted.planned,
        counted.run(),
        counted.passed,
        counted.failed,
        counted.error,
        counted.planned - counted.run(),
        counted.attempts,
        counted.outside,
    ];
    let names = [
        "step_count",
        "steps_run",
        "steps_passed",
        "steps_failed",
        "steps_error",
        "steps_not_run",
        "step_attempts",
        "outside_steps",
    ];
    let runs = place.json(&["runs", "list", "--json"]);
    assert_eq!(keys(&shown["run"], names), told, "{what}: runs show --json");
    assert_eq!(keys(&runs[0], names), told, "{what}: runs list --json");
    let coverage = &shown["coverage"];
    assert_eq!(
        (&coverage["steps"], &coverage["run"]),
        (&told[0].into(), &told[1].into()),
        "{what}"
    );
    let last = events.lines().last().expect("a line");
    let last: Value = serde_json::from_str(last).expect("JSON");
    let names = [
        "steps",
        "run_steps",
        "passed",
        "failed",
        "error",
        "not_run",
        "attempts",
        "outside",
    ];
    assert_eq!(keys(&last, names), told, "{what}: events");

    let table = place.ptu(&["runs", "show", "latest"]).exits(0).out;
    assert!(
        table.contains(&format!("  {short} steps, ")),
        "{what}: {short}\n{table}"
    );
    if counted.run() < counted.planned {
        let first = table.lines().next().unwrap_or_default();
        assert!(first.contains(&sentence), "{what}: {sentence}\n{table}");
    }
    let row = place.ptu(&["runs", "list"]).exits(0).out;
    let row = row
        .lines()
        .nth(2)
        .or(row.lines().nth(1))
        .unwrap_or_default();
    assert!(
        row.contains(&format!("  {short}  ")),
        "{what}: {short}\n{row}"
    );
    let files = ["--out", "r.junit.xml", "--out", "r.html"];
    place
        .ptu(&[&["report", "latest"], &files[..]].concat())
        .exits(0);
    assert!(
        place.read("r.html").contains(&sentence),
        "{what}: {sentence} on the sheet"
    );
    let junit = place.read("r.junit.xml");
    let junit = Report::deserialize_from_str(&junit).expect("JUnit XML");
    assert!(
        junit
            .name
            .as_ref()
            .is_some_and(|name| name.as_str().contains(&sentence)),
        "{what}: {sentence}\n{:?}",
        junit.name
    );
    let not_passed = counted.failed + counted.error + counted.outside;
    assert_eq!(junit.failures + junit.errors, not_passed, "{what}: JUnit");
    let diagnosed = place.ptu(&["diagnose", "latest"]);
    if diagnosed.code == Some(0) {
        let said = format!(
            "{short} steps, {} not passed, ",
            counted.failed + counted.error
        );
        assert!(
            diagnosed.out.contains(&said),
            "{what}: {said}\n{}",
            diagnosed.out
        );
    }
    counted
}

/// Goal: whoever reads of a run reads one count. Method: runs of all kinds, each read on every surface that is text.
#[test]
fn every_surface_tells_the_same_count_of_a_run() {
    let good: &[&str] = &["twc/exchange"];
    let bad: &[&str] = &["atp/overspeed"];
    let slow: &[&str] = &["--inject", "eb_relay.slow"];
    let cases: [(&str, &[&str], &[&str]); 6] = [
        ("passed", good, &[]),
        ("failed", bad, slow),
        (
            "stopped by a failure",
            bad,
            &[slow, &["--stop-on-fail"]].concat(),
        ),
        ("adaptive", &[], &["--adaptive"]),
        ("repeated", good, &["--repeat", "3"]),
        (
            "repeated, failed",
            bad,
            &[slow, &["--repeat", "2"]].concat(),
        ),
    ];
    for (what, selection, more) in cases {
        let place = Place::new();
        let asked = [&["run", "--json"], selection, more].concat();
        let said = place.ptu(&asked);
        let counted = agree(&place, &said.out, selection, what);
        let attempts = counted.attempts > counted.run();
        assert_eq!(
            attempts,
            what == "adaptive" || what.starts_with("repeated"),
            "{counted:?}"
        );
        assert!(counted.run() > 0, "{what}: {counted:?}");
    }
}

/// Goal: a run that is broken off says what it came to and what is left. Method: a unit that goes, and a person who stops.
#[test]
fn a_run_that_is_broken_off_tells_one_count() {
    for what in ["link lost", "stopped"] {
        let place = Place::new();
        let mut unit = Unit::in_lock_step(&[]);
        let more = [&SEVERAL[..], &["--events", "e.jsonl"]].concat();
        let mut run = Running::start(&place, &unit, &more);
        run.recorded_steps(2);
        match what {
            "link lost" => unit.kill(),
            _ => run.interrupt(),
        }
        let said = run.finish();
        assert!(matches!(said.code, Some(3 | 130)), "{what}: {}", said.all());
        let counted = agree(&place, &place.read("e.jsonl"), &SEVERAL, what);
        let (run, of) = (counted.run(), counted.planned);
        assert!(0 < run && run < of, "{what}: {counted:?}");
        if what == "link lost" {
            let at = format!("link lost at step {run} of {of}; {} not run", of - run);
            let sheet = ["report", "latest", "--lang", "ko", "--out", "ko.html"];
            place.ptu(&sheet).exits(0);
            assert!(said.out.contains(&at), "{at}\n{}", said.all());
            assert!(place.read("r.html").contains(&at) && place.read("r.junit.xml").contains(&at));
            let korean = format!(
                "{of}개 단계 중 {run}번째에서 연결 끊김; {}개 미수행",
                of - run
            );
            assert!(place.read("ko.html").contains(&korean), "{korean}");
        }
    }
}
