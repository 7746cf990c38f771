//! A history, what is done to it, and how one sees that nothing is lost that was told.

use std::path::{Path, PathBuf};
use std::process::Command;

use fault_db::Store;
use ptu_runs::clock;
use rusqlite::{Connection, OpenFlags};

use crate::common::{Place, record_bad_unit_anew};

/// Steps of the run, each of which fails and is told.
const STEPS: usize = 20;
/// Beginning of the line that tells of a failed step.
const TOLD_STEP: &str = "failed  fails: ";
/// Rows that may only become more, or, where something is deleted, fewer.
const ROWS: [&str; 8] = [
    "SELECT count(*) FROM run",
    "SELECT count(*) FROM run WHERE verdict IS NOT NULL",
    "SELECT count(*) FROM step WHERE verdict = 'failed'",
    "SELECT count(*) FROM fault_occurrence",
    "SELECT count(*) FROM fault_event",
    "SELECT count(*) FROM run_note",
    "SELECT count(*) FROM trace",
    "SELECT count(*) FROM seal",
];
const FAILED_STEPS: usize = 2;

/// Number of each of the [`ROWS`] in a file.
pub type Rows = [i64; ROWS.len()];

/// A place with a history of some runs, and a second file to be imported.
pub struct Base(Place);

impl Base {
    pub fn new() -> Self {
        let place = Place::new();
        let record = || {
            record_bad_unit_anew(&place);
            place
                .ptu("faults repair latest --part eb_relay --who Kim")
                .exits(0);
            place.ptu("run atp/overspeed --serial-no BAD-1").exits(0);
            record_bad_unit_anew(&place);
        };
        record();
        std::fs::rename(place.path("history.db"), place.path("other.db")).expect("renamed");
        record();
        let mut script = String::from("procedure(title = \"Alarm\", suspect = \"-\")\n");
        for step in 0..STEPS {
            script +=
                &format!("step(\"{step}\", expect = becomes(alarm, True, within = ms(100)))\n");
        }
        place.write("fails.star", &script);
        Self(place)
    }

    /// A place of its own with the same files.
    pub fn copy(&self) -> Place {
        let place = Place::new();
        for name in ["history.db", "other.db", "fails.star"] {
            std::fs::copy(self.0.path(name), place.path(name)).expect("copied");
        }
        place
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path(name)
    }
}

/// Something that a technician does to a history, and what is there before and after it.
pub struct Victim {
    pub name: &'static str,
    arguments: &'static [&'static str],
    /// The file that it writes.
    file: &'static str,
    pub exit_code: i32,
    before: Rows,
    after: Rows,
}

/// Commands: name, arguments, the file that is written, the exit code.
const DEEDS: [(&str, &[&str], &str, i32); 8] = [
    ("run", &["run", "fails.star"], "history.db", 1),
    (
        "note",
        &["runs", "note", "latest", "a note", "--who", "Kim"],
        "history.db",
        0,
    ),
    (
        "repair",
        &[
            "faults", "repair", "latest", "--part", "eb_relay", "--who", "Kim",
        ],
        "history.db",
        0,
    ),
    ("import", &["db", "import", "other.db"], "history.db", 0),
    (
        "prune",
        &["db", "prune", "--older-than", "2999-01"],
        "history.db",
        0,
    ),
    ("rebuild", &["db", "rebuild"], "history.db", 0),
    ("backup", &["db", "backup", "copy.db"], "copy.db", 0),
    ("export", &["db", "export", "copy.db"], "copy.db", 0),
];

/// All that is done, tried once without disturbance.
pub fn victims(base: &Base) -> Vec<Victim> {
    let victim = |(name, arguments, file, exit_code)| {
        let place = base.copy();
        let mut victim = Victim {
            name,
            arguments,
            file,
            exit_code,
            before: rows(&place.path(file)).unwrap_or_default(),
            after: Rows::default(),
        };
        let output = victim.command(&place).output().expect("ptu starts");
        assert_eq!(output.status.code(), Some(exit_code), "{name}: {output:?}");
        assert!(!output.stdout.is_empty(), "{name} says what it did");
        victim.after = rows(&place.path(file)).expect("a history");
        let changes = victim.before != victim.after || name == "rebuild";
        assert!(changes, "{name} does something");
        victim
    };
    DEEDS.into_iter().map(victim).collect()
}

impl Victim {
    /// The program that does it in this place; with whole names of files, as system calls are to show them.
    pub fn command(&self, place: &Place) -> Command {
        let whole = |argument: &&str| match argument.contains(".db") {
            true => place.text_path(argument),
            false => (*argument).to_owned(),
        };
        let arguments: Vec<_> = self.arguments.iter().map(whole).collect();
        place.command(&arguments.iter().map(String::as_str).collect::<Vec<_>>())
    }

    /// Errors in the files of a folder in which the program ended before its time, after it had printed
    /// this.
    pub fn judge(&self, folder: &Path, out: &str, err: &str) -> Vec<String> {
        let mut wrong = Vec::new();
        for name in ["history.db", "other.db", "copy.db"] {
            let file = folder.join(name);
            if file.exists() {
                wrong.extend(
                    problems(&file)
                        .into_iter()
                        .map(|problem| format!("{name}: {problem}")),
                );
            }
        }
        let steps = err
            .lines()
            .filter(|line| line.starts_with(TOLD_STEP))
            .count() as i64;
        let mut least = match out.trim().is_empty() {
            true => self.before,
            false => self.after,
        };
        least[FAILED_STEPS] = least[FAILED_STEPS].max(self.before[FAILED_STEPS] + steps);
        let file = folder.join(self.file);
        let has = match rows(&file) {
            Ok(has) => has,
            Err(_) if !file.exists() && least == Rows::default() => return wrong,
            Err(error) => return vec![error],
        };
        for (((has, least), after), what) in has.iter().zip(least).zip(self.after).zip(ROWS) {
            if !(least.min(after)..=least.max(after)).contains(has) {
                wrong.push(format!(
                    "{what}: {has}, {least} were told and {after} come at most"
                ));
            }
        }
        wrong
    }
}

/// Findings of the history's own check in a file, opened as the next program opens it.
fn problems(file: &Path) -> Vec<String> {
    let checked = Store::open(file, clock::open_options()).and_then(|store| store.check());
    match checked {
        Ok(report) => report
            .problems
            .iter()
            .map(|problem| format!("{problem:?}"))
            .collect(),
        Err(error) => vec![error.to_string()],
    }
}

fn rows(file: &Path) -> Result<Rows, String> {
    let told = |error: rusqlite::Error| error.to_string();
    let conn =
        Connection::open_with_flags(file, OpenFlags::SQLITE_OPEN_READ_WRITE).map_err(told)?;
    let mut rows = Rows::default();
    for (count, sql) in rows.iter_mut().zip(ROWS) {
        *count = conn.query_row(sql, [], |row| row.get(0)).map_err(told)?;
    }
    Ok(rows)
}
