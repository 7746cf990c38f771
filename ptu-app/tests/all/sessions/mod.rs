//! Sessions: what is typed and all that the program answers, in the files beside this one, a place of its own for each.
//!
//! `SNAPSHOTS=overwrite` writes down what is answered now; read the difference before it is committed. A line is
//!
//! - `# …`: why; `@ bad unit`: the place has the history of [`record_bad_unit`]; `@ empty`: one without a run;
//! - `@ FILE SQL`: the history in this file is changed behind the program's back;
//! - `> FILE`, then `| …`: a file of the place;
//! - `$ ptu …`: a command; `{NAME}` stands for what an earlier answer was asked for;
//! - `% …`: a line for the shell, in which `ptu` is the program and its environment that of the place;
//! - `$ ptu … --json | /a/0/b NAME=/c/*/d`: of the answer what stands there, `*` for each of a list;
//! - `: …`: answered on stdout, `! …`: on stderr, `? 1`: an exit code other than 0;
//! - `...`: any lines, `[..]`: any text within one.

use std::collections::BTreeMap;
use std::path::PathBuf;

use regex::Regex;
use serde_json::Value;
use snapbox::{Assert, Data};

use crate::common::{Place, record_bad_unit, scripts, workspace};

/// Texts that differ from one time to the next.
const DIFFERS: [(&str, &str); 9] = [
    (
        "[ID]",
        "[0-9a-f]{8}-[0-9a-f]{4}-[0-9a-f]{4}-[0-9a-f]{4}-[0-9a-f]{12}",
    ),
    ("[SHORT]", r"\b[0-9a-f]{8}\b"),
    ("[HASH]", r"\b[0-9a-f]{64}\b"),
    ("$1[KEY]", r"((?:key|seal|technician) +|: )[0-9a-f]{16}\b"),
    (
        "[TIME]",
        r"20\d\d-\d\d-\d\d[T ]\d\d:\d\d(:\d\d(\.\d+)?)?(Z|[+-]\d\d:\d\d)?",
    ),
    ("[DAY]", r"20\d\d-\d\d-\d\d"),
    ("[MONTH]", r"\b20\d\d-(0[1-9]|1[0-2])\b"),
    ("[WALL]", r"\bin \d+\.\d+ s\b"),
    ("[WALL]", r"실제 \d+\.\d+ s\b"),
];

/// A test for each of these files.
macro_rules! sessions {
    ($($name:ident),* $(,)?) => {
        const ALL: &[&str] = &[$(stringify!($name)),*];
        $(#[test]
        fn $name() {
            play(stringify!($name));
        })*
    };
}

sessions! {
    bad_databases,
    bad_steps,
    bounded_questions,
    campaigns,
    catalogues,
    chosen_procedures,
    completions,
    defaults,
    departure,
    diagnoses,
    drive_reports,
    drives,
    first_steps,
    history,
    instruments,
    keys,
    korean,
    life_of_a_fault,
    life_of_a_part,
    matrices,
    merged,
    no_history,
    outputs,
    questions,
    repaired_and_back,
    replays,
    searches,
    shared_histories,
    sheets,
    signals,
    signed_runs,
    stale_dictionaries,
    symptoms,
    traces,
    train_faults,
    two_cases,
    undone,
    waveforms,
    wrong_campaigns,
    wrong_commands,
    wrong_data,
    wrong_drives,
    wrong_files,
    wrong_questions,
    wrong_scripts,
}

#[test]
fn every_file_is_played() {
    let files = std::fs::read_dir(folder()).expect("the folder of this file");
    let names = files.map(|file| file.expect("an entry").path());
    let texts = names.filter(|path| path.extension().is_some_and(|end| end == "txt"));
    for path in texts {
        let name = path.file_stem().and_then(|name| name.to_str());
        assert!(name.is_some_and(|name| ALL.contains(&name)), "{path:?}");
    }
}

fn folder() -> PathBuf {
    workspace().join("ptu-app/tests/all/sessions")
}

/// Types what the file has, and holds the program to its answers.
fn play(name: &str) {
    let path = folder().join(name).with_extension("txt");
    let written = std::fs::read_to_string(&path).expect("a session");
    let place = Place::new();
    let mut told = String::new();
    let scripts = scripts().display().to_string();
    let mut names = BTreeMap::from([("SCRIPTS".to_owned(), scripts)]);
    let mut file = None;
    for line in written.lines() {
        match line.split_at_checked(2).unwrap_or((line, "")) {
            (": " | ":" | "! " | "!" | "? ", _) => continue,
            _ if line == "..." => continue,
            ("@ ", "bad unit") => record_bad_unit(&place),
            ("@ ", "empty") => place.make_history(),
            ("@ ", change) => {
                let (file, sql) = change.split_once(' ').expect("a file and SQL");
                place.change(file, sql);
            }
            ("> ", name) => {
                place.write(name, "");
                file = Some(name);
            }
            ("| " | "|", text) => {
                let name = file.expect("a file");
                let before = place.read(name);
                place.write(name, &format!("{before}{text}\n"));
            }
            _ => {}
        }
        told += &format!("{line}\n");
        if line.starts_with("$ ptu ") || line.starts_with("% ") {
            told += &answer(&place, line, &mut names);
        }
    }
    let judge = Assert::new().action_env("SNAPSHOTS").normalize_paths(false);
    judge.eq(told, Data::read_from(&path, None));
}

/// Types one command, and gives the lines of its answer.
fn answer(place: &Place, line: &str, names: &mut BTreeMap<String, String>) -> String {
    let typed = line.strip_prefix("$ ptu ");
    let (command, asked) = match typed {
        Some(typed) => typed.split_once(" | ").unwrap_or((typed, "")),
        None => (&line[2..], ""),
    };
    let known =
        |text: &str, (name, value): (&String, &String)| text.replace(&format!("{{{name}}}"), value);
    let command = names
        .iter()
        .fold(command.to_owned(), |text, one| known(&text, one));
    let said = match typed {
        Some(_) => place.ptu(&command),
        None => place.shell(&command),
    };
    assert!(!said.err.contains("panicked"), "{}", said.all());
    let mut out = said.out;
    if !asked.is_empty() {
        let whole = serde_json::from_str(&out).expect("one JSON document on stdout");
        out = asked.split(' ').fold(String::new(), |told, path| {
            let (name, path) = path.split_once('=').unwrap_or(("", path));
            let found = at(&whole, path);
            if let (false, Value::String(value)) = (name.is_empty(), &found) {
                names.insert(name.to_owned(), value.clone());
            }
            format!("{told}{path} {found}\n")
        });
    }
    let mut told = String::new();
    for (mark, text) in [(':', out), ('!', said.err)] {
        for line in text.lines() {
            let gap = if line.is_empty() { "" } else { " " };
            told += &format!("{mark}{gap}{line}\n");
        }
    }
    if said.code != Some(0) {
        told += &format!("? {}\n", said.code.expect("an exit code"));
    }
    told = told.replace(&place.text_path(""), "[PLACE]/");
    for (name, value) in names {
        told = told.replace(value.as_str(), &format!("{{{name}}}"));
    }
    for (with, pattern) in DIFFERS {
        let pattern = Regex::new(pattern).expect("a pattern");
        told = pattern.replace_all(&told, with).into_owned();
    }
    told
}

/// Value at this path; of each element of a list where the path has `*`.
fn at(value: &Value, path: &str) -> Value {
    let Some((list, rest)) = path.split_once("/*") else {
        return value
            .pointer(path)
            .cloned()
            .unwrap_or_else(|| panic!("no {path} in {value}"));
    };
    let Value::Array(items) = at(value, list) else {
        panic!("no list {list} in {value}");
    };
    items.iter().map(|item| at(item, rest)).collect()
}
