//! A client written from `protocol/WIRE.md` alone, in another language, talks to the served unit:
//! if the text and the unit ever differ, this fails. Both go in lock step: what holds the machine up holds neither.

use std::path::Path;
use std::process::Command;

use crate::served::Served;

/// What the client says to a unit on a pseudo-terminal, and the code with which it ends.
#[track_caller]
fn says(arguments: &[&str], code: i32, words: &str) {
    let (_unit, port) = Served::start(&["--pty", "--lock-step"]);
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../protocol/tests/client.py");
    let output = Command::new("python3")
        .arg(script)
        .args(["--lock-step", &port])
        .args(arguments)
        .output()
        .expect("python3, which scripts/test installs");
    let said = [output.stdout, output.stderr].concat();
    let said = String::from_utf8_lossy(&said);
    assert_eq!(output.status.code(), Some(code), "{said}");
    assert!(said.contains(words), "{said}");
}

/// The limit of 55 km/h, cm/s.
#[test]
fn it_arms_the_unit_sets_a_code_and_reads_back_the_limit() {
    says(&[], 0, "1528");
}

/// Goal: the text says how the emergency brake is released. Method: a client that knows nothing else drives the
/// unit into it, and out of it again.
#[test]
fn it_drives_the_unit_into_the_emergency_brake_and_releases_it() {
    let released = "acknowledged: emergency brake released";
    says(&["--overspeed", "1750"], 0, released);
}

#[test]
fn without_the_maintenance_key_it_is_refused() {
    says(&["--no-key"], 1, "key_off");
}

/// Goal: the text says how a wayside gives orders, and how a number is keyed in. Method: a client that knows nothing
/// else is wayside and cab.
#[test]
fn it_gives_orders_and_renames_the_train() {
    says(&["--orders"], 0, "keyed in at the cab and confirmed");
}
