//! Driving by hand from the command line: the figures of S3, files that are refused, reports.

use crate::common::terminal::Terminal;
use crate::common::{Place, has, has_shape, list, number, scripts, text};
use rustix::process::Signal;
use serde_json::Value;

/// Keys of a run that others rely on, and the kinds of their values.
const RUN: [(&str, &str); 19] = [
    ("sequence", "text"),
    ("title", "text"),
    ("line", "text"),
    ("section", "number"),
    ("train", "text"),
    ("code", "text"),
    ("load_kg", "number"),
    ("ending", "text"),
    ("passed", "bool"),
    ("accel_0_35_kmh_s", "number?"),
    ("accel_5_35_kmh_s", "number?"),
    ("decel_60_20_kmh_s", "number?"),
    ("brake_60_20_kmh_s", "number?"),
    ("max_te_n", "number"),
    ("max_brake_demand_n", "number"),
    ("full_service_n", "number"),
    ("max_deviation_share", "number?"),
    ("steps", "list"),
    ("events", "list"),
];

/// JSON of a sequence that is driven to its end.
fn driven(place: &Place, sequence: &str) -> Value {
    let run = place.json(&["drive", "--manual", sequence, "--json"]);
    has_shape(&run, &RUN);
    assert_eq!(
        (text(&run["ending"]), &run["passed"]),
        ("all steps done", &true.into())
    );
    run
}

/// The step that did `what`.
fn step<'a>(run: &'a Value, what: &str) -> &'a Value {
    let found = list(&run["steps"])
        .iter()
        .find(|step| text(&step["what"]) == what);
    found.unwrap_or_else(|| panic!("no step \"{what}\" in {run}"))
}

/// An effort of MT pair 1 3 s after a step, kN.
fn pair1(run: &Value, what: &str, effort: &str) -> f64 {
    number(&step(run, what)["pair1_later"][effort]) / 1000.0
}

#[track_caller]
fn near(value: f64, printed: f64, share: f64) {
    assert!(
        (value / printed - 1.0).abs() <= share,
        "{value}, printed {printed}"
    );
}

/// Figure 5 and its empty half: what S3 prints and calculates, within the 3 % of its accelerations
/// and the 2 % of its blending.
#[test]
fn figure_5_shows_powering_and_braking_full_and_empty() {
    let place = Place::new();
    let full = driven(&place, "figure5");
    near(pair1(&full, "P4", "te_n"), 397.8 / 4.0, 0.01);
    near(pair1(&full, "B7", "electric_n"), 87.3, 0.02);
    near(pair1(&full, "B7", "brake_n"), 110.9, 0.02);
    near(pair1(&full, "B7", "air_t_n"), 23.6, 0.1);
    assert!(pair1(&full, "B7", "air_m_n") < 1.0, "trailers first");
    near(number(&full["max_te_n"]), 397_800.0, 0.01);
    near(number(&full["full_service_n"]), 443_691.0, 1e-5);
    near(number(&full["max_brake_demand_n"]), 443_691.0, 0.001);
    let empty = driven(&place, "figure5_empty");
    near(number(&empty["full_service_n"]), 288_136.0, 1e-5);
    // Load compensation: traction as the braking masses.
    near(
        number(&empty["max_te_n"]),
        397_800.0 * 296_368.0 / 456_368.0,
        0.01,
    );
    for run in [&full, &empty] {
        near(number(&run["accel_5_35_kmh_s"]), 3.0, 0.03);
        near(number(&run["brake_60_20_kmh_s"]), 3.5, 0.03);
        assert!(number(&run["decel_60_20_kmh_s"]) > number(&run["brake_60_20_kmh_s"]));
        assert!(number(&run["max_deviation_share"]).abs() < 0.02, "{run}");
    }
}

/// T1's 11.2 % go to the other pairs, a third each: 16.6 kN more on pair 1, by air.
#[test]
fn figure_6_spreads_a_lost_brake_over_the_other_pairs() {
    let place = Place::new();
    let (whole, cut) = (driven(&place, "figure5"), driven(&place, "figure6"));
    let more = |effort| pair1(&cut, "B7", effort) - pair1(&whole, "B7", effort);
    near(more("brake_n"), 16.6, 0.05);
    near(more("air_t_n") + more("air_m_n"), 16.6, 0.05);
    near(number(&cut["brake_60_20_kmh_s"]), 3.5, 0.03);
    assert!(
        number(&cut["max_deviation_share"]).abs() < 0.02,
        "the whole demand down to a stand, by air alone, too: {cut}"
    );
}

/// Air on trailers and motor cars has the whole demand within a second.
#[test]
fn figure_7_takes_over_by_air_when_regeneration_is_cut_out() {
    let place = Place::new();
    let run = driven(&place, "figure7");
    let cut = step(&run, "regeneration cut-out");
    near(number(&cut["speed_kmh"]), 40.0, 0.01);
    assert!(number(&cut["brake_settled_s"]) <= 1.0, "{cut}");
    assert!(
        number(&cut["brake_worst_share"]) < -0.02,
        "a cut-out is felt: {cut}"
    );
    near(pair1(&run, "regeneration cut-out", "air_t_n"), 54.0, 0.02);
    near(pair1(&run, "regeneration cut-out", "air_m_n"), 56.9, 0.02);
    assert!(pair1(&run, "regeneration cut-out", "electric_n") < 0.5);
    let tcms = list(&run["events"])
        .iter()
        .map(|event| text(&event["what"]));
    assert!(
        tcms.filter(|what| what.starts_with("TCMS: regeneration_cut_out"))
            .count()
            > 0
    );
}

#[test]
fn reports_stand_alone_and_agree() {
    let place = Place::new();
    let reports = [
        "--report", "run.html", "--report", "run.csv", "--report", "run.json",
    ];
    let said = place
        .ptu(&[&["drive", "--manual", "figure7"], &reports[..]].concat())
        .exits(0);
    has(&said.out, &["figure7: all steps done"]);
    let run = place.read_json("run.json");
    has_shape(&run, &RUN);
    let page = place.read("run.html");
    assert_eq!(page.matches("<svg").count(), 5);
    for outside in [
        "http:", "https:", "src=", "<script", "<link", "@import", "url(", "NaN",
    ] {
        assert!(!page.contains(outside), "{outside} in the page");
    }
    let rows = place.read("run.csv");
    let mut lines = rows.lines();
    let head: Vec<_> = lines.next().unwrap_or_default().split(',').collect();
    let te = head
        .iter()
        .position(|name| *name == "pair1_te_n")
        .expect("a column pair1_te_n");
    let cells = lines.map(|row| row.split(',').collect::<Vec<_>>());
    let cells: Vec<_> = cells.collect();
    assert!(cells.iter().all(|row| row.len() == head.len()));
    let most = cells.iter().filter_map(|row| row[te].parse::<f64>().ok());
    near(
        most.fold(0.0, f64::max),
        number(&run["max_te_pair1_n"]),
        1e-6,
    );
}

/// Every sequence of the project can be driven.
#[test]
fn every_sequence_in_the_scripts_plays_to_its_end() {
    let place = Place::new();
    let folder = std::fs::read_dir(scripts().join("manual")).expect("sequences");
    let files = folder.map(|entry| entry.expect("an entry").path().display().to_string());
    let files: Vec<_> = files.collect();
    assert!(files.len() >= 4, "{files:?}");
    for file in files {
        driven(&place, &file);
    }
}

/// Goal: who drives by keys gets the terminal back as it was, however that ends. Method: each polite signal.
#[test]
fn keys_give_the_terminal_back_when_the_drive_is_told_to_end() {
    for signal in [Signal::HUP, Signal::TERM, Signal::INT] {
        let place = Place::new();
        let terminal = Terminal::open();
        let before = terminal.settings();
        let drive = terminal.start(&place.command("drive --manual keys"));
        terminal.until_keys_are_taken();
        assert_eq!(terminal.told(drive, signal), Some(130), "{signal:?}");
        let after = terminal.settings();
        assert_eq!(after.local_modes, before.local_modes, "{signal:?}");
        let codes = |settings: &rustix::termios::Termios| format!("{:?}", settings.special_codes);
        assert_eq!(codes(&after), codes(&before), "{signal:?}");
    }
}
