//! The history: what runs and faults left behind is listed, shown, counted, kept and carried along.

use std::sync::OnceLock;

use crate::common::{Place, has_shape, list, number, record_bad_unit, relay_fault, text};
use serde_json::Value;

const FAULT: [(&str, &str); 10] = [
    ("id", "text"),
    ("code", "number"),
    ("name", "text"),
    ("part", "text"),
    ("severity", "text"),
    ("first_at", "text"),
    ("last_at", "text"),
    ("occurrences", "number"),
    ("state", "text"),
    ("trace_id", "text?"),
];

/// A good and a bad unit tested one after the other, for tests that only look.
fn history() -> &'static Place {
    static HISTORY: OnceLock<Place> = OnceLock::new();
    HISTORY.get_or_init(|| {
        let place = Place::new();
        place.ptu(&["run", "--serial-no", "GOOD-1"]).exits(0);
        record_bad_unit(&place);
        place
    })
}

#[test]
fn runs_are_listed_newest_first_and_filtered() {
    let place = history();
    let runs = place.json(&["runs", "list", "--json"]);
    let units: Vec<_> = list(&runs)
        .iter()
        .map(|r| text(&r["unit_serial"]))
        .collect();
    assert_eq!(units, ["BAD-1", "GOOD-1"]);
    assert_eq!(runs[0]["operator"], "Kim");
    assert_eq!(runs[0]["injected"], "eb_relay.slow");
    assert_eq!(runs[0]["verdict"], "failed");
    for run in list(&runs) {
        has_shape(
            run,
            &[
                ("id", "text"),
                ("verdict", "text?"),
                ("unit_serial", "text"),
                ("line", "text"),
                ("seed", "number"),
                ("started_at", "text"),
                ("bench_time_s", "number?"),
                ("wall_time_s", "number?"),
            ],
        );
    }
    for (filter, count) in [
        (["--serial-no", "GOOD-1"], 1),
        (["--verdict", "failed"], 1),
        (["--when", "1d"], 2),
        (["--limit", "1"], 1),
        (["--when", "2999-01"], 0),
    ] {
        let found = place.json(&[&["runs", "list", "--json"], &filter[..]].concat());
        assert_eq!(list(&found).len(), count, "{filter:?}");
    }
    let table = place.ptu(&["runs", "list"]).exits(0).out;
    assert!(
        table.contains("GOOD-1") && table.contains("failed"),
        "{table}"
    );
}

#[test]
fn faults_are_listed_and_filtered() {
    let place = history();
    let faults = place.json(&["faults", "list", "--json"]);
    assert!(!list(&faults).is_empty());
    for fault in list(&faults) {
        has_shape(fault, &FAULT);
        assert_eq!(fault["unit_serial"], "BAD-1");
        assert_eq!(fault["state"], "open");
    }
    let all = list(&faults).len();
    for (filter, count) in [
        (["--serial-no", "BAD-1"], all),
        (["--serial-no", "GOOD-1"], 0),
        (["--code", "check_failed"], all),
        (["--code", "9000"], all),
        (["--part", "eb_relay"], 1),
        (["--severity", "minor"], 0),
        (["--state", "open"], all),
        (["--state", "closed"], 0),
        (["--run", "latest"], all),
        (["--when", "12h"], all),
        (["--limit", "1"], 1),
    ] {
        let found = place.json(&[&["faults", "list", "--json"], &filter[..]].concat());
        assert_eq!(list(&found).len(), count, "{filter:?}");
    }
    let table = place.ptu(&["faults", "list"]).exits(0).out;
    assert!(
        table.contains("eb_relay") && table.contains("check_failed"),
        "{table}"
    );
}

#[test]
fn a_fault_is_shown_with_its_occurrences_and_freeze_frame() {
    let place = history();
    let listed = relay_fault(place);
    let id = text(&listed["id"]);
    let fault = place.json(&["faults", "show", id, "--json"]);
    has_shape(&fault, &FAULT);
    let seen = list(&fault["occurrence_list"]);
    assert_eq!(seen.len() as f64, number(&listed["occurrences"]));
    let signals = place.json(&["catalog", "signals", "--json"]);
    for occurrence in seen {
        has_shape(
            occurrence,
            &[
                ("run_id", "text"),
                ("at", "text"),
                ("message", "text"),
                ("trace_id", "text"),
            ],
        );
        assert!(
            text(&occurrence["message"]).contains("eb_reaction"),
            "{occurrence}"
        );
        assert_eq!(
            list(&occurrence["freeze_frame"]).len(),
            list(&signals).len()
        );
    }
    let shown = place
        .ptu(&["faults", "show", &id[id.len() - 8..]])
        .exits(0)
        .out;
    assert!(
        shown.contains("EB reaction = ") && shown.contains("freeze frame"),
        "{shown}"
    );
}

#[test]
fn faults_are_counted_by_code_and_by_part() {
    let place = history();
    let faults = place.json(&["faults", "list", "--json"]);
    for (by, key) in [("part", "eb_relay"), ("code", "9000")] {
        let stats = place.json(&["faults", "stats", "--by", by, "--json"]);
        for stat in list(&stats) {
            has_shape(
                stat,
                &[
                    ("key", "text"),
                    ("faults", "number"),
                    ("not_closed", "number"),
                    ("occurrences", "number"),
                    ("units", "number"),
                    ("last_at", "text"),
                ],
            );
        }
        assert!(
            list(&stats).iter().any(|stat| stat["key"] == key),
            "{stats}"
        );
        let sum = |key: &str| list(&stats).iter().map(|s| number(&s[key])).sum::<f64>();
        assert_eq!(sum("faults") as usize, list(&faults).len());
        let seen: f64 = list(&faults)
            .iter()
            .map(|f| number(&f["occurrences"]))
            .sum();
        assert_eq!(sum("occurrences"), seen);
        place.ptu(&["faults", "stats", "--by", by]).exits(0);
    }
}

/// Goal: the drift of a measurement from unit to unit shows: the slow relay adds its 400 ms.
#[test]
fn a_measurement_is_shown_over_time() {
    let place = history();
    let mean = |unit: &str| {
        let trend = place.json(&[
            "faults",
            "trend",
            "eb_reaction",
            "--serial-no",
            unit,
            "--json",
        ]);
        let overspeed: Vec<_> = list(&trend["points"])
            .iter()
            .filter(|p| (450.0..600.0).contains(&number(&p["high"])))
            .collect();
        for point in &overspeed {
            has_shape(
                point,
                &[
                    ("at", "text"),
                    ("run_id", "text"),
                    ("unit_serial", "text"),
                    ("value", "number"),
                    ("unit", "text"),
                    ("verdict", "text"),
                ],
            );
        }
        let sum: f64 = overspeed.iter().map(|point| number(&point["value"])).sum();
        sum / overspeed.len() as f64
    };
    let slower = mean("BAD-1") - mean("GOOD-1");
    assert!((350.0..=450.0).contains(&slower), "{slower} ms slower");
    place.ptu(&["faults", "trend", "eb_reaction"]).exits(0);
}

#[test]
fn a_trace_is_shown_and_exported() {
    let place = history();
    let trace = place.json(&["trace", "show", "latest", "--json"]);
    has_shape(
        &trace,
        &[
            ("id", "text"),
            ("period_ms", "number"),
            ("rows", "number"),
            ("trigger_row", "number"),
            ("partial", "bool"),
            ("signals", "list"),
        ],
    );
    let two = place.json(&["trace", "show", "latest", "--signal", "speed,eb", "--json"]);
    let names: Vec<_> = list(&two["signals"])
        .iter()
        .map(|c| text(&c["name"]))
        .collect();
    assert_eq!(names, ["speed", "eb"]);
    let plot = place.ptu(&["trace", "show", "latest"]).exits(0).out;
    assert!(
        plot.contains("before the trigger") && plot.contains('▼'),
        "{plot}"
    );

    place
        .ptu(&["trace", "export", "latest", "--out", "trace.csv"])
        .exits(0);
    let csv = place.read("trace.csv");
    let mut lines = csv.lines();
    let headings: Vec<_> = lines.next().expect("headings").split(',').collect();
    assert_eq!(headings[0], "time_s");
    assert_eq!(headings.len(), list(&trace["signals"]).len() + 1);
    assert!(headings.contains(&"limit_kmh"), "{headings:?}");
    let times: Vec<f64> = lines
        .map(|line| {
            line.split(',')
                .next()
                .and_then(|t| t.parse().ok())
                .expect("a time")
        })
        .collect();
    assert_eq!(times.len() as f64, number(&trace["rows"]));
    assert_eq!(times[number(&trace["trigger_row"]) as usize], 0.0);
    place
        .ptu(&["trace", "show", "latest", "--signal", "speeed"])
        .exits(2)
        .explains(&["speeed"]);
}

#[test]
fn what_there_is_to_name_is_catalogued() {
    let place = Place::new();
    for (what, keys) in [
        ("faults", &["id", "part", "mode", "severity"][..]),
        ("signals", &["name", "unit", "kind", "from", "about"]),
        ("codes", &["name"]),
        ("lines", &["line"]),
        ("parts", &["id", "name", "name_ko"]),
        ("train", &["name", "role"]),
    ] {
        let entries = place.json(&["catalog", what, "--json"]);
        assert!(!list(&entries).is_empty(), "{what}");
        for entry in list(&entries) {
            let shape: Vec<_> = keys.iter().map(|key| (*key, "text")).collect();
            has_shape(entry, &shape);
        }
        let rows = place.ptu(&["catalog", what]).exits(0).out.lines().count();
        assert_eq!(rows, list(&entries).len() + 1, "{what}");
    }
    // Cars by the number that faults, verbs and events name them by, bits by the words of scripts.
    let table = place.ptu(&["catalog", "train"]).exits(0).out;
    let first: Vec<_> = table.lines().take(2).map(str::split_whitespace).collect();
    let first: Vec<Vec<_>> = first.into_iter().map(|row| row.take(2).collect()).collect();
    assert_eq!(first, [["car", "name"], ["1", "TC1"]]);
    let signals = place.json(&["catalog", "signals", "--json"]);
    let bits = |name: &str| {
        let found = list(&signals).iter().find(|signal| signal["name"] == name);
        found.map(|signal| signal["bits"].clone()).expect(name)
    };
    assert_eq!(bits("eb_sources")[3], "atc");
    assert_eq!(bits("lamps")[6], "failure");
    assert_eq!(bits("not_released")[1], "car 2");
    assert_eq!(bits("speed"), Value::Null);
}

/// Goal: a first-time user is told what to do, not shown an error's innards.
#[test]
fn without_any_history_the_next_move_is_said() {
    let place = Place::new();
    for question in [
        &["runs", "list"][..],
        &["faults", "list"],
        &["trace", "show", "latest"],
    ] {
        place
            .ptu(question)
            .exits(3)
            .explains(&["history.db", "a first run creates it"]);
    }
    place.ptu(&["runn"]).exits(2).explains(&["runn", "'run'"]);
}
