//! The whole acceptance suite on the simulated unit: it passes, it is recorded as it was planned, and
//! the same seed gives the same record.

use std::collections::BTreeSet;
use std::sync::OnceLock;

use crate::common::{Place, list, normalised, number, text};
use fuzzing::draw;
use serde_json::Value;

/// Breaks the unit at random, so that a record depends on its seed.
const RANDOM_FAULT: &str = "fsk_board.receiver_errors";
/// One run of everything, shared by the tests that only look at it.
fn whole_suite() -> &'static (Place, Value) {
    static SUITE: OnceLock<(Place, Value)> = OnceLock::new();
    SUITE.get_or_init(|| {
        let place = Place::new();
        let (said, report) = place.run("");
        said.exits(0);
        (place, report)
    })
}

/// A run of everything on a fresh database, normalised.
fn report_of(exit: i32, arguments: &[&str]) -> Value {
    let (said, report) = Place::new().run(arguments);
    said.exits(exit);
    normalised(report)
}

#[test]
fn a_good_unit_passes_every_step_and_leaves_no_fault() {
    let (place, report) = whole_suite();
    assert_eq!(report["run"]["verdict"], "passed");
    for step in list(&report["steps"]) {
        assert_eq!(step["verdict"], "passed", "{step}");
    }
    assert!(list(&report["faults"]).is_empty(), "{}", report["faults"]);
    assert!(list(&place.json("faults list --json")).is_empty());
}

/// Goal: units of other types of signalling, with slow codes and with codes that shift their carrier, pass the suite and the
/// departure test by their configuration alone.
#[test]
fn units_with_other_codes_pass_by_their_configuration() {
    let place = Place::new();
    for name in ["us_cab", "zpw2000"] {
        for what in ["", "departure "] {
            let (said, report) = place.run(&format!("{what}--unit-config {name}"));
            said.exits(0);
            assert!(list(&report["faults"]).is_empty(), "{}", report["faults"]);
        }
    }
}

/// Goal: another type of unit passes all procedures by its configuration alone, and what its rules add is tested.
#[test]
fn a_unit_of_another_type_passes_every_step_by_its_configuration() {
    let place = Place::new();
    let (said, report) = place.run("--unit-config seoul34");
    said.exits(0);
    let steps = list(&report["steps"]);
    for step in steps {
        // The record of the embedded unit's train names the other type.
        let expected = match text(&step["procedure"]) {
            "ptu/identity" => "skipped",
            _ => "passed",
        };
        assert_eq!(step["verdict"], expected, "{step}");
    }
    assert!(list(&report["faults"]).is_empty(), "{}", report["faults"]);
    let procedures = |steps: &[Value]| -> BTreeSet<String> {
        let names = steps.iter().map(|step| text(&step["procedure"]).to_owned());
        names.collect()
    };
    let (_, of_sg100) = whole_suite();
    let of_sg100 = list(&of_sg100["steps"]);
    assert_eq!(procedures(steps), procedures(of_sg100));
    for name in [
        "code Y25 gives 0 km/h",
        "code 100 gives 100 km/h",
        "a brake notch under way acknowledges nothing",
        "the warning of stop and proceed comes again and again",
        "far beyond the limit, a brake that slows the train too little",
        "code YC ends the yard",
    ] {
        let has = |steps: &[Value]| steps.iter().any(|step| text(&step["name"]) == name);
        assert!(has(steps) && !has(of_sg100), "{name}");
    }
}

/// The time to the nearest five minutes.
#[test]
fn the_readme_tells_how_many_procedures_there_are_and_how_long_they_take() {
    let (_, report) = whole_suite();
    let procedures = list(&report["steps"]).iter();
    let procedures: BTreeSet<_> = procedures.map(|step| text(&step["procedure"])).collect();
    let minutes = number(&report["run"]["bench_time_s"]) / 60.0;
    let nearest = (minutes / 5.0).round() * 5.0;
    let count = procedures.len();
    let told = format!("{count} procedures, about {nearest} minutes of bench time");
    assert!(include_str!("../../../README.md").contains(&told), "{told}");
}

/// Goal: what was listed before is what ran and what was stored, measurements included.
#[test]
fn every_listed_step_is_reported_with_its_measurements() {
    let (place, report) = whole_suite();
    let mut planned = Vec::new();
    for procedure in list(&place.json("run --list --json")) {
        for step in list(&procedure["steps"]) {
            for _ in 0..number(&step["repeat"]) as u32 {
                planned.push((
                    text(&procedure["procedure"]).to_owned(),
                    text(&step["name"]).to_owned(),
                ));
            }
        }
    }
    let steps = list(&report["steps"]);
    let reported: Vec<_> = steps
        .iter()
        .map(|s| {
            (
                text(&s["procedure"]).to_owned(),
                text(&s["name"]).to_owned(),
            )
        })
        .collect();
    assert_eq!(reported, planned);

    let listing = place.ptu("run --list --steps").exits(0).out;
    let planned = listing
        .lines()
        .filter(|line| line.trim_start().starts_with("measure "))
        .count();
    let measurements = steps.iter().flat_map(|step| list(&step["measurements"]));
    let mut count = 0;
    for measurement in measurements {
        assert!(number(&measurement["value"]).is_finite(), "{measurement}");
        assert_eq!(measurement["verdict"], "passed", "{measurement}");
        count += 1;
    }
    assert!(planned > 0);
    assert_eq!(count, planned);
}

#[test]
fn the_same_seed_gives_the_same_results() {
    let (_, first) = whole_suite();
    assert_eq!(report_of(0, &[]), normalised(first.clone()));
}

/// A unit broken at random makes the comparison worth something: here the seed matters, and no processor does.
#[test]
fn the_same_seed_gives_the_same_faults_side_by_side_or_not_and_another_seed_others() {
    let faults_of = |more: &[&str]| report_of(1, &[&["--inject", RANDOM_FAULT], more].concat());
    let one = faults_of(&["--seed", "7", "--jobs", "1"]);
    let two = faults_of(&["--seed", "7", "--jobs", "2"]);
    assert!(!list(&one["faults"]).is_empty());
    assert_eq!(one, two);
    let other = faults_of(&["--seed", "8"]);
    assert_ne!(one["steps"], other["steps"]);
}

#[test]
fn other_seeds_pass_too() {
    for seed in draw::drawn(["2", "20261121", "18446744073709551615"], 3) {
        let report = report_of(0, &["--seed", seed]);
        assert!(list(&report["faults"]).is_empty());
    }
}

/// Goal: which failure is the first is a matter of the order of the procedures, not of who is done first.
#[test]
fn a_run_can_end_with_the_first_failure() {
    let early = ["--inject", "eb_relay.slow", "--stop-on-fail", "--jobs"];
    let ends_early = |jobs| report_of(1, &[&early[..], &[jobs]].concat());
    let report = ends_early("1");
    let failed: Vec<_> = list(&report["steps"])
        .iter()
        .filter(|step| step["verdict"] == "failed")
        .collect();
    assert_eq!(failed.len(), 1, "{failed:?}");
    let last = list(&report["steps"]).last().expect("a step");
    assert_eq!(last["procedure"], failed[0]["procedure"]);
    assert_eq!(ends_early("3"), report);
}

/// Goal: what is run again and in another order is neither of them a finding. Method: everything twice, in two
/// orders, of which a check runs one; what is listed is what is run.
#[test]
fn a_good_unit_passes_everything_repeated_and_in_any_order() {
    let place = Place::new();
    let order = |steps: &Value| {
        let mut names: Vec<_> = list(steps)
            .iter()
            .map(|s| text(&s["procedure"]).to_owned())
            .collect();
        names.dedup();
        names
    };
    let usual = order(&whole_suite().1["steps"]);
    let asked = |seed| ["--repeat", "2", "--shuffle", "--seed", seed];
    let listed =
        |seed| order(&place.json(&[&["run", "--list", "--json"], &asked(seed)[..]].concat()));
    let seeds = ["1", "2"];
    for seed in draw::drawn(seeds, 2) {
        let (said, report) = place.run(&asked(seed));
        said.exits(0);
        assert!(list(&report["faults"]).is_empty());
        assert_eq!(order(&report["steps"]), listed(seed));
        assert_eq!(
            list(&report["steps"]).len(),
            2 * list(&whole_suite().1["steps"]).len()
        );
    }
    let orders = seeds.map(listed);
    assert_ne!(orders[0], orders[1]);
    for mut order in orders {
        assert_ne!(order, usual);
        order.sort();
        assert_eq!(order, usual, "each once");
    }
}
