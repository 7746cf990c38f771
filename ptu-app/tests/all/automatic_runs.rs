//! Automatic operation through the frames, with every controller: each section of each line, empty
//! and full, and stops when something is not as it should be.

use crate::common::{Place, list, number, text};
use fuzzing::draw;
use serde_json::Value;

const CONTROLLERS: [&str; 4] = ["servo", "pi", "fuzzy", "pss"];

/// Runs one procedure with a controller and gives the report; it must pass.
#[track_caller]
fn passes(procedure: &str, line: &str, controller: &str) -> Value {
    let setting = format!("ato.controller={controller}");
    let (said, report) = Place::new().run(&[procedure, "--line", line, "--set", &setting]);
    said.exits(0);
    report
}

/// A third of all controllers on all lines.
fn drawn<T: Copy>(lines: &[T]) -> Vec<(&'static str, T)> {
    let all = CONTROLLERS
        .into_iter()
        .flat_map(|controller| lines.iter().map(move |line| (controller, *line)));
    draw::drawn(all, 3)
}

/// Goal: each controller drives the train through the frames, not only in tests of its own.
#[test]
fn every_controller_runs_the_whole_of_every_line() {
    let lines = [("line8", 12), ("line6", 4), ("test_track", 1)];
    for (controller, (line, sections)) in drawn(&lines) {
        let report = passes("ato/line_run", line, controller);
        // Ready and run, empty and full.
        assert_eq!(list(&report["steps"]).len(), sections * 4);
    }
}

/// Goal: the controllers are different ones: the same section takes each its own time.
#[test]
fn a_setting_changes_the_controller() {
    let run_time = |controller| {
        let report = passes("ato/station_run", "line8", controller);
        let steps = list(&report["steps"]).iter();
        let measurements = steps.flat_map(|step| list(&step["measurements"]));
        let mut times = measurements.filter(|m| m["name"] == "run_time");
        number(&times.next().expect("a run time")["value"])
    };
    assert!(run_time("servo") > run_time("pss") + 5000.0);
}

#[test]
fn every_controller_stops_when_something_is_not_as_it_should_be() {
    for (controller, line) in drawn(&["line8", "line6"]) {
        passes("ato/stop_degraded", line, controller);
    }
}

#[test]
fn every_controller_runs_driverless_and_makes_an_overrun_good() {
    for (controller, line) in drawn(&["line8", "line6"]) {
        passes("ato/driverless_section", line, controller);
    }
}

/// Goal: what takes long is run when it is named, by path, folder or glob, and only then.
#[test]
fn long_procedures_run_only_when_named() {
    let place = Place::new();
    let listed = |arguments: &[&str]| -> Vec<String> {
        let all = [&["run", "--list", "--json"], arguments].concat();
        let procedures = place.json(&all);
        let names = list(&procedures).iter();
        names.map(|p| text(&p["procedure"]).to_owned()).collect()
    };
    let holds = |names: &[String]| names.iter().any(|name| name == "ato/line_run");
    let everything = listed(&[]);
    assert!(everything.iter().any(|name| name == "ato/station_run"));
    assert!(!holds(&everything), "{everything:?}");
    for named in ["ato/line_run", "ato", "ato/*_run"] {
        assert!(holds(&listed(&[named])), "{named}");
    }
    let said = place.ptu("run --list").exits(0);
    said.explains(&["run only when named: ato/driverless_section, ato/line_run"]);
}
