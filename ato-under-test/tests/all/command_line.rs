//! What the served unit takes from its command line.

use std::path::Path;
use std::process::Command;

/// Goal: a fault the unit cannot carry out is refused, not passed over. Method: each is asked for; the
/// program ends at once with the reason.
#[test]
fn faults_that_are_not_the_units_are_refused_with_who_injects_them() {
    let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scripts");
    for (fault, words) in [
        ("inverter.dead", "fault inverter.dead is on the train"),
        ("tra.dead,tcms.silent", "fault tcms.silent is on the train"),
        ("tcms.silent", "`ptu run --inject`"),
        (
            "tra.daed",
            "no fault tra.daed; `ptu catalog faults` lists them",
        ),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_ato-under-test"))
            .args(["--pty", "--inject", fault, "--scripts"])
            .arg(&scripts)
            .output()
            .expect("ato-under-test starts");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(words), "{said}");
    }
}

/// Goal: who has the program alone has units, lines and faults, too. Method: a copy away from the repository is asked for
/// a fault that none of its files has.
#[test]
fn the_program_alone_has_its_data_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let program = folder.path().join("ato-under-test");
    std::fs::copy(env!("CARGO_BIN_EXE_ato-under-test"), &program).expect("copied");
    let output = Command::new(&program)
        .args(["--pty", "--inject", "tra.daed"])
        .current_dir(folder.path())
        .env_remove("PTU_SCRIPTS")
        .env("HOME", folder.path())
        .env("XDG_DATA_HOME", folder.path())
        .output()
        .expect("ato-under-test starts");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("no fault tra.daed"), "{said}");
}
