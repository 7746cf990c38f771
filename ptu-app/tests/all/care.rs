//! What changes the history: the life of a fault, and the care of the database.

use crate::common::{Place, Said, has, list, record_bad_unit, text};

/// Goal: a copy answers as the history that it is of. `merged` among the sessions has the rest.
#[test]
fn a_copy_says_of_a_run_what_the_history_says() {
    let place = Place::new();
    record_bad_unit(&place);
    let report = place.json("runs show latest --json");
    for verb in ["backup", "export"] {
        place.ptu(&format!("db {verb} {verb}.db")).exits(0);
        let copy = format!("runs show latest --json --db {verb}.db");
        assert_eq!(place.json(&copy), report, "{verb}");
    }
}

/// Goal: a run that says something else in another file is left as it is and named, in words and in JSON.
#[test]
fn a_run_that_says_something_else_in_another_file_is_named() {
    let place = Place::new();
    record_bad_unit(&place);
    let run = place.run_ids()[0].clone();
    place.ptu("db backup copy.db").exits(0);
    let copy = rusqlite::Connection::open(place.path("copy.db")).expect("the copy");
    copy.execute_batch("UPDATE run SET verdict = 'passed'")
        .expect("altered");
    drop(copy);
    place.ptu("db import copy.db").exits(3).explains(&[
        &run,
        "does not say the same",
        "ptu db check",
    ]);
    let said = place.ptu("db import copy.db --json").exits(3);
    let told: serde_json::Value = serde_json::from_str(&said.out).expect("JSON");
    let expected = serde_json::json!([{"what": "run", "id": run}]);
    assert_eq!(told["different"], expected);
    assert_eq!(
        (&told["runs"], &told["conflicts"]),
        (&0.into(), &serde_json::json!([]))
    );
    let shown = place.json("runs show latest --json");
    assert_eq!(shown["run"]["verdict"], "failed");
    let check = place.json("db check --json");
    assert!(list(&check["problems"]).is_empty(), "{check}");
    place.ptu("db export copy.db").exits(3);
}

/// Whatever the umask allows, history and settings are their owner's alone; what others were given before is
/// told, and stays.
#[cfg(unix)]
#[test]
fn history_and_settings_are_for_their_owner_alone() {
    use std::os::unix::fs::PermissionsExt as _;
    let place = Place::new();
    let ptu = |arguments: &str| {
        let mut shell = std::process::Command::new("sh");
        let command = format!("umask 000; exec {} {arguments}", env!("CARGO_BIN_EXE_ptu"));
        let usual = place.command(&[]);
        let environment = usual
            .get_envs()
            .filter_map(|(name, value)| Some((name, value?)));
        shell
            .args(["-c", &command])
            .envs(environment)
            .env_remove("PTU_DB");
        shell.current_dir(place.path("."));
        Said::from(shell.output().expect("ptu starts"))
    };
    let mode = |name: &str| {
        let about = std::fs::metadata(place.path(name)).expect(name);
        format!("{:o}", about.permissions().mode() & 0o777)
    };
    ptu("run tcms/link").exits(0);
    ptu("faults list --state open --save waiting").exits(0);
    ptu("db backup copy.db").exits(0);
    ptu("db export other.db").exits(0);
    for file in ["ptu/history.db", "copy.db", "other.db"] {
        assert_eq!(mode(file), "600", "{file}");
    }
    assert_eq!(mode("ptu"), "700");
    let kept = std::fs::read_dir(place.path("ptu"))
        .expect("a folder")
        .flatten();
    for file in kept.filter(|file| file.path().is_file()) {
        let name = format!("ptu/{}", file.file_name().to_string_lossy());
        assert_eq!(mode(&name), "600", "{name}");
    }
    // While it is open, what SQLite keeps beside it.
    let store = rusqlite::Connection::open(place.path("ptu/history.db")).expect("opens");
    store
        .execute_batch("BEGIN IMMEDIATE; UPDATE run SET line = line; COMMIT")
        .expect("written");
    for file in ["ptu/history.db-wal", "ptu/history.db-shm"] {
        assert_eq!(mode(file), "600", "{file}");
    }
    drop(store);

    let shared = std::fs::Permissions::from_mode(0o644);
    std::fs::set_permissions(place.path("ptu/history.db"), shared).expect("shared");
    let said = ptu("run tcms/link").exits(0);
    has(&said.err, &["mode 644", "chmod 600"]);
    assert_eq!(mode("ptu/history.db"), "644");
    let said = ptu("db backup second.db").exits(0);
    assert_eq!(mode("second.db"), "600", "{}", said.err);
}

/// Goal: of somebody else's file comes what fits, and the rest is named, with the exit code that says so.
#[test]
fn what_does_not_fit_its_seal_is_named_and_left_out_of_an_import() {
    let place = Place::new();
    let (theirs, ours) = (place.text_path("theirs.db"), place.text_path("ours.db"));
    for _ in 0..2 {
        place.ptu(&["run", "tcms/link", "--db", &theirs]).exits(0);
    }
    let runs = place.json(&["runs", "list", "--json", "--db", &theirs]);
    let id = text(&list(&runs)[0]["id"]).to_owned();
    let conn = rusqlite::Connection::open(&theirs).expect("opens");
    let change = "UPDATE step SET message = 'x' WHERE run = (SELECT max(seq) FROM run)";
    conn.execute_batch(change).expect("changed");
    drop(conn);
    let said = place
        .ptu(&["db", "import", &theirs, "--db", &ours])
        .exits(3);
    has(&said.out, &["added 1 runs", "refused 1"]);
    said.explains(&[&format!("refused run {id}"), "changed after it was sealed"]);
    let said = place
        .ptu(&["db", "import", &theirs, "--json", "--db", &ours])
        .exits(3);
    let told: serde_json::Value = serde_json::from_str(&said.out).expect("JSON");
    assert_eq!(told["refused"]["count"], 1, "{told}");
    place.ptu(&["db", "check", "--db", &ours]).exits(0);
    // A view in the place of a table is looked at, and not asked.
    let conn = rusqlite::Connection::open(&theirs).expect("opens");
    conn.execute_batch(
        "DROP TABLE run_note; CREATE VIEW run_note AS WITH RECURSIVE n(id, run, at_us, who, text) AS
            (SELECT randomblob(16), 1, 1, '', '' UNION ALL SELECT randomblob(16), 1, 1, '', '' FROM n)
         SELECT * FROM n",
    )
    .expect("changed");
    drop(conn);
    let begun = std::time::Instant::now();
    (place
        .ptu(&["db", "import", &theirs, "--db", &ours])
        .exits(3))
    .explains(&["theirs.db was altered by hand"]);
    assert!(begun.elapsed().as_secs() < 20);
}
