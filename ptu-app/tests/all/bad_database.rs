//! A database that another writes, a disk that is full or read-only, a reader that is not there: what was recorded before
//! stays. `bad_databases` among the sessions has the rest.

#![allow(clippy::print_stderr, reason = "says why a test proves nothing here")]

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::{Place, Said};
use rusqlite::Connection;

#[test]
fn locked_by_another_writer() {
    let place = Place::new();
    let earlier = place.recorded_run();
    let other = Connection::open(place.path("history.db")).expect("the database");
    other.execute_batch("BEGIN EXCLUSIVE").expect("a lock");
    place.ptu("run tcms/link").exits(3).explains(&[
        "history.db is locked by another program",
        "close it",
        "--db",
    ]);
    assert_eq!(
        place.run_ids(),
        std::slice::from_ref(&earlier),
        "reading goes on"
    );
    other.execute_batch("ROLLBACK").expect("an end");
    place.ptu("run tcms/link").exits(0);
    assert_eq!(place.run_ids()[1], earlier);
}

/// Writers take turns: neither run is refused, and neither loses anything.
#[test]
fn two_runs_at_once_are_both_recorded() {
    let place = Place::new();
    place.recorded_run();
    let arguments = ["run", "tcms", "--inject", "rs485_link.receiver_errors"];
    let runs = [(); 2].map(|()| {
        let mut command = place.command(&arguments);
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command.spawn().expect("ptu starts")
    });
    for run in runs {
        Said::from(run.wait_with_output().expect("its output")).exits(1);
    }
    let runs = place.json("runs list --json");
    assert_eq!(crate::common::list(&runs).len(), 3);
    assert_eq!(runs[0]["state"], "finished");
    for key in ["verdict", "step_count", "steps_not_passed", "fault_count"] {
        assert_eq!(runs[0][key], runs[1][key], "{key}");
    }
    place.ptu("db check").exits(0);
}

/// A file system of its own, gone with the value.
struct Mounted<'a>(&'a Path);

impl<'a> Mounted<'a> {
    /// Mounts memory of this size, where that is permitted.
    fn new(at: &'a Path, options: &str) -> Option<Self> {
        std::fs::create_dir_all(at).expect("a folder");
        let output = Command::new("mount")
            .args(["-t", "tmpfs", "-o", options, "tmpfs"])
            .arg(at)
            .output();
        match output {
            Ok(output) if output.status.success() => Some(Self(at)),
            Ok(output) => {
                let why = String::from_utf8_lossy(&output.stderr);
                eprintln!("skipped, mounting is not permitted here: {}", why.trim());
                None
            }
            Err(error) => {
                eprintln!("skipped, no mount command: {error}");
                None
            }
        }
    }
}

impl Drop for Mounted<'_> {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.0).status();
    }
}

#[test]
fn a_read_only_disk() {
    let place = Place::new();
    let folder = place.path("disk");
    let Some(disk) = Mounted::new(&folder, "size=8m") else {
        return;
    };
    let db = place.text_path("disk/history.db");
    place.ptu(&["run", "tcms/link", "--db", &db]).exits(0);
    let remounted = Command::new("mount")
        .args(["-o", "remount,ro"])
        .arg(disk.0)
        .status();
    assert!(remounted.expect("mount").success());
    place
        .ptu(&["run", "tcms/link", "--db", &db])
        .exits(3)
        .explains(&["disk/history.db", "read-only", "writable", "--db"]);
    let runs = place.json(&["runs", "list", "--json", "--db", &db]);
    assert_eq!(crate::common::list(&runs).len(), 1, "reading goes on");
}

/// Goal: a disk that fills up in the middle of a run loses nothing recorded before. Method: what is
/// left free is enough to begin a run and not enough for its faults and traces.
#[test]
fn a_full_disk() {
    let place = Place::new();
    let folder = place.path("disk");
    let Some(_disk) = Mounted::new(&folder, "size=1m") else {
        return;
    };
    let db = place.text_path("disk/history.db");
    place.ptu(&["run", "tcms/link", "--db", &db]).exits(0);
    std::fs::write(folder.join("ballast"), vec![1; 512 * 1024]).expect("ballast");
    place
        .ptu(&["run", "--inject", "eb_relay.slow", "--db", &db])
        .exits(3)
        .explains(&[
            "no room left",
            "disk/history.db",
            "free some space",
            "is kept",
        ]);
    std::fs::remove_file(folder.join("ballast")).expect("room again");
    let runs = place.json(&["runs", "list", "--json", "--db", &db]);
    let runs = crate::common::list(&runs);
    assert_eq!(runs[runs.len() - 1]["verdict"], "passed", "{runs:?}");
    assert_eq!(runs.len(), 2, "the run that was cut off shows");
    assert_eq!(runs[0]["state"], "interrupted");
    place.ptu(&["db", "check", "--db", &db]).exits(0);
    place.ptu(&["run", "tcms/link", "--db", &db]).exits(0);
}

/// A time that no clock shows is told as it is, at once.
#[test]
fn absurd_times_are_shown_without_delay() {
    let place = Place::new();
    let db = place.text_path("absurd.db");
    let slow = format!("run atp/overspeed --inject eb_relay.slow --db {db}");
    place.ptu(&slow).exits(1);
    let connection = Connection::open(&db).expect("a database");
    // In place of a signal's rows beside what was expected, why there is none.
    let asked = ["trace", "show", "latest", "--db", &db];
    for (column, table) in [
        ("t0_bench_us", "trace"),
        ("period_us", "trace"),
        ("trigger_row", "trace"),
        ("t0_bench_us", "recording"),
    ] {
        let sql = format!("SELECT {column} FROM {table}");
        let before: i64 = connection
            .query_row(&sql, [], |row| row.get(0))
            .expect("a value");
        for absurd in [i64::MAX, i64::MIN, i64::from(u32::MAX), 0, before] {
            let change = format!("UPDATE {table} SET {column} = {absurd}");
            connection.execute_batch(&change).expect("changed");
            let begun = std::time::Instant::now();
            let said = place.ptu(&asked);
            assert!(matches!(said.code, Some(0 | 3)), "{change}: {}", said.all());
            assert!(begun.elapsed().as_secs() < 20, "{change}");
        }
    }
    for (column, table) in [
        ("t0_us", "trace"),
        ("started_at_us", "run"),
        ("finished_at_us", "run"),
    ] {
        let change = format!("UPDATE {table} SET {column} = {}", i64::MAX);
        connection.execute_batch(&change).expect("changed");
    }
    for arguments in [
        &["trace", "show", "latest", "--db", &db][..],
        &["trace", "show", "latest", "--json", "--db", &db],
        &["runs", "list", "--db", &db],
        &["runs", "show", "latest", "--json", "--db", &db],
    ] {
        let begun = std::time::Instant::now();
        let said = place.ptu(arguments).exits(0);
        assert!(said.out.contains("no date"), "{arguments:?}: {}", said.out);
        assert!(begun.elapsed().as_secs() < 20, "{arguments:?}");
    }
}

/// A script of which every step fails, with names as long as they may be.
fn all_fail(place: &Place, steps: usize) {
    let name = "이름".repeat(95);
    let mut script = String::from("procedure(title = \"Alarm\", suspect = \"-\")\n");
    for step in 0..steps {
        script += &format!(
            "step(\"{step} {name}\", expect = [becomes(alarm, True, within = ms(100))])\n"
        );
    }
    place.write("fails.star", &script);
}

/// Goal: a program that was killed told nothing that is lost. Method: killed right after a line, in virtual
/// time, many lines before the end.
#[test]
fn a_line_on_the_console_is_in_the_database_before_it_is_told() {
    const TOLD: usize = 20;
    let place = Place::new();
    all_fail(&place, 10 * TOLD);
    let mut command = place.command("run fails.star");
    let mut run = command.stderr(Stdio::piped()).spawn().expect("ptu starts");
    let lines = BufReader::new(run.stderr.take().expect("its notes")).lines();
    let told = lines.map_while(Result::ok);
    let failed = told.filter(|line| line.starts_with("failed  fails: "));
    assert_eq!(failed.take(TOLD).count(), TOLD);
    run.kill().expect("killed");
    run.wait().expect("over");
    let file = Connection::open(place.path("history.db")).expect("the database");
    let failed = "SELECT count(*) FROM step WHERE verdict = 'failed'";
    let stored = file.query_row(failed, [], |row| row.get::<_, usize>(0));
    let stored = stored.expect("an answer");
    assert!(stored >= TOLD, "{stored}");
}

/// Goal: neither bench nor store waits for whoever reads. Method: notes into a pipe that nobody reads, more
/// than it takes.
#[test]
fn a_run_goes_on_while_nobody_reads_its_notes() {
    let place = Place::new();
    all_fail(&place, 100);
    let mut command = place.command("run fails.star");
    let run = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let run = run.expect("ptu starts");
    let began = Instant::now();
    loop {
        assert!(began.elapsed() < Duration::from_secs(120), "it waits");
        let runs = place.ptu("runs list --json");
        if runs.code == Some(0) && runs.out.contains("\"finished\"") {
            break;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    let said = Said::from(run.wait_with_output().expect("its notes")).exits(1);
    assert!(
        said.err.len() > 64 << 10,
        "a pipe takes less: {}",
        said.err.len()
    );
    assert!(said.err.contains("failed  fails: 99 "), "{}", said.err);
}

/// Somewhere that takes nothing: a full disk, or a reader that has gone away.
fn takes_nothing(full: bool) -> Stdio {
    if full {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full");
        return full.expect("/dev/full").into();
    }
    let (_, writer) = std::io::pipe().expect("a pipe");
    writer.into()
}

#[test]
fn a_run_ends_as_it_is_whatever_becomes_of_what_it_tells() {
    let place = Place::new();
    for full in [true, false] {
        for (inject, exit, verdict) in [(None, 0, "passed"), (Some("eb_relay.slow"), 1, "failed")] {
            let mut arguments = vec!["run", "atp/overspeed", "--report", "report.json"];
            arguments.extend(inject.iter().flat_map(|fault| ["--inject", fault]));
            let mut command = place.command(&arguments);
            command
                .stdout(takes_nothing(full))
                .stderr(takes_nothing(full));
            let status = command.status().expect("ptu starts");
            assert_eq!(status.code(), Some(exit), "{full} {verdict}");
            assert_eq!(place.read_json("report.json")["run"]["verdict"], verdict);
            let stored = place.json("runs show latest --json");
            assert_eq!(stored["run"]["verdict"], verdict);
        }
    }
}
