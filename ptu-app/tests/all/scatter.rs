//! Good units are passed, whatever they differ by: no false alarm on sensors that are noisy, wheels that
//! are worn, trains that are loaded, frames that come late.
//!
//! A thousand seeds take minutes, so here are ten, of which the check draws four; `ptu campaign` counts the rest.

use crate::common::{Place, list, normalised};
use fuzzing::draw;

/// 312 has a spurious pulse just before the alarm of a code, 1574 one beside
/// the first pulse after standing, 78 slow valves.
const SEEDS: [&str; 10] = [
    "1", "2", "3", "12", "78", "85", "96", "312", "1574", "20261121",
];

#[test]
fn good_units_that_differ_pass_every_step() {
    for seed in draw::drawn(SEEDS, 3) {
        let (said, report) = Place::new().run(&["--scattered", "--seed", seed, "--jobs", "2"]);
        let failed: Vec<_> = list(&report["steps"])
            .iter()
            .filter(|step| step["verdict"] != "passed")
            .collect();
        assert!(failed.is_empty(), "seed {seed}: {failed:#?}");
        assert!(list(&report["faults"]).is_empty(), "seed {seed}");
        said.exits(0);
    }
}

/// The record depends on the seed and on nothing else: not on how many procedures run at once.
#[test]
fn the_same_seed_gives_the_same_unit_and_another_seed_another_one() {
    let report = |seed, jobs| {
        let chosen = ["atp/speed_input", "ato/station_run"];
        let options = ["--scattered", "--seed", seed, "--jobs", jobs];
        let (said, report) = Place::new().run(&[&chosen[..], &options[..]].concat());
        said.exits(0);
        normalised(report)
    };
    let first = report("7", "1");
    assert_eq!(first, report("7", "2"));
    assert_ne!(first["steps"], report("8", "1")["steps"]);
    let (_, nominal) = Place::new().run("atp/speed_input ato/station_run --seed 7");
    assert_ne!(first["steps"], normalised(nominal)["steps"]);
}

/// Faults beyond the scatter of good units are found on every unit.
#[test]
fn faults_are_found_on_units_that_differ() {
    for (fault, procedure) in [
        ("atp_cpu.wrong_wheel_diameter", "atp/speed_input"),
        ("eb_relay.slow", "atp/overspeed"),
        ("brake_cylinder.weak", "tcms/not_released"),
    ] {
        for seed in ["1", "2"] {
            let arguments = [procedure, "--scattered", "--seed", seed, "--inject", fault];
            Place::new().run(&arguments).0.exits(1);
        }
    }
}
