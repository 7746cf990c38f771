//! The program away from its repository: what it carries with it, and a depot's own procedures and data over that.

use std::process::Command;

use crate::common::{Place, Said, has, install, scripts};

/// The program in a folder of its own, with no scripts above it, and what it says to these arguments.
fn installed(place: &Place, arguments: &[&str]) -> Said {
    let folder = place.path("bin");
    let program = folder.join("ptu");
    if !program.exists() {
        std::fs::create_dir(&folder).expect("a folder");
        install(&program);
    }
    let mut command = Command::new(program);
    command
        .args(arguments)
        .current_dir(&folder)
        .env_remove("PTU_SCRIPTS")
        .env("PTU_DB", place.path("history.db"))
        .env("HOME", place.path(""))
        .env("XDG_DATA_HOME", place.path("data"));
    Said::from(command.output().expect("ptu starts"))
}

/// A procedure of one step, under a title of its own.
fn own_procedure(title: &str) -> String {
    std::fs::read_to_string(scripts().join("tcms/link.star"))
        .expect("shipped")
        .replacen("title = \"", &format!("title = \"{title} "), 1)
}

/// Goal: who has the program alone has all of it, diagnosis included.
#[test]
fn the_program_alone_runs_and_diagnoses() {
    let place = Place::new();
    let run = ["run", "atp/overspeed", "--inject", "eb_relay.slow"];
    installed(&place, &run).exits(1);
    let told = installed(&place, &["diagnose", "latest"]).exits(0);
    assert!(told.out.contains("EB relay"), "{}", told.all());
    assert!(!told.err.contains("stale"), "{}", told.all());
    let lines = installed(&place, &["catalog", "lines"]).exits(0);
    assert!(lines.out.contains("line8"), "{}", lines.all());
}

/// Goal: a depot adds a procedure and a line, and changes a shipped procedure, without touching what was installed; the
/// dictionary stays good for what it was made of.
#[test]
fn own_files_are_added_to_the_programs_and_counted_before_them() {
    let place = Place::new();
    let own = place.path("data/ptu/scripts");
    for folder in ["tcms", "lines"] {
        std::fs::create_dir_all(own.join(folder)).expect("a folder");
    }
    let write = |name: &str, text: &str| std::fs::write(own.join(name), text).expect("written");
    write("tcms/depot_link.star", &own_procedure("Depot's"));
    let line = std::fs::read_to_string(scripts().join("lines/test_track.toml")).expect("shipped");
    write("lines/depot_track.toml", &line);
    let listed = installed(&place, &["run", "--list"]).exits(0);
    for shown in ["tcms/depot_link", "tcms/link", "atp/overspeed"] {
        assert!(listed.out.contains(shown), "{}", listed.all());
    }
    let lines = installed(&place, &["catalog", "lines"]).exits(0);
    assert!(lines.out.contains("depot_track"), "{}", lines.all());
    installed(&place, &["run", "tcms/depot_link"]).exits(0);
    installed(
        &place,
        &["run", "atp/overspeed", "--inject", "eb_relay.slow"],
    )
    .exits(1);
    let told = installed(&place, &["diagnose", "latest"]).exits(0);
    assert!(!told.err.contains("stale"), "{}", told.all());

    write("tcms/link.star", &own_procedure("Changed"));
    let listed = installed(&place, &["run", "--list"]).exits(0);
    assert!(listed.out.contains("Changed"), "{}", listed.all());
    let told = installed(&place, &["diagnose", "latest"]).exits(0);
    has(&told.err, &["stale, made before tcms/link changed"]);
    write("tcms/link.star", "procedure(");
    let told = installed(&place, &["run", "tcms/link"]).exits(2);
    assert!(told.err.contains("tcms/link.star"), "{}", told.all());
}
