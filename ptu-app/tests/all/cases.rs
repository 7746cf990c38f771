//! One cause, one case: from the run that finds a part to the repair that settles all it explains.

use serde_json::Value;

use crate::common::{Place, list, text};

/// Part pointed at, cause and state of each fault, in order.
fn faults(place: &Place, more: &[&str]) -> Vec<[String; 3]> {
    let all = place.json(&[&["faults", "list", "--json"], more].concat());
    let told = |fault: &Value| ["part", "cause", "state"].map(|key| text(&fault[key]).to_owned());
    let mut told: Vec<_> = list(&all).iter().map(told).collect();
    told.sort();
    told
}

fn id_of(place: &Place, lru: &str) -> String {
    let all = place.json(&["faults", "list", "--part", lru, "--json"]);
    text(&list(&all).first().expect("a fault")["id"]).to_owned()
}

/// A unit whose antenna was found dead, and whose EB relay is slow since.
fn two_cases() -> Place {
    let place = Place::new();
    for (procedure, mode) in [
        ("twc/exchange", "twc_antenna.dead"),
        ("atp/overspeed", "eb_relay.slow"),
    ] {
        let run = ["run", procedure, "--serial-no", "BAD-1", "--inject", mode];
        place.ptu(&run).exits(1);
    }
    place
}

fn states_of<'a>(faults: &'a [[String; 3]], cause: &str) -> Vec<&'a str> {
    let of_cause = faults.iter().filter(|[_, of, _]| of == cause);
    of_cause.map(|[.., state]| state.as_str()).collect()
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

/// Goal: two laptops that saw the same unit have the same cases, whichever imports the other first.
#[test]
fn cases_of_two_laptops_are_one_after_an_import_in_either_order() {
    let (one, two) = (two_cases(), two_cases());
    let cpu = id_of(&one, "atp_cpu");
    one.ptu(&["faults", "repair", &cpu, "--part", "eb_relay"])
        .exits(0);
    let other = two.text_path("history.db");
    let one_file = one.text_path("history.db");
    let both = Place::new();
    both.ptu(&["db", "import", &other]).exits(0);
    both.ptu(&["db", "import", &one_file]).exits(0);
    one.ptu(&["db", "import", &other]).exits(0);
    let merged = faults(&one, &[]);
    assert_eq!(faults(&both, &[]), merged);
    assert_eq!(
        merged.len(),
        faults(&two, &[]).len(),
        "each fault stands once"
    );
    // What the second laptop saw after the repair opened all of it again, or was before it for all.
    let relay = states_of(&merged, "eb_relay");
    assert!(relay.iter().all(|state| *state == relay[0]), "{merged:?}");
    for place in [&one, &both] {
        place.ptu("db check").exits(0);
    }
}
