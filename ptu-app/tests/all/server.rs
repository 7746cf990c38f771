//! The command line and a server: what two laptops recorded, in one place, and asked for there.

#[path = "../../../fault-db/tests/server/private.rs"]
#[allow(dead_code, reason = "the tests of fault-db use the rest of it")]
pub(crate) mod owner_only;

use self::owner_only::{free_port, shared};
use crate::common::scripts;
use crate::common::window::{Window, settings};
use crate::common::{Place, list, record_bad_unit, record_bad_unit_anew, relay_fault, text};
use crate::layout::complaints;
use ptu_app::gui::{Page, Settings};
use ptu_report::words::{Language, fill};
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
    let faults = two.json(&[
        "faults", "list", "--part", "eb_relay", "--json", "--db", &server,
    ]);
    assert_eq!(list(&faults).len(), 1, "{faults}");
    let fault = text(&faults[0]["id"]);
    let repair = [
        "faults", "repair", fault, "--part", "eb_relay", "--new", "SN-77", "--db", &server,
    ];
    one.ptu(&repair).exits(0);
    one.ptu(&["faults", "note", fault, "바꿈", "--db", &server])
        .exits(0);
    let run = text(&one.json(&["runs", "list", "--json"])[0]["id"]).to_owned();
    one.ptu(&["runs", "note", &run, "seen at the desk", "--db", &server])
        .exits(0);
    for place in [&one, &two] {
        let came = place.json(&["db", "sync", &server, "--json"]);
        assert!(came["received"]["events"].as_u64() >= Some(2), "{came}");
        assert_eq!(relay_fault(place)["state"], "repaired");
    }
    // A server in the environment is as good as one on the command line.
    let mut asked = one.command(&["faults", "list", "--state", "repaired", "--json"]);
    let said =
        crate::common::Said::from(asked.env("PTU_DB", &server).output().expect("ptu starts"));
    assert!(said.exits(0).out.contains(fault));
}

#[test]
fn a_server_that_cannot_be_used_is_named_with_the_exit_code_of_the_contract() {
    let place = Place::new();
    place.recorded_run();
    let away = format!("postgres://kim@127.0.0.1:{}/h?sslmode=disable", free_port());
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
        let mut asked = place.command(&["runs", "list"]);
        let said =
            crate::common::Said::from(asked.env("PTU_DB", address).output().expect("ptu starts"));
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

/// Goal: a technician syncs from the window, sees when that was, and which fault two people disagree about. Method: two
/// laptops saw one unit; at the desk its fault is closed, on the other laptop it is repaired; then the window syncs.
#[test]
fn the_window_syncs_and_names_conflicts_and_the_last_sync() {
    for language in Language::ALL {
        let words = language.words();
        let server = shared().database();
        let (one, two) = (Place::new(), Place::new());
        record_bad_unit(&one);
        one.ptu(&["db", "sync", &server]).exits(0);
        // The other laptop has the same history, and decides differently.
        two.ptu(&["db", "import", &one.text_path("history.db")])
            .exits(0);
        let fault = text(&relay_fault(&one)["id"]).to_owned();
        two.ptu(&["faults", "state", &fault, "closed", "--who", "Lee"])
            .exits(0);
        two.ptu(&["db", "sync", &server]).exits(0);
        one.ptu(&["faults", "state", &fault, "acknowledged", "--who", "Kim"])
            .exits(0);

        let settings = Settings {
            language,
            server: server.clone(),
            ..settings(Page::Faults)
        };
        let mut window = Window::with(one, scripts(), settings);
        window.click(words.care.title);
        let last = words
            .care
            .last_synced
            .split("{at}")
            .next()
            .unwrap_or_default();
        window.wait_for_part(last);
        window.click(words.care.sync);
        let synced = words.care.synced.split("{runs}").next().unwrap_or_default();
        let failed = words.care.failed;
        window.until("a sync", |window| {
            window.shows_part(synced) || window.shows_part(failed)
        });
        assert!(window.shows_part(synced), "{:#?}", window.shown());
        let unit = fill(words.care.conflict, &[("unit", &"BAD-1")]);
        let conflict = unit.split("{fault}").next().unwrap_or_default();
        window.wait_for_part(conflict);
        for (who, state) in [
            ("Lee", words.common.closed),
            ("Kim", words.common.acknowledged),
        ] {
            let said = fill(words.care.says, &[("who", &who), ("state", &state)]);
            assert!(window.shows_part(&said), "{said}: {:#?}", window.shown());
        }
        // All is there: nothing waits, and the address is remembered as it was typed.
        let none = words
            .care
            .last_synced
            .split("{server}")
            .last()
            .unwrap_or_default();
        window.wait_for_part(&fill(none, &[("n", &0)]));
        let synced = window.place.json(&["db", "sync", &server, "--json"]);
        assert_eq!(synced["sent"]["events"], 0, "{synced}");
    }
}

/// Goal: at the desk a server's history is looked through in the window, and nobody writes into it by mistake. Method: a laptop
/// has synced a repaired fault; the window on the server shows it, its life and the statistics, and says why it records nothing.
#[test]
fn the_window_reads_a_server_and_says_why_it_writes_nothing() {
    let server = shared().database();
    let place = Place::new();
    record_bad_unit(&place);
    let fault = text(&relay_fault(&place)["id"]).to_owned();
    let repair = [
        "faults", "repair", &fault, "--part", "eb_relay", "--new", "SN-77", "--who", "Kim",
    ];
    place.ptu(&repair).exits(0);
    place.ptu(&["db", "sync", &server]).exits(0);
    // A unit is not connected to a window that could not record what it does.
    let unit = ["gui", "--unit", "sim", "--db", &server];
    place.ptu(&unit).exits(2).explains(&["server", "--unit"]);
    for language in Language::ALL {
        let words = language.words();
        let settings = Settings {
            language,
            operator: "Kim".into(),
            operator_at_us: ptu_bench::clock::now_us(),
            ..settings(Page::Faults)
        };
        let here = Place::new();
        let mut window = Window::on_server(&server, here, settings);
        let relay = match language {
            Language::English => "EB relay · ",
            Language::Korean => "비상제동 계전기 · ",
        };
        window.click_part(relay);
        window.wait_for("SN-77");
        window.wait_for(words.care.is_server);
        assert!(!window.shows(words.faults.verify), "{:#?}", window.shown());
        assert!(!window.enabled(words.frame.connect) && !window.enabled(words.memory.import));
        assert_eq!(complaints(&mut window), Vec::<String>::new());
        window.key(Page::Case.key());
        window.wait_for(words.care.is_server);
        window.key(eframe::egui::Key::F9);
        window.step();
        window.wait_for(words.frame.not_connected);
        window.key(Page::Statistics.key());
        window.wait_for_part(relay.trim_end_matches(" · "));
        window.key(Page::Report.key());
        window.wait_for(words.report.write_pdf);
        assert!(!window.enabled(words.report.note_save));
        window.key(Page::Traces.key());
        window.wait_for(words.traces.events);
        window.key(Page::Faults.key());
        window.click("SN-77");
        window.wait_for(words.life.units_of_part);
        window.click(words.care.title);
        window.click(words.care.check);
        let sound = words.care.sound.split('{').next().unwrap_or_default();
        window.wait_for_part(sound);
        assert!(!window.shows(words.care.sync));
    }
    let faults = place.json(&["faults", "list", "--json", "--db", &server]);
    let here = place.json(&["faults", "list", "--json"]);
    assert_eq!(faults, here, "nothing was written");
}
