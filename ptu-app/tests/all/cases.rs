//! One cause, one case: from the run that finds a part to the repair that settles all it explains.

use serde_json::Value;

use crate::common::{Place, list, text};

fn id_of(place: &Place, lru: &str) -> String {
    let all = place.json(&["faults", "list", "--part", lru, "--json"]);
    text(&list(&all).first().expect("a fault")["id"]).to_owned()
}

/// Goal: what a repair has proved once is known the next time, in another unit.
/// Method: the suite on a unit with a fault that it names with another part only; the same fault in a second unit,
/// before and after a run proves the repair of the first.
#[test]
fn a_case_that_was_confirmed_is_known_in_the_next_unit() {
    let place = Place::new();
    let run = |serial, seed| {
        let inject = ["--inject", "atp_cpu.given_up_released", "--seed", seed];
        let run = ["run", "--serial-no", serial];
        place.ptu(&[&run[..], &inject].concat()).exits(1);
        place.json("diagnose latest --json")
    };
    let first = run("BAD-1", "1");
    assert_eq!(first["finding"], "one_of", "{}", first["conclusion"]);
    let fault = id_of(&place, "atp_cpu");
    let repair = [
        "faults", "repair", &fault, "--part", "atp_cpu", "--new", "SN-9",
    ];
    place.ptu(&repair).exits(0);
    let unproved = run("BAD-2", "2");
    assert_eq!(unproved["finding"], "one_of", "{}", unproved["conclusion"]);
    let proof = place.ptu("run --serial-no BAD-1").exits(0).out;
    assert!(proof.contains("the repair is verified"), "{proof}");
    let known = run("BAD-3", "3");
    let candidates = list(&known["candidates"]);
    let confirmed = candidates
        .iter()
        .find(|one| one["fault"] == "atp_cpu.confirmed");
    let confirmed = confirmed.unwrap_or_else(|| panic!("not among {candidates:#?}"));
    assert_eq!(confirmed["text"], "as in 1 confirmed case, of BAD-1");
    // One case shows where to look, and makes nothing certain.
    let share = |of: &Value| of["parts"][0]["probability"].as_f64().expect("a share");
    assert!(share(&known) > share(&first), "{}", known["conclusion"]);
    assert_eq!(known["finding"], "one_of", "{}", known["conclusion"]);
}
