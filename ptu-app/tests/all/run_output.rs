//! How much `ptu run` says, and which procedures it leaves out.

use crate::common::{Place, list, text};

const BAD: [&str; 5] = [
    "run",
    "atp/overspeed",
    "twc/exchange",
    "--inject",
    "eb_relay.slow",
];

/// Goal: a night's log says what is wrong and no more. Method: a run of a bad unit and one of a good unit, quietly.
#[test]
fn quietly_only_what_did_not_pass_and_the_verdict_are_said() {
    let said = Place::new().ptu(&[&BAD[..], &["-q"]].concat()).exits(1);
    for word in ["failed  atp/overspeed", "eb_reaction ="] {
        assert!(said.all().contains(word), "no {word}: {}", said.all());
    }
    assert!(!said.all().contains("passed  "), "{}", said.all());
    assert!(!said.out.contains("PROCEDURE"), "{}", said.out);
    assert!(said.out.starts_with("VERDICT"), "{}", said.out);
    assert!(said.out.contains("faults: failed"), "{}", said.out);
    let good = Place::new().ptu(&["run", "tcms/link", "--quiet"]).exits(0);
    assert_eq!(good.err, "");
    assert!(good.out.starts_with("run "), "{}", good.out);
}

/// Goal: whoever adjusts a limit sees each value without opening the record. Method: a run at length has every step and
/// every measured value of the record, with its limits.
#[test]
fn at_length_each_step_and_each_value_are_said() {
    let place = Place::new();
    let said = place.ptu(&["run", "atp/overspeed", "-v"]).exits(0);
    let run = place.json(&["runs", "show", "latest", "--json"]);
    let (mut values, mut limits) = (0, 0);
    for step in list(&run["steps"]) {
        let name = text(&step["name"]);
        let line = format!("passed  atp/overspeed: {name}");
        assert!(said.err.contains(&line), "{line}: {}", said.err);
        for one in list(&step["measurements"]) {
            values += 1;
            let name = format!("{} = ", text(&one["name"]));
            assert!(said.err.contains(&name), "{name}");
        }
    }
    limits += said.err.matches("allowed at most").count();
    assert!(values > 5 && limits > 5, "{values} values, {limits} limits");
}

/// Goal: all but some can be run without naming the rest. Method: the list without a folder, a glob and one procedure; what
/// stands for nothing, or leaves nothing, is refused before anything is driven.
#[test]
fn procedures_are_left_out_by_name_folder_and_glob() {
    let place = Place::new();
    let ids = |more: &[&str]| -> Vec<String> {
        let listed = place.json(&[&["run", "--list", "--json"], more].concat());
        let ids = list(&listed)
            .iter()
            .map(|one| text(&one["procedure"]).to_owned());
        ids.collect()
    };
    let all = ids(&[]);
    let left = ids(&[
        "--exclude",
        "tcms",
        "--exclude",
        "*/self_test",
        "--exclude",
        "scripts/atp/overspeed.star",
    ]);
    let expected = all.iter().filter(|id| {
        !id.starts_with("tcms/") && !id.ends_with("/self_test") && *id != "atp/overspeed"
    });
    assert_eq!(left, expected.cloned().collect::<Vec<_>>());
    assert!(left.len() > 5 && left.len() + 5 < all.len(), "{left:?}");
    for (wrong, why) in [
        (
            &["--exclude", "atp/overspeeed"][..],
            "did you mean \"atp/overspeed\"?",
        ),
        (&["atp", "--exclude", "twc"], "would be run"),
        (&["atp", "--exclude", "atp"], "leaves nothing"),
        (&["-q", "-v"], "cannot be used with"),
        (&["--json", "--events", "x"], "cannot be used with"),
    ] {
        place
            .ptu(&[&["run"], wrong].concat())
            .exits(2)
            .explains(&[why]);
    }
    place.ptu(&["runs", "show", "latest"]).exits(3);
}
