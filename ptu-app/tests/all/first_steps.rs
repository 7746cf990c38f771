//! What leads a newcomer: `ptu doctor`, `ptu new`, and the help that a package installs.

use std::fs;

use serde_json::Value;

use crate::common::{Place, copy_folder, has, list, scripts, text};
use crate::trace_files::run_python;

fn finding<'a>(found: &'a Value, subject: &str) -> &'a Value {
    let mut findings = list(found).iter();
    let one = findings.find(|finding| text(&finding["subject"]) == subject);
    one.unwrap_or_else(|| panic!("nothing of {subject}: {found}"))
}

/// Goal: on a computer that is as it should be nothing is wrong, before the first run and after it, and nothing is made.
#[test]
fn a_good_computer_has_nothing_wrong() {
    let place = Place::new();
    let found = place.json("doctor --json");
    assert_eq!(text(&finding(&found, "scripts")["state"]), "ok");
    let database = finding(&found, "database");
    assert!(text(&database["found"]).contains("will be made"), "{found}");
    assert!(!place.path("history.db").exists());
    place.recorded_run();
    let found = place.json("doctor --json");
    let database = finding(&found, "database");
    assert!(
        text(&database["found"]).contains("newest run of 20"),
        "{found}"
    );
    let told = place.ptu("doctor").exits(0);
    for word in ["scripts", "ports", "display", "disk", "clock", "server"] {
        assert!(told.out.contains(word), "{}", told.all());
    }
}

/// Goal: what is wrong is named with what to do about it. It ends with 1 only where not even the simulated unit can be tested.
#[test]
fn what_is_wrong_is_named_with_its_remedy() {
    let place = Place::new();
    place.recorded_run();
    let run = "UPDATE run SET started_at_us = started_at_us + 400000000000000";
    let changed = rusqlite::Connection::open(place.path("history.db")).expect("the history");
    changed.execute_batch(run).expect("moved into the future");
    drop(changed);
    fs::create_dir(place.path("own")).expect("a folder");
    for (name, content) in [("a.db", "no database"), ("own/x.star", "procedure(")] {
        place.write(name, content);
    }
    let asks: [(&[&str], i32, &str, &str, &str); 4] = [
        (
            &[],
            0,
            "clock",
            "later than this computer's clock",
            "set the clock",
        ),
        (
            &["--db", "a.db"],
            1,
            "database",
            "is not a database",
            "`ptu db check`",
        ),
        (
            &["--scripts", "own"],
            1,
            "scripts",
            "no unit configuration",
            "move it away",
        ),
        (
            &["--server", "postgres://kim@127.0.0.1:9/history"],
            0,
            "server",
            "127.0.0.1",
            "sync them when it answers",
        ),
    ];
    for (arguments, exit, subject, says, remedy) in asks {
        let state = if exit == 0 { "warning" } else { "wrong" };
        let told = place
            .ptu(&[&["doctor", "--json"], arguments].concat())
            .exits(exit);
        let found: Value = serde_json::from_str(&told.out).expect("JSON");
        let wrong = list(&found)
            .iter()
            .find(|finding| {
                text(&finding["state"]) == state && text(&finding["subject"]) == subject
            })
            .unwrap_or_else(|| panic!("{subject}: {found}"));
        assert!(text(&wrong["found"]).contains(says), "{wrong}");
        assert!(text(&wrong["remedy"]).contains(remedy), "{wrong}");
    }
}

/// Goal: what a newcomer begins is right as it stands: it passes the check, and the check of it passes on a good unit.
#[test]
fn what_is_begun_passes_the_check_and_is_used_at_once() {
    let place = Place::new();
    let whole = place.path("whole");
    copy_folder(&scripts(), &whole);
    let whole = whole.to_string_lossy().into_owned();
    let run = |arguments: &[&str]| place.ptu(&[arguments, &["--scripts", &whole]].concat());
    for (what, name) in [
        ("procedure", "depot/doors"),
        ("unit", "sg200"),
        ("line", "line9"),
        ("train", "emu9"),
        ("fault", "eb_relay.late_when_cold"),
    ] {
        run(&["new", what, name]).exits(0);
        let told = run(&["new", what, name]).exits(2);
        assert!(told.err.contains("is there already"), "{}", told.all());
    }
    let told = run(&["run", "--check"]).exits(0);
    assert!(told.out.contains("data files, no errors"), "{}", told.all());
    run(&[
        "run",
        "depot/doors",
        "--unit-config",
        "sg200",
        "--line",
        "line9",
        "--train",
        "emu9",
    ])
    .exits(0);
    run(&[
        "run",
        "atp/overspeed",
        "--inject",
        "eb_relay.late_when_cold",
    ])
    .exits(1);
    let faults = run(&["catalog", "faults"]).exits(0);
    has(&faults.out, &["eb_relay.late_when_cold"]);
}

/// Goal: an editor knows every word; the stubs are Python, by a foreign reader.
#[test]
fn stubs_for_editors_are_python() {
    let place = Place::new();
    let folder = place.text_path("stubs");
    place.ptu(&["new", "stubs", "--in", &folder]).exits(0);
    assert!(place.read("stubs/tacho.py").contains("def speed("));
    let files = fs::read_dir(place.path("stubs")).expect("a folder");
    let files: Vec<_> = files.map(|file| file.expect("an entry").path()).collect();
    let read = std::process::Command::new("python3")
        .args(["-m", "py_compile"])
        .args(&files)
        .status()
        .expect("python3, which scripts/test installs");
    assert!(read.success());
}

/// Goal: an editor tells a wrong key while it is written, and nothing that is right: by a foreign reader, on every data file
/// that is shipped or begun.
#[test]
#[ignore = "long suite: readers of other makers"]
fn every_data_file_fits_its_schema_and_a_wrong_key_does_not() {
    let place = Place::new();
    let folder = place.path("scripts");
    copy_folder(&scripts(), &folder);
    let folder = folder.to_string_lossy().into_owned();
    place.ptu(&["new", "schemas", "--in", &folder]).exits(0);
    for (what, name) in [
        ("unit", "sg200"),
        ("line", "line9"),
        ("fault", "eb_relay.late"),
    ] {
        place.ptu(&["new", what, name, "--in", &folder]).exits(0);
    }
    let said = run_python("check_schemas.py", &[&folder]);
    assert!(
        said.ends_with("each fits, and none with a wrong key\n"),
        "{said}"
    );
}

/// Goal: a package has a manual page of every verb, and completions of three shells.
#[test]
fn the_help_that_a_package_installs_names_every_verb() {
    let place = Place::new();
    let folder = place.text_path("help");
    place.ptu(&["help-files", &folder]).exits(0);
    let page = place.read("help/man1/ptu-faults-list.1");
    assert!(
        page.contains("ptu faults list") || page.contains("ptu\\-faults\\-list"),
        "{page}"
    );
    for verb in ["run", "doctor", "diagnose", "db-sync"] {
        assert!(
            place.path(&format!("help/man1/ptu-{verb}.1")).is_file(),
            "{verb}"
        );
    }
    assert!(!place.path("help/man1/ptu-help-files.1").exists());
    for file in ["bash/ptu.bash", "zsh/_ptu", "fish/ptu.fish"] {
        assert!(
            place.read(&format!("help/{file}")).contains("doctor"),
            "{file}"
        );
    }
}
