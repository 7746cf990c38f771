//! Questions about the history as a depot asks them, from the first fault to the closed one.

mod common;

use common::{Place, list, number, relay_fault, text};

/// A unit of train 8203 with a slow relay, which is repaired, proven by a run and closed.
fn mended() -> Place {
    let place = Place::new();
    let unit = "run atp/overspeed --serial-no BAD-1 --train-no 8203";
    let unit: Vec<_> = unit.split(' ').collect();
    let slow = [&unit[..], &["--inject", "eb_relay.slow"]].concat();
    place.ptu(&slow).exits(1);
    let fault = relay_fault(&place);
    let id = text(&fault["id"]);
    let repair = [
        "faults",
        "repair",
        id,
        "--part",
        "EB_relay",
        "--old",
        "R-17",
        "--new",
        "R/99_b",
        "--who",
        "김",
        "--note",
        "비상제동 릴레이 교체함",
    ];
    place.ptu(&repair).exits(0);
    place.ptu(&unit).exits(0);
    place
}

#[test]
fn a_repair_is_verified_by_the_run_that_passes_and_then_closed() {
    let place = mended();
    let fault = relay_fault(&place);
    assert_eq!(fault["state"], "verified");
    let id = text(&fault["id"]);
    let shown = place.ptu(&["faults", "show", id]).exits(0).out;
    assert!(
        shown.contains("passed in run ") && shown.contains("R-17 → R/99_b"),
        "{shown}"
    );
    place
        .ptu(&["faults", "note", id, "released to service", "--who", "Lee"])
        .exits(0);
    place
        .ptu(&["faults", "state", id, "closed", "--who", "Lee"])
        .exits(0);
    let stats = place.json(&[
        "faults", "stats", "--by", "lru", "--lru", "eb_relay", "--json",
    ]);
    let relay = &stats[0];
    for (key, value) in [
        ("faults", 1.0),
        ("not_closed", 0.0),
        ("repairs", 1.0),
        ("closed", 1.0),
        ("no_fault_found", 0.0),
        ("units", 1.0),
        // Nobody knows yet whether it holds.
        ("repairs_judged", 0.0),
    ] {
        assert_eq!(number(&relay[key]), value, "{key} of {relay}");
    }
    assert!(number(&relay["mttr_hours"]) < 1.0, "{relay}");
    // The same again is a new fault, and the repair did not hold.
    place
        .ptu(&[
            "run",
            "atp/overspeed",
            "--serial-no",
            "BAD-1",
            "--inject",
            "eb_relay.slow",
        ])
        .exits(1);
    let stats = place.json(&[
        "faults", "stats", "--by", "lru", "--lru", "eb_relay", "--json",
    ]);
    assert_eq!(
        (
            number(&stats[0]["faults"]),
            number(&stats[0]["repairs_back"])
        ),
        (2.0, 1.0),
        "{stats}"
    );
}

#[test]
fn faults_are_found_by_what_people_know() {
    let place = mended();
    let found = |options: &[&str]| {
        let faults = place.json(&[&["faults", "list", "--json"], options].concat());
        list(&faults).iter().any(|fault| fault["lru"] == "eb_relay")
    };
    let today = ["--when", "today"];
    for options in [
        &["--note", "릴레이"][..],
        &["--note", "교체"],
        &["--note", "비상제동 교체"],
        &["--note", "R-17"],
        &["--serial", "R-17"],
        &["--serial", "R/99_b"],
        &["--train", "8203"],
        &["--lru", "EB_RELAY"],
        &["--procedure", "atp/overspeed"],
        &["--unit", "BAD-1", "--state", "verified"],
        &["--when", "2026..", "--line", "line8"],
        &today,
    ] {
        assert!(found(options), "{options:?}");
    }
    for options in [
        &["--note", "릴레이 브레이크"][..],
        &["--serial", "R-1"],
        &["--serial", "R/99"],
        &["--train", "8204"],
        &["--procedure", "atp/receiver"],
        &["--state", "closed"],
        &["--when", "..2020"],
        &["--line", "line1"],
    ] {
        assert!(!found(options), "{options:?}");
    }
}

#[test]
fn counts_come_as_table_json_and_csv() {
    let place = mended();
    for by in ["code", "lru", "unit", "line", "month"] {
        let json = place.json(&["faults", "stats", "--by", by, "--json"]);
        let csv = place
            .ptu(&["faults", "stats", "--by", by, "--csv"])
            .exits(0)
            .out;
        let mut lines = csv.lines();
        let heading = lines.next().expect("a heading");
        assert!(
            heading.starts_with("key,name,faults,not_closed,occurrences,share"),
            "{heading}"
        );
        assert_eq!(lines.count(), list(&json).len(), "{csv}");
        let table = place.ptu(&["faults", "stats", "--by", by]).exits(0).out;
        assert!(
            table.contains("MTBF") && table.contains("within 30 days"),
            "{table}"
        );
        let seen: f64 = list(&json)
            .iter()
            .map(|row| number(&row["occurrences"]))
            .sum();
        let all = place.json(&["db", "query", "SELECT count(*) FROM occurrences", "--json"]);
        assert_eq!(seen, number(&all["rows"][0][0]), "{by}");
    }
    let csv = place.ptu(&["faults", "list", "--csv"]).exits(0).out;
    assert!(csv.starts_with("id,"), "{csv}");
}

#[test]
fn a_trend_says_where_a_measurement_is_going() {
    let place = mended();
    let of_overspeed = [
        "faults",
        "trend",
        "eb_reaction",
        "--procedure",
        "atp/overspeed",
    ];
    let trend = place.json(&[&of_overspeed[..], &["--unit", "BAD-1", "--json"]].concat());
    let points = list(&trend["points"]).len() as f64;
    assert!(points >= 8.0, "{trend}");
    assert_eq!(number(&trend["process"]["n"]), points);
    assert!(number(&trend["capability"]["cpk"]).is_finite());
    let fleet = place.json(&[&of_overspeed[..], &["--json"]].concat());
    assert_eq!(number(&fleet["process"]["n"]), points);
    assert_eq!(fleet["process"]["mean"], trend["process"]["mean"]);
    assert_eq!(list(&fleet["units"]).len(), 1);
    let text = place.ptu(
        &[
            &of_overspeed[..],
            &["--unit", "BAD-1", "--plot", "creep.html"],
        ]
        .concat(),
    );
    let text = text.exits(0).out;
    assert!(
        text.contains("control limits") && text.contains("Cpk"),
        "{text}"
    );
    assert!(place.read("creep.html").contains("<svg"));
    let since = place.json(
        &[
            &of_overspeed[..],
            &["--unit", "BAD-1", "--since-repair", "eb_relay", "--json"],
        ]
        .concat(),
    );
    assert!(number(&since["process"]["n"]) < points, "{since}");
}

#[test]
fn a_question_is_saved_and_asked_again() {
    let place = mended();
    let said = place
        .ptu(&[
            "faults", "stats", "--by", "lru", "--when", "30d", "--save", "worst",
        ])
        .exits(0);
    assert!(
        place
            .ptu(&["saved"])
            .exits(0)
            .out
            .contains("ptu faults stats --by lru --when 30d")
    );
    assert_eq!(place.ptu(&["saved", "worst"]).exits(0).out, said.out);
    let csv = place.ptu(&["saved", "worst", "--csv"]).exits(0).out;
    assert!(csv.starts_with("key,"), "{csv}");
    let sql = "SELECT part, serial_new FROM repairs WHERE note <> ''";
    place.ptu(&["db", "query", sql, "--save", "parts"]).exits(0);
    assert!(
        place
            .ptu(&["saved", "parts"])
            .exits(0)
            .out
            .contains("R/99_b")
    );
    place.ptu(&["saved", "wort"]).exits(2).explains(&[
        "no question \"wort\"",
        "\"worst\"",
        "`ptu saved`",
    ]);
    place
        .ptu(&["saved", "worst", "--save", "worst"])
        .exits(2)
        .explains(&["is saved already"]);
    place.ptu(&["saved", "worst"]).exits(0);
    place.ptu(&["saved", "--forget", "worst"]).exits(0);
    place.ptu(&["saved", "worst"]).exits(2);
}

#[test]
fn the_views_answer_and_the_page_tells_of_them() {
    let place = mended();
    let page = place.ptu(&["db", "schema"]).exits(0).out;
    for view in page
        .lines()
        .filter_map(|line| line.strip_prefix("## ")?.split_once(':'))
    {
        let sql = format!("SELECT * FROM {} LIMIT 3", view.0);
        let answer = place.json(&["db", "query", &sql, "--json"]);
        assert!(list(&answer["columns"]).len() > 4, "{}: {answer}", view.0);
    }
    let relay = relay_fault(&place);
    let sql = format!(
        "SELECT last_at, name FROM faults WHERE id = '{}'",
        text(&relay["id"])
    );
    let answer = place.json(&["db", "query", &sql, "--json"]);
    assert_eq!(answer["rows"][0][0], relay["last_at"]);
    let csv = place
        .ptu(&["db", "query", "SELECT 1 AS a, 'x,y' AS b", "--csv"])
        .exits(0)
        .out;
    assert_eq!(csv, "a,b\n1,\"x,y\"\n");
}

#[test]
fn what_cannot_be_asked_is_named() {
    let place = mended();
    for (arguments, words) in [
        (
            &["list", "--when", "2026-13"][..],
            &["2026-13", "2026-03..2026-05"][..],
        ),
        (
            &["list", "--when", "2026-05..2026-03"],
            &["ends before it begins"],
        ),
        (&["stats", "--when", ".."], &["a beginning or an end"]),
        (&["stats", "--by", "colour"], &["colour", "lru"]),
        (&["stats", "--back-within", "0"], &["0"]),
        (&["list", "--note", "\"*"], &["no word to search for"]),
        (&["list", "--state", "broken"], &["broken", "acknowledged"]),
        (&["list", "--unit", "BAD-2"], &["no unit \"BAD-2\""]),
        (&["list", "--run", "latest", "--since", "x"], &["\"x\""]),
        (&["list", "--since", "2026-03..2026-05"], &["is a span"]),
        (
            &[
                "trend",
                "eb_reaction",
                "--unit",
                "BAD-1",
                "--since-repair",
                "tra",
            ],
            &["no repair of tra", "BAD-1"],
        ),
        (
            &["trend", "eb_reaction", "--since-repair", "tra"],
            &["--unit"],
        ),
        (&["repair", "latest", "--part", " "], &["--part"]),
        (&["note", "latest", " "], &["says something"]),
        (&["list", "--json", "--csv"], &["--csv"]),
    ] {
        place
            .ptu(&[&["faults"], arguments].concat())
            .exits(2)
            .explains(words);
    }
    let hint = place
        .ptu(&["faults", "list", "--lru", "eb_rely"])
        .exits(0)
        .out;
    assert!(hint.contains("did you mean \"eb_relay\"?"), "{hint}");
}
