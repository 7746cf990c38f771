//! Output files: none is ever the history, and none replaces what this program did not write as that kind. A history that is
//! lost under a run costs no run. `outputs` and `bad_databases` among the sessions have the rest.

use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use fuzzing::draw;
use serde_json::Value;

use crate::common::{Place, Said, list, relay_fault, text};

/// A place whose history has this name, and the run of a bad unit.
fn named(history: &str) -> Place {
    let place = Place::with_bad_unit();
    std::fs::rename(place.path("history.db"), place.path(history)).expect("renamed");
    place
}

fn words(command: &str) -> Vec<&str> {
    command.split_whitespace().collect()
}

/// The command on the history of this name.
fn on(place: &Place, history: &str, command: &str) -> Said {
    place.ptu(&[&words(command)[..], &["--db", history]].concat())
}

/// Goal: no output is ever the history. Method: each command that writes a file is told to write it over the history, by its
/// name, by a symbolic and by a hard link, and over the files beside it.
#[test]
#[cfg(unix)]
fn no_output_is_ever_the_history() {
    for (ending, command) in draw::drawn(
        [
            ("jsonl", "run tcms/link --events"),
            ("mcap", "run tcms/link --mcap"),
            ("json", "run tcms/link --report"),
            ("pdf", "report latest --out"),
            ("html", "report FAULT --case --out"),
            ("junit.xml", "runs show latest --report"),
            ("csv", "trace export latest --force --out"),
            ("parquet", "trace export latest --force --out"),
            ("html", "faults trend eb_reaction --plot"),
            ("zst", "campaign --faults eb_relay.slow --out"),
            ("zst", "campaign --faults eb_relay.slow --runs"),
            ("wav", "signal make code 55"),
        ],
        3,
    ) {
        let [history, soft, hard] = ["h", "soft", "hard"].map(|name| format!("{name}.{ending}"));
        let place = named(&history);
        let fault = on(&place, &history, "faults list --part eb_relay --json").exits(0);
        let fault: Value = serde_json::from_str(&fault.out).expect("JSON");
        let command = command.replace("FAULT", text(&fault[0]["id"]));
        let before = std::fs::read(place.path(&history)).expect("a history");
        std::os::unix::fs::symlink(&history, place.path(&soft)).expect("linked");
        for out in [&history, &soft, &hard] {
            if *out == hard {
                std::fs::hard_link(place.path(&history), place.path(out)).expect("linked");
            }
            let said = match command.starts_with("signal") {
                true => place.ptu(&words(&format!("{command} {out}"))),
                false => on(&place, &history, &format!("{command} {out}")),
            };
            // What writes to a history does not open one with two names.
            let (code, why) = match *out == hard && command.starts_with("run ") {
                true => (3, "has a second name"),
                false => (2, "it is a history or another database"),
            };
            said.exits(code).explains(&[why]);
            let after = std::fs::read(place.path(out)).expect("a link");
            assert!(before == after, "{command} {out}");
        }
    }
    for beside in ["h.db-wal", "h.db-shm", "h.db-journal"] {
        let place = named("h.db");
        let said = on(&place, "h.db", &format!("run tcms/link --events {beside}"));
        said.exits(2).explains(&[beside, "belongs to one"]);
        on(&place, "h.db", "runs show latest")
            .exits(0)
            .prints(&["eb_reaction"]);
    }
}

/// Goal: an existing file is replaced only by one of its kind. Method: notes under each name that is written to; then the
/// command twice.
#[test]
fn an_existing_file_of_another_kind_is_refused() {
    let place = Place::with_bad_unit();
    place.recorded_run();
    let fault = text(&relay_fault(&place)["id"]).to_owned();
    let runs = place.run_ids().join(" ");
    std::fs::create_dir(place.path("man1")).expect("a folder");
    for (name, command) in draw::drawn(
        [
            ("a.jsonl", "run tcms/link --events a.jsonl"),
            ("a.mcap", "run tcms/link --mcap a.mcap"),
            ("a.json", "run tcms/link --report a.json"),
            ("a.junit.xml", "report latest --out a.junit.xml"),
            ("a.pdf", "report latest --out a.pdf"),
            ("a.csv", "report latest --out a.csv"),
            ("a.html", "report FAULT --case --out a.html"),
            ("a.json", "runs compare RUNS --report a.json"),
            ("a.html", "faults trend eb_reaction --plot a.html"),
            ("a.html", "drive --line line8 --section 61 --report a.html"),
            ("a.csv", "drive --line line8 --section 61 --report a.csv"),
            ("a.wav", "signal make code 55 --seconds 1 a.wav"),
            ("man1/ptu.1", "help-files ."),
        ],
        3,
    ) {
        let command = command.replace("FAULT", &fault).replace("RUNS", &runs);
        for notes in ["my notes\n", "{\"mine\": 1}\n", "a,b\n1,2\n"] {
            place.write(name, notes);
            place
                .ptu(&words(&command))
                .exits(2)
                .explains(&[name, "name another file"]);
            assert_eq!(place.read(name), notes, "{command}");
            std::fs::remove_file(place.path(name)).expect("removed");
        }
        for _ in 0..2 {
            let said = place.ptu(&words(&command));
            assert!(
                matches!(said.code, Some(0 | 1)),
                "{command}: {}",
                said.all()
            );
        }
        std::fs::remove_file(place.path(name)).expect("written");
    }
}

/// A long run, of which the first steps are in the history.
fn under_way(place: &Place, history: &str) -> Child {
    let command = ["run", "tcms/link", "--repeat", "200", "--db", history];
    let mut command = place.command(&[&command[..], &["--events", "e.jsonl"]].concat());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().expect("ptu starts");
    let begun = Instant::now();
    let steps = || std::fs::read_to_string(place.path("e.jsonl")).map_or(0, |e| e.lines().count());
    while steps() < 20 {
        assert!(begun.elapsed() < Duration::from_secs(60), "no step");
        std::thread::sleep(Duration::from_millis(5));
    }
    child
}

/// The one history beside, which is named.
fn kept_beside(place: &Place, said: &Said) -> String {
    let files = std::fs::read_dir(place.path("")).expect("a folder");
    let names = files.map(|file| file.expect("a file").file_name().display().to_string());
    let is_told =
        |name: &String| name.contains(".run-") && name.ends_with(".db") && said.err.contains(name);
    let mut kept: Vec<_> = names.filter(is_told).collect();
    assert_eq!(kept.len(), 1, "{}", said.all());
    kept.remove(0)
}

/// Goal: a history that is taken away under a run costs no run, and no such run is told as stored. Method: the file is removed, an
/// older copy takes its place, it gets a second name, its log is removed, and an older copy or nothing is written over it. The
/// history that the exit code speaks of has each step that the events told. A file that is written over may be made whole again
/// from its log; otherwise the loss is told.
#[test]
#[cfg(unix)]
fn a_history_that_is_lost_under_a_run_is_told_and_the_run_is_kept() {
    type Deed = (bool, fn(&Path));
    let deeds: [Deed; 6] = [
        (true, |folder| {
            for end in ["", "-wal", "-shm"] {
                let _ = std::fs::remove_file(folder.join(format!("h.db{end}")));
            }
        }),
        (true, |folder| {
            std::fs::rename(folder.join("old.db"), folder.join("h.db")).expect("moved");
        }),
        (true, |folder| {
            std::fs::hard_link(folder.join("h.db"), folder.join("g.db")).expect("linked");
        }),
        (true, |folder| {
            std::fs::remove_file(folder.join("h.db-wal")).expect("removed");
        }),
        (false, |folder| {
            std::fs::copy(folder.join("old.db"), folder.join("h.db")).expect("copied");
        }),
        (false, |folder| {
            std::fs::write(folder.join("h.db"), "").expect("emptied");
        }),
    ];
    for (is_lost, deed) in draw::drawn(deeds, 2) {
        let place = named("h.db");
        std::fs::copy(place.path("h.db"), place.path("old.db")).expect("copied");
        let run = under_way(&place, "h.db");
        deed(&place.path(""));
        let said = Said::from(run.wait_with_output().expect("ended"));
        let (history, said) = match is_lost || said.err.contains("is not in the history") {
            true => (kept_beside(&place, &said), said.exits(3)),
            false => ("h.db".to_owned(), said.exits(0)),
        };
        let events = std::fs::read_to_string(place.path("e.jsonl")).expect("events");
        let told = events.matches(r#""event":"step_finished""#).count();
        let kept = on(&place, &history, "runs show latest --json").exits(0);
        let kept: Value = serde_json::from_str(&kept.out).expect("JSON");
        assert!(told > 20, "{events}");
        // The entry for the stop of the run is no step.
        let steps = list(&kept["steps"]).iter();
        let steps = steps.filter(|step| step["kind"] == "step").count();
        assert_eq!(steps, told, "{}", said.all());
        on(&place, &history, "db check").exits(0);
    }
}
