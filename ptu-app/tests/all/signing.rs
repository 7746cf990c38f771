//! Keys, signed runs, and `ptu verify`, as their users have them.

use serde_json::Value;

use crate::common::{Place, Said, list, text};

const PIN: &str = "sesame-7";

/// A key `kim.key` of Kim, trusted in `depot.keys`.
pub fn with_key() -> Place {
    let place = Place::new();
    place.write("pin.txt", &format!("{PIN}\n"));
    let new = [
        "key",
        "new",
        "--who",
        "Kim",
        "--out",
        "kim.key",
        "--pin-file",
        "pin.txt",
    ];
    place
        .ptu(&new)
        .exits(0)
        .prints(&["of Kim (technician)", "kim.pub", "ptu run --key"]);
    (place.ptu(&["key", "trust", "kim.pub", "--keys", "depot.keys"]))
        .exits(0)
        .prints(&["trusted: Kim"]);
    place
}

pub const SIGN: [&str; 4] = ["--key", "kim.key", "--pin-file", "pin.txt"];

pub fn verify(place: &Place, what: &str) -> Said {
    place.ptu(&["verify", what, "--keys", "depot.keys"])
}

/// Goal: the whole way: a run is signed, verified as run, sheet, certificate and file, and a note and a repair are signed.
#[test]
fn a_signed_run_is_verified_in_each_of_its_forms() {
    let place = with_key();
    let run = [
        "run",
        "atp/overspeed",
        "--inject",
        "eb_relay.slow",
        "--who",
        "Kim",
        "--report",
        "sheet.html",
    ];
    place.ptu(&[&run[..], &SIGN].concat()).exits(1);
    (place.ptu(&["runs", "show", "latest"]))
        .exits(0)
        .prints(&["signed by Kim (technician, key "]);
    let note = [
        "runs",
        "note",
        "latest",
        "relay clicks late",
        "--who",
        "Kim",
    ];
    place.ptu(&[&note[..], &SIGN].concat()).exits(0);
    let fault = place.json(&["faults", "list", "--part", "eb_relay", "--json"]);
    let fault = text(&list(&fault)[0]["id"]).to_owned();
    let repair = [
        "faults", "repair", &fault, "--part", "eb_relay", "--who", "Kim",
    ];
    place.ptu(&[&repair[..], &SIGN].concat()).exits(0);
    place
        .ptu(&["runs", "certificate", "latest", "--out", "run.ptucert"])
        .exits(0);

    verify(&place, "latest").exits(0).prints(&[
        "signed by Kim",
        "valid then",
        "unchanged",
        "SIM-0001: failed",
    ]);
    let seen = place.json(&["verify", "latest", "--keys", "depot.keys", "--json"]);
    assert_eq!(seen["verified"], true, "{seen}");
    let whats: Vec<&str> = list(&seen["signatures"])
        .iter()
        .map(|one| text(&one["what"]))
        .collect();
    assert!(whats.starts_with(&["run", "note", "event"]), "{whats:?}");
    verify(&place, "sheet.html")
        .exits(0)
        .prints(&["sheet", "signed by Kim", "unchanged"]);
    verify(&place, "run.ptucert")
        .exits(0)
        .prints(&["the run in the database is what was signed"]);
    verify(&place, "history.db")
        .exits(0)
        .prints(&["signed 1 runs", "unchanged"]);

    // What a scanner reads of the sheet on paper.
    let page = place.read("sheet.html");
    let code = page.split_once("aria-label=\"ptu:").expect("a code").1;
    let code = format!("ptu:{}", code.split_once('"').expect("its end").0);
    verify(&place, &code)
        .exits(0)
        .prints(&["the run in the database is the one of the sheet"]);
    let run = code.split_once('/').expect("a run").0;
    verify(&place, &format!("{run}/{}", "0".repeat(64)))
        .exits(1)
        .prints(&["the run in the database is not the one of the sheet"]);
    verify(&place, run).exits(2).explains(&["ptu:RUN/SHA-256"]);

    // A changed word of the sheet, its certificate, the certificate file, the database.
    assert!(page.contains("Kim, key "));
    place.write("other.html", &page.replace("SIM-0001", "SIM-0002"));
    verify(&place, "other.html")
        .exits(1)
        .prints(&["CHANGED", "the text of the sheet was changed"]);
    place.write(
        "other.html",
        &page.replace("\"verdict\":\"failed\"", "\"verdict\":\"passed\""),
    );
    verify(&place, "other.html")
        .exits(1)
        .prints(&["CHANGED", "does not fit its content"]);
    let certificate = place.read("run.ptucert");
    place.write(
        "other.ptucert",
        &certificate.replace("SIM-0001", "SIM-0002"),
    );
    verify(&place, "other.ptucert")
        .exits(1)
        .prints(&["CHANGED"]);
    let conn = rusqlite::Connection::open(place.path("history.db")).expect("opens");
    conn.execute_batch("UPDATE step SET verdict = 'passed' WHERE verdict = 'failed'")
        .expect("changed");
    drop(conn);
    verify(&place, "latest")
        .exits(1)
        .prints(&["CHANGED", "was changed after it was signed: step "]);
    verify(&place, "run.ptucert").exits(1).prints(&["CHANGED"]);
    verify(&place, "history.db")
        .exits(1)
        .prints(&["was changed after it was sealed"]);
}

/// Goal: without a key all is as it was, and says "unsigned" everywhere.
#[test]
fn without_a_key_a_run_says_unsigned() {
    let place = Place::new();
    place
        .ptu(&["run", "tcms/link", "--report", "sheet.html"])
        .exits(0);
    place
        .ptu(&["runs", "show", "latest"])
        .exits(0)
        .prints(&["unsigned"]);
    assert_eq!(
        place.json(&["runs", "show", "latest", "--json"])["signature"],
        Value::Null
    );
    let page = place.read("sheet.html");
    assert!(page.contains("unsigned") && !page.contains("ptu-certificate"));
    place.ptu(&["verify", "latest"]).exits(1).prints(&[
        "NOT VERIFIED",
        "the run is not signed",
        "seal ",
    ]);
    place
        .ptu(&["runs", "certificate", "latest", "--out", "a.ptucert"])
        .exits(2)
        .explains(&["is not signed", "--key"]);
    place
        .ptu(&["verify", "sheet.html"])
        .exits(3)
        .explains(&["has none"]);
}

/// Goal: a key that is unknown, revoked or expired is told apart, and a signature made before stays valid.
#[test]
fn a_key_holds_as_long_as_the_list_says() {
    let place = with_key();
    place
        .ptu(&[&["run", "tcms/link"][..], &SIGN].concat())
        .exits(0);
    place.write("empty.keys", "");
    (place.ptu(&["verify", "latest", "--keys", "empty.keys"]))
        .exits(1)
        .prints(&["not in the list of keys"]);
    let list = place.read("depot.keys");
    let today = list
        .lines()
        .find_map(|line| line.strip_prefix("from = \""))
        .expect("a day")
        .trim_end_matches('"');
    let with = |line: String| {
        place.write(
            "depot.keys",
            &format!("{}{line}\n", list.trim_end().to_owned() + "\n"),
        )
    };
    with("revoked = \"2999-01-01\"".to_owned());
    verify(&place, "latest").exits(0);
    with(format!("revoked = \"{today}\""));
    verify(&place, "latest")
        .exits(1)
        .prints(&["was revoked from"]);
    place.write(
        "depot.keys",
        &list.replace(&format!("from = \"{today}\""), "from = \"2999-01-01\""),
    );
    verify(&place, "latest")
        .exits(1)
        .prints(&["is valid from 2999-01-01 only"]);
    place.write(
        "depot.keys",
        &list.replace("who = \"Kim\"", "who = \"Lee\""),
    );
    verify(&place, "latest")
        .exits(1)
        .prints(&["belongs to Lee"]);
    place.write("depot.keys", &list);
    place
        .ptu(&[
            "key",
            "revoke",
            "Kim",
            "--note",
            "lost",
            "--keys",
            "depot.keys",
        ])
        .exits(0);
    (place.ptu(&["key", "list", "--keys", "depot.keys"]))
        .exits(0)
        .prints(&["was revoked from", "lost"]);
}

/// Goal: keys are used as `docs/signing.md` writes it: by name alone, from where `ptu key new` puts them. A file of that name
/// in the current folder comes first, and a key that is in neither is not found in both.
#[test]
fn a_key_is_used_by_its_name_from_where_it_is_kept() {
    let place = Place::new();
    place.write("pin.txt", PIN);
    let new = |who: &str, more: &[&str]| {
        let all = ["key", "new", "--who", who, "--pin-file", "pin.txt"];
        place.ptu(&[&all[..], more].concat()).exits(0);
    };
    new("Kim", &[]);
    let kept = |name: &str| place.text_path(&format!("ptu/keys/{name}"));
    place.ptu(&["key", "trust", "kim.pub"]).exits(0);
    let sign = |by: &'static str| ["--key", by, "--pin-file", "pin.txt"];
    let run = |by| place.ptu(&[&["run", "tcms/link"][..], &sign(by)].concat());
    run("kim.key").exits(0);
    place
        .ptu(&["verify", "latest"])
        .exits(0)
        .prints(&["signed by Kim"]);
    let (private, public, trusted) = (kept("kim.key"), kept("kim.pub"), kept("trusted.keys"));
    place
        .ptu(&["key", "list"])
        .exits(0)
        .prints(&[&private, &public, &trusted]);
    let listed = place.json(&["key", "list", "--json"]);
    assert_eq!(
        listed[0]["files"],
        serde_json::json!([private, public, trusted])
    );

    new("Lee", &["--out", "kim.key"]);
    run("kim.key").exits(0);
    (place.ptu(&["runs", "show", "latest"]))
        .exits(0)
        .prints(&["Lee"]);
    place
        .ptu(&["key", "trust", "kim.pub"])
        .exits(0)
        .prints(&["Lee"]);

    let both = ["current folder", &kept("")];
    let both = both.map(|place| place.trim_end_matches('/'));
    run("nobody.key").exits(2).explains(&both);
    (place.ptu(&["key", "trust", "nobody.pub"]))
        .exits(2)
        .explains(&both);
    (place.ptu(&["key", "list", "--keys", "nobody.keys"]))
        .exits(2)
        .explains(&both);
    // A path is that file and no other.
    let elsewhere = run("./nobody.key").exits(2);
    assert!(
        !elsewhere.err.contains("current folder"),
        "{}",
        elsewhere.err
    );
}

/// Goal: what is wrong with a key is said plainly, with the next step, before a unit is touched.
#[test]
fn a_key_that_does_not_serve_is_explained() {
    let place = with_key();
    let run = |more: &[&str]| place.ptu(&[&["run", "tcms/link"][..], more].concat());
    run(&["--key", "no.key"])
        .exits(2)
        .explains(&["no key file no.key", "ptu key new"]);
    run(&["--key", "kim.key"])
        .exits(2)
        .explains(&["PIN", "--pin-file"]);
    place.write("wrong.txt", "wrong-pin");
    run(&["--key", "kim.key", "--pin-file", "wrong.txt"])
        .exits(2)
        .explains(&["the PIN of kim.key is wrong"]);
    run(&["--key", "depot.keys", "--pin-file", "pin.txt"])
        .exits(2)
        .explains(&["no key file"]);
    let old = place.read("kim.key");
    let until = old
        .lines()
        .find(|line| line.starts_with("until"))
        .expect("a day");
    let expired = old
        .replace(until, "until = \"2020-01-01\"")
        .replace("from = \"2", "from = \"1");
    place.write("old.key", &expired);
    run(&["--key", "old.key", "--pin-file", "pin.txt"])
        .exits(2)
        .explains(&["expired on 2020-01-01", "ptu key new"]);
    place
        .ptu(&["key", "trust", "none.pub"])
        .exits(2)
        .explains(&["no file none.pub"]);
    place
        .ptu(&["key", "revoke", "Kin", "--keys", "depot.keys"])
        .exits(2)
        .explains(&["did you mean \"Kim\""]);
    place
        .ptu(&["verify", "latest", "--keys", "none.keys"])
        .exits(2)
        .explains(&["no list of keys"]);
    place
        .ptu(&["verify", "no.html"])
        .exits(2)
        .explains(&["no file no.html"]);
    place.ptu(&["verify", "pin.txt"]).exits(3);
    let again = [
        "key",
        "new",
        "--who",
        "Kim",
        "--out",
        "kim.key",
        "--pin-file",
        "pin.txt",
    ];
    place.ptu(&again).exits(2).explains(&["is there already"]);
    place.write("short.txt", "123");
    let short = [
        "key",
        "new",
        "--who",
        "Lee",
        "--out",
        "lee.key",
        "--pin-file",
        "short.txt",
    ];
    place.ptu(&short).exits(2).explains(&["at least 6"]);
    assert_eq!(
        place.ptu(&["runs", "list", "--json"]).out.trim(),
        "",
        "a run was made"
    );
}

/// Goal: a sheet that was written again without the key says whose the run is, and that its own text is not signed.
#[test]
fn a_sheet_without_a_signature_of_its_own_says_so() {
    let place = with_key();
    place
        .ptu(&[&["run", "tcms/link"][..], &SIGN].concat())
        .exits(0);
    place
        .ptu(&["report", "latest", "--out", "sheet.html"])
        .exits(0);
    verify(&place, "sheet.html").exits(1).prints(&[
        "run ",
        "signed by Kim",
        "the text of the sheet is not signed",
    ]);
    let report = ["report", "latest", "--out", "sheet.html"];
    place.ptu(&[&report[..], &SIGN].concat()).exits(0);
    verify(&place, "sheet.html").exits(0);
}

/// Goal: a run on a port does not begin while the calibration of an instrument is over, goes on when told so, and a
/// computer without registered instruments works as before.
#[test]
fn a_run_on_a_port_waits_for_a_calibration() {
    let place = Place::with_database();
    place
        .ptu(&["instrument", "list"])
        .exits(0)
        .prints(&["no instrument is registered"]);
    let run = ["run", "tcms/link", "--unit", "tcp:127.0.0.1:1"];
    place.ptu(&run).exits(3).explains(&["127.0.0.1:1"]);
    place
        .ptu(&["run", "tcms/link", "--guard-band"])
        .exits(2)
        .explains(&["no instrument is registered with"]);
    (place.ptu(&["instrument", "add", "B-0031", "--kind", "bench"]))
        .exits(0)
        .prints(&["registered: bench B-0031"]);
    place
        .ptu(&["instrument", "add", "B-0031", "--kind", "bench"])
        .exits(2)
        .explains(&["registered already"]);
    place.ptu(&run).exits(3).explains(&[
        "bench B-0031 was never calibrated",
        "nothing was driven",
        "--uncalibrated",
    ]);
    let runs = place.json(&["runs", "list", "--json"]);
    assert_eq!(list(&runs)[0]["verdict"], "error");
    let calibrate = |due: &str, on: &str| {
        let by = [
            "--calibrated-by",
            "lab 7",
            "--uncertainty",
            "ms=2",
            "--due",
            due,
            "--on",
            on,
        ];
        place.ptu(&[&["instrument", "calibrate", "B-0031"][..], &by].concat())
    };
    calibrate("2020-01-01", "2021-01-01")
        .exits(2)
        .explains(&["before it was calibrated"]);
    calibrate("2021-01-01", "2020-01-01").exits(0);
    place
        .ptu(&run)
        .exits(3)
        .explains(&["calibration of bench B-0031 was due on 2021-01-01"]);
    let on = place
        .ptu(&[&run[..], &["--uncalibrated"]].concat())
        .exits(3);
    assert!(!on.err.contains("due on"), "{}", on.all());
    calibrate("2999-01-01", "2020-01-01").exits(0);
    place.ptu(&run).exits(3).explains(&["127.0.0.1:1"]);
    let known = place.json(&["instrument", "list", "--json"]);
    assert_eq!(
        (&known[0]["is_calibrated"], &known[0]["uncertainty"]["ms"]),
        (&Value::from(true), &Value::from(2.0))
    );
    place.ptu(&["run", "tcms/link"]).exits(0);
    // So uncertain that no value of a time is inside its narrowed limits.
    let wide = [
        "instrument",
        "calibrate",
        "B-0031",
        "--calibrated-by",
        "x",
        "--due",
        "2999-01-01",
    ];
    place
        .ptu(&[&wide[..], &["--uncertainty", "ms=60000"]].concat())
        .exits(0);
    place.ptu(&["run", "atp/overspeed"]).exits(0);
    place
        .ptu(&[
            "run",
            "atp/overspeed",
            "--guard-band",
            "--report",
            "banded.html",
        ])
        .exits(1);
    assert!(place.read("banded.html").contains("guard band: each limit"));
    place
        .ptu(&[
            "instrument",
            "calibrate",
            "B-0032",
            "--calibrated-by",
            "x",
            "--due",
            "2999-01-01",
        ])
        .exits(2)
        .explains(&["no instrument \"B-0032\"", "ptu instrument list"]);
    place.ptu(&["instrument", "retire", "B-0031"]).exits(0);
    place
        .ptu(&["instrument", "list"])
        .exits(0)
        .prints(&["no instrument is registered"]);
    place.ptu(&["db", "check"]).exits(0);
}
