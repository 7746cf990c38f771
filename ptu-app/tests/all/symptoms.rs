//! What who brought a unit says is wrong with it: a weak sign, kept in the run and said with the reasons.

use serde_json::Value;

use crate::common::{Place, list, number};

/// Probability of a part among the candidates, and what speaks for it.
fn candidate(diagnosis: &Value, part: &str) -> (f64, String) {
    let mut candidates = list(&diagnosis["candidates"]).iter();
    let found = candidates.find(|candidate| candidate["part"] == part);
    let found = found.unwrap_or_else(|| panic!("no {part} in {diagnosis}"));
    (number(&found["probability"]), found["for"].to_string())
}

/// Goal: the symptom makes its parts likelier, whoever asks later, and decides nothing against what was measured. Method: the
/// same few steps of the same unit twice, with the symptom and without.
#[test]
fn a_symptom_is_kept_in_the_run_and_weighs_a_little() {
    let place = Place::with_database();
    let steps = ["run", "atp/overspeed", "--inject", "eb_relay.slow"];
    place.ptu(&steps).exits(1);
    let without = place.json("diagnose latest --json");
    let said = [&steps[..], &["--symptom", "brakes_late"]].concat();
    place.ptu(&said).exits(1);
    let run = place.json("runs show latest --json");
    assert_eq!(run["run"]["symptom"], "brakes_late");
    let with = place.json("diagnose latest --json");
    let (before, _) = candidate(&without, "eb_relay");
    let (after, reasons) = candidate(&with, "eb_relay");
    assert!(after >= before, "{before} {after}");
    let said = "brought with: brakes late or not at all";
    assert!(reasons.contains(said), "{reasons}");
    // Against what was measured it is nothing.
    let against = [&steps[..], &["--symptom", "no_communication"]].concat();
    place.ptu(&against).exits(1);
    let other = place.json("diagnose latest --json");
    assert_eq!(other["candidates"][0]["part"], "eb_relay", "{other}");
}
