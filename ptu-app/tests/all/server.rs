//! The command line and a server: what two laptops recorded, in one place, and asked for there.

#[path = "../../../fault-db/tests/server/private.rs"]
#[allow(dead_code, reason = "the tests of fault-db use the rest of it")]
pub(crate) mod owner_only;

use self::owner_only::{Nobody, shared};
use crate::common::{Place, list, record_bad_unit, record_bad_unit_anew, relay_fault, text};
use serde_json::Value;

/// An answer without what grows while one asks: the days that units have been watched for.
fn at_any_time(mut answer: Value) -> Value {
    for row in answer.as_array_mut().into_iter().flatten() {
        row.as_object_mut().map(|row| row.remove("mtbf_days"));
    }
    answer
}

#[test]
fn two_laptops_meet_on_a_server_that_answers_like_their_files() {
    let server = shared().database();
    let (one, two) = (Place::new(), Place::new());
    record_bad_unit(&one);
    let synced = one.json(&["db", "sync", &server, "--json"]);
    assert_eq!(synced["sent"]["runs"], 1, "{synced}");
    assert_eq!(synced["waiting"], 0, "{synced}");
    // No more than one laptop has been there: all answers are those of its file.
    for question in [
        &["runs", "list", "--json"][..],
        &["runs", "show", "latest", "--json"],
        &["faults", "list", "--json"],
        &["faults", "show", "latest", "--json"],
        &["faults", "stats", "--by", "part", "--json"],
        &["faults", "stats", "--by", "month", "--json"],
        &["faults", "trend", "eb_reaction", "--json"],
        &["trace", "show", "latest", "--json"],
        &["diagnose", "latest", "--json"],
        &["db", "query", "SELECT id, verdict FROM run", "--json"],
    ] {
        let there = one.json(&[question, &["--db", &server]].concat());
        let here = one.json(question);
        assert_eq!(at_any_time(there), at_any_time(here), "{question:?}");
    }

    // The other laptop saw the same fault; what is done about it at the desk reaches both.
    record_bad_unit_anew(&two);
    two.ptu(&["db", "sync", &server]).exits(0);
    let faults = two.json(&format!("faults list --part eb_relay --json --db {server}"));
    assert_eq!(list(&faults).len(), 1, "{faults}");
    let fault = text(&faults[0]["id"]);
    let repair = format!("faults repair {fault} --part eb_relay --new SN-77 --db {server}");
    one.ptu(&repair).exits(0);
    one.ptu(&["faults", "note", fault, "바꿈", "--db", &server])
        .exits(0);
    let run = text(&one.json("runs list --json")[0]["id"]).to_owned();
    one.ptu(&["runs", "note", &run, "seen at the desk", "--db", &server])
        .exits(0);
    for place in [&one, &two] {
        let came = place.json(&["db", "sync", &server, "--json"]);
        assert!(came["received"]["events"].as_u64() >= Some(2), "{came}");
        assert_eq!(relay_fault(place)["state"], "repaired");
    }
    // A server in the environment is as good as one on the command line.
    let repaired = "faults list --state repaired --json";
    let said = one.ptu_where(("PTU_DB", &server), repaired);
    said.exits(0).prints(&[fault]);
}

#[test]
fn a_server_that_cannot_be_used_is_named_with_the_exit_code_of_the_contract() {
    let place = Place::new();
    place.recorded_run();
    let nobody = Nobody::there();
    let away = format!("postgres://kim@{}/h?sslmode=disable", nobody.address());
    let empty = shared().empty();
    let refused = shared().address("no_such_database");
    for (arguments, code, words) in [
        (&["db", "sync", &away][..], 3, "nothing listens there"),
        (&["runs", "list", "--db", &away], 3, "nothing listens there"),
        (&["db", "sync", &refused], 3, "does not exist"),
        (
            &["runs", "list", "--db", &empty],
            3,
            "`ptu db server init ADDRESS`",
        ),
        (&["db", "sync", &empty], 3, "`ptu db server init ADDRESS`"),
        (
            &["db", "sync", "postgres://kim@a/h?sslmode=x"],
            2,
            "disable, prefer",
        ),
        (
            &["db", "sync", "mysql://kim@a/h"],
            2,
            "postgres://USER@HOST/DATABASE",
        ),
        (
            &["db", "sync", &empty, "--db", &away],
            2,
            "needs a database file",
        ),
        (
            &["run", "tcms/link", "--db", &away],
            2,
            "needs a database file",
        ),
        (&["db", "check", "--db", &away], 3, "nothing listens there"),
        (&["gui", "--db", &away], 3, "nothing listens there"),
    ] {
        place.ptu(arguments).exits(code).explains(&[words]);
    }
}

/// However an address with a password is spelled and wherever it is given, the password is not shown, and on
/// the command line it is refused.
#[test]
fn a_password_on_the_command_line_is_refused_and_never_shown() {
    let place = Place::new();
    place.recorded_run();
    for address in [
        "postgres://kim:s3cret@127.0.0.1:1/h",
        "postgre://kim:s3cret@a/h",
        "postgresql+ssl://kim:s3cret@a/h",
        "postgres:/kim:s3cret@a/h",
        "postgres://kim:s3cret/@a/h",
        "postgres://kim@a/h?password=s3cret",
        "mysql://kim:s3cret@a/h",
    ] {
        let with_equals = format!("--db={address}");
        for arguments in [
            &["runs", "list", "--db", address][..],
            &["runs", "list", &with_equals],
            &["run", "tcms/link", "--db", address],
            &["db", "sync", address],
            &["db", "import", address],
            &["db", "export", address],
            &["db", "backup", address],
            &["db", "check", "--db", address],
            &["faults", "list", "--save", "open", "--db", address],
            &["no", "such", "command", address],
            &["--help", address],
        ] {
            let said = place.ptu(arguments);
            assert!(
                !said.all().contains("s3cret"),
                "{arguments:?}: {}",
                said.all()
            );
            said.exits(2)
                .explains(&["~/.pgpass", "PGPASSWORD", "passfile="]);
        }
        // In the environment it is the user's own, and not shown either.
        let said = place.ptu_where(("PTU_DB", address), "runs list");
        assert!(!said.all().contains("s3cret"), "{address}: {}", said.all());
        assert!(
            matches!(said.code, Some(2 | 3)),
            "{address}: {}",
            said.all()
        );
    }
    let files = std::fs::read_dir(place.path("."))
        .expect("a folder")
        .flatten();
    for file in files.filter(|file| file.path().is_file()) {
        let bytes = std::fs::read(file.path()).expect("a file");
        let holds = bytes.windows(6).any(|some| some == b"s3cret");
        assert!(!holds, "{}", file.path().display());
    }
    // An address without a password is no file either.
    for verb in ["import", "export", "backup"] {
        (place.ptu(&["db", verb, "postgres://kim@a/h"]).exits(2))
            .explains(&["postgres://kim@a/h", "needs a database file"]);
        place
            .ptu(&["db", verb, "postgre://kim@a/h"])
            .exits(2)
            .explains(&["postgres://USER@HOST"]);
    }
}
