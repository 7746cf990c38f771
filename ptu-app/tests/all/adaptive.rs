//! Adaptive runs: few steps to the part that failed, and no acceptance of a unit by a part of the suite.

use crate::common::{Place, has, list};
use fuzzing::draw;
use serde_json::Value;

#[test]
fn an_adaptive_run_finds_the_part_in_fewer_steps() {
    let place = Place::new();
    let (_, whole) = place.run("--inject tra.dead");
    let place = Place::new();
    let (said, report) = place.run("--adaptive --inject tra.dead");
    let said = said.exits(1);
    let steps = |report: &Value| list(&report["steps"]).len();
    assert!(steps(&report) * 4 < steps(&whole), "{}", said.all());
    has(&said.out, &["replace the TRA (tra, "]);
    assert_eq!(
        place.json("diagnose latest --json")["candidates"][0]["part"],
        "tra"
    );
}

/// A search that ends without a fault has not run the suite: nothing that a reader or a program looks at may say "passed".
#[test]
fn a_search_that_finds_nothing_is_no_acceptance() {
    let place = Place::new();
    let said = place.ptu("run --adaptive").exits(3);
    let line = said
        .out
        .lines()
        .find(|line| line.contains("not an acceptance: "));
    assert!(
        line.is_some_and(|line| line.contains("inconclusive")),
        "{}",
        said.all()
    );
    assert!(said.out.contains("\nno fault found ("), "{}", said.all());
    let sheet = ["report", "latest", "--lang", "ko", "--out", "r.html"];
    place.ptu(&sheet).exits(0);
    let sheet = std::fs::read_to_string(place.path("r.html")).expect("a sheet");
    assert!(sheet.contains("인수 판정이 아님"));
}

/// Modes that leave the train less protected and that one check alone shows, if any does: a search that is content with what is
/// likely would leave them out.
#[test]
fn a_search_overlooks_no_unsafe_mode() {
    for mode in draw::drawn(
        [
            "atp_cpu.door_bar_dead",
            "atp_cpu.jog_guard_dead",
            "atp_cpu.key_guard_dead",
            "atp_cpu.release_guard_dead",
            "atp_cpu.start_bar_dead",
        ],
        2,
    ) {
        let place = Place::new();
        place.ptu(&["run", "--adaptive", "--inject", mode]).exits(1);
    }
}
