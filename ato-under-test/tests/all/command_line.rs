//! What the served unit takes from its command line.

use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

/// Goal: a fault the unit cannot carry out is refused, not passed over. Method: each is asked for; the
/// program ends at once with the reason.
#[test]
fn faults_that_are_not_the_units_are_refused_with_who_injects_them() {
    let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scripts");
    for (fault, words) in [
        ("inverter.dead", "fault inverter.dead is around the unit"),
        (
            "tra.dead,tcms.silent",
            "fault tcms.silent is around the unit",
        ),
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
    // Another process copies: a program that this one has open to write cannot start, and every process that another
    // test starts in the meantime has what is open here.
    let copied = Command::new("cp")
        .arg(env!("CARGO_BIN_EXE_ato-under-test"))
        .arg(&program)
        .status();
    assert!(copied.expect("cp starts").success());
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

/// Goal: nobody serves a unit to a whole network unawares: there is no authentication. Method: addresses that others reach are
/// refused, and with `--expose`, as at this computer's own, the first line says what it means.
#[test]
fn a_unit_is_served_to_other_computers_only_if_that_is_said() {
    let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scripts");
    let serve = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_ato-under-test"));
        command.arg("--tcp").args(arguments).arg("--scripts");
        command
            .arg(&scripts)
            .stderr(Stdio::piped())
            .stdout(Stdio::null());
        let mut child = command.spawn().expect("ato-under-test starts");
        let mut said = String::new();
        let first = BufReader::new(child.stderr.take().expect("stderr")).read_line(&mut said);
        first.expect("UTF-8");
        let is_over = said.contains("--expose");
        if !is_over {
            child.kill().expect("it serves");
        }
        (said, child.wait().expect("it ends").code())
    };
    for address in ["0.0.0.0:0", "[::]:0"] {
        let (said, code) = serve(&[address]);
        assert_eq!(code, Some(2), "{said}");
        assert!(said.contains("no authentication"), "{said}");
    }
    for arguments in [&["127.0.0.1:0"][..], &["0.0.0.0:0", "--expose"]] {
        let (said, code) = serve(arguments);
        assert_eq!(code, None, "{said}");
        assert!(said.contains("no authentication"), "{said}");
    }
}
