//! A client written from `protocol/WIRE.md` alone, in another language, talks to the served unit:
//! if the text and the unit ever differ, this fails. Both go in lock step: what holds the machine up holds neither.

use std::path::Path;
use std::process::{Command, Output};

use crate::served::Served;

/// A unit on a pseudo-terminal, and the terminal's name.
fn serve() -> (Served, String) {
    Served::start(&["--pty", "--lock-step"])
}

fn client(arguments: &[&str]) -> Output {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../protocol/tests/client.py");
    Command::new("python3")
        .arg(script)
        .arg("--lock-step")
        .args(arguments)
        .output()
        .expect("python3, which scripts/test installs")
}

#[test]
fn it_arms_the_unit_sets_a_code_and_reads_back_the_limit() {
    let (_unit, port) = serve();
    let output = client(&[&port]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success(),
        "{text}{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(
        text.contains("1528"),
        "the limit of 55 km/h in cm/s: {text}"
    );
}

/// Goal: the text says how the emergency brake is released. Method: a client that knows nothing else drives the
/// unit into it, and out of it again.
#[test]
fn it_drives_the_unit_into_the_emergency_brake_and_releases_it() {
    let (_unit, port) = serve();
    let output = client(&[&port, "--overspeed", "1750"]);
    let said = [output.stdout, output.stderr].concat();
    let said = String::from_utf8_lossy(&said);
    assert!(output.status.success(), "{said}");
    assert!(
        said.contains("acknowledged: emergency brake released"),
        "{said}"
    );
}

#[test]
fn without_the_maintenance_key_it_is_refused() {
    let (_unit, port) = serve();
    let output = client(&[&port, "--no-key"]);
    let said = [output.stdout, output.stderr].concat();
    let said = String::from_utf8_lossy(&said);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("key_off"), "{said}");
}

/// Goal: the text says how a wayside gives orders, and how a number is keyed in. Method: a client that knows nothing
/// else is wayside and cab.
#[test]
fn it_gives_orders_and_renames_the_train() {
    let (_unit, port) = serve();
    let output = client(&[&port, "--orders"]);
    let said = [output.stdout, output.stderr].concat();
    let said = String::from_utf8_lossy(&said);
    assert!(output.status.success(), "{said}");
    assert!(said.contains("keyed in at the cab and confirmed"), "{said}");
}
