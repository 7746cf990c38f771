//! Keys, signed runs, and `ptu verify`, as their users have them.

use crate::common::{Place, Said, list, text};

const PIN: &str = "sesame-7";

/// A key `kim.key` of Kim, trusted in `depot.keys`.
pub fn with_key() -> Place {
    let place = Place::new();
    place.write("pin.txt", &format!("{PIN}\n"));
    place
        .ptu("key new --who Kim --out kim.key --pin-file pin.txt")
        .exits(0)
        .prints(&["of Kim (technician)", "kim.pub", "ptu run --key"]);
    (place.ptu(&["key", "trust", "kim.pub", "--keys", "depot.keys"]))
        .exits(0)
        .prints(&["trusted: Kim"]);
    place
}

/// A command that signs with Kim's key.
pub fn signed(place: &Place, line: &str) -> Said {
    place.ptu(&format!("{line} --key kim.key --pin-file pin.txt"))
}

pub fn verify(place: &Place, what: &str) -> Said {
    place.ptu(&["verify", what, "--keys", "depot.keys"])
}

/// Goal: the whole way: a run is signed, verified as run, sheet, certificate and file, and a note and a repair are signed.
#[test]
fn a_signed_run_is_verified_in_each_of_its_forms() {
    let place = with_key();
    let run = "run atp/overspeed --inject eb_relay.slow --who Kim --report sheet.html";
    signed(&place, run).exits(1);
    (place.ptu(&["runs", "show", "latest"]))
        .exits(0)
        .prints(&["signed by Kim (technician, key "]);
    let note = "runs note latest 'relay clicks late' --who Kim";
    signed(&place, note).exits(0);
    let fault = place.json(&["faults", "list", "--part", "eb_relay", "--json"]);
    let fault = text(&list(&fault)[0]["id"]).to_owned();
    let repair = format!("faults repair {fault} --part eb_relay --who Kim");
    signed(&place, &repair).exits(0);
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

/// Goal: a key that is unknown, revoked or expired is told apart, and a signature made before stays valid.
#[test]
fn a_key_holds_as_long_as_the_list_says() {
    let place = with_key();
    signed(&place, "run tcms/link").exits(0);
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
        .ptu("key revoke Kim --note lost --keys depot.keys")
        .exits(0);
    (place.ptu(&["key", "list", "--keys", "depot.keys"]))
        .exits(0)
        .prints(&["was revoked from", "lost"]);
}

/// Goal: a key that is over is not signed with.
#[test]
fn an_expired_key_is_refused_before_a_unit_is_touched() {
    let place = with_key();
    let key = place.read("kim.key");
    let until = key.lines().find(|line| line.starts_with("until"));
    let expired = key
        .replace(until.expect("a day"), "until = \"2020-01-01\"")
        .replace("from = \"2", "from = \"1");
    place.write("old.key", &expired);
    let run = place.ptu("run tcms/link --key old.key --pin-file pin.txt");
    run.exits(2)
        .explains(&["expired on 2020-01-01", "ptu key new"]);
    assert!(
        place.ptu("runs list --json").out.is_empty(),
        "a run was made"
    );
}

/// Goal: a sheet whose limits were narrowed names the rule. `instruments` among the sessions has the rest.
#[test]
fn a_guard_band_is_on_the_sheet() {
    let place = Place::with_database();
    place.ptu("instrument add B-0031 --kind bench").exits(0);
    let calibrated =
        "instrument calibrate B-0031 --calibrated-by x --due 2999-01-01 --uncertainty ms=60000";
    place.ptu(calibrated).exits(0);
    let run = "run tcms/link --guard-band --report banded.html";
    place.ptu(run).exits(1);
    assert!(place.read("banded.html").contains("guard band: each limit"));
}
