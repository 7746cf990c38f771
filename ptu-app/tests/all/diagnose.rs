//! From a run to the part: what a run names, and campaigns. `stale_dictionaries` among the sessions has what is not good enough.

use std::process::{Output, Stdio};

use crate::common::{Place, list, number, text};
use serde_json::Value;

/// Parts whose fault modes look different enough that a whole run at the default seed must tell them.
const TOLD: [(&str, &str, [&str; 2]); 4] = [
    (
        "eb_relay.slow",
        "eb_relay",
        ["the EB relay", "비상제동 계전기"],
    ),
    (
        "speed_sensor_1.dead",
        "speed_sensor_1",
        ["speed sensor 1", "속도센서 1"],
    ),
    (
        "door_contact.open",
        "door_contact",
        ["the door contact", "출입문 닫힘 접점"],
    ),
    // Of several on a train, the one that TCMS names.
    (
        "inverter.dead",
        "inverter",
        ["the VVVF inverter of car 2", "2호차 추진제어장치(VVVF)"],
    ),
];

fn diagnosis(place: &Place) -> Value {
    let said = place.json("diagnose latest --json");
    for candidate in list(&said["candidates"]) {
        let p = number(&candidate["probability"]);
        assert!((0.0..=1.0).contains(&p), "{candidate}");
    }
    said
}

#[test]
fn a_whole_run_names_the_part_with_reasons() {
    for (fault, lru, [name, name_ko]) in TOLD {
        let place = Place::new();
        place.ptu(&["run", "--inject", fault]).exits(1);
        let said = diagnosis(&place);
        let first = &said["candidates"][0];
        assert_eq!(first["part"], lru, "{fault}: {said:#}");
        let finding = text(&said["finding"]);
        assert!(["found", "one_of"].contains(&finding), "{fault}: {said:#}");
        assert!(
            number(&said["parts"][0]["probability"]) > 0.9,
            "{fault}: {said:#}"
        );
        assert!(!list(&first["for"]).is_empty(), "{fault}");
        for (conclusion, name) in [("conclusion", name), ("conclusion_ko", name_ko)] {
            let named = format!("{name} ({lru}");
            assert!(
                text(&said[conclusion]).contains(&named),
                "{fault}: {said:#}"
            );
        }
        if finding == "found" {
            assert!(said["next_check"].is_null(), "{fault}: nothing is open");
        }
    }
}

/// Goal: a campaign that is killed loses no run that was over, makes none twice, and comes to the same dictionary. Method:
/// killed twice, in a campaign more often, each time when its file has grown by some runs; beside it one that nothing disturbs.
#[test]
#[ignore = "long suite: a campaign of kills"]
fn a_campaign_that_is_killed_goes_on_where_it_was() {
    let place = Place::with_database();
    let campaign = |runs: &str, dictionary: &str| {
        let (runs, dictionary) = (place.text_path(runs), place.text_path(dictionary));
        let kept = ["--runs", &runs, "--out", &dictionary, "--jobs", "2"];
        let sizes = ["--seeds", "2", "--held-out", "1", "--good", "4", "--json"];
        let which = ["campaign", "--harness", "none", "--faults", "eb_relay.*"];
        place.command(&[&which[..], &sizes, &kept].concat())
    };
    let records = |runs: &str| {
        let bytes = std::fs::read(place.path(runs)).unwrap_or_default();
        let mark = b"\x89PTURUN1";
        let at_mark = bytes.windows(mark.len()).filter(|bytes| *bytes == mark);
        at_mark.count()
    };
    let whole = campaign("whole.runs", "whole.zst").output().expect("ran");
    assert!(whole.status.success(), "{whole:?}");
    let all = records("whole.runs");

    let kills = fuzzing::amount(2).min(40) as usize;
    for kill in 1..=kills {
        let kept = (all * kill / (2 * kills)).max(1);
        let mut killed = campaign("killed.runs", "killed.zst")
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("started");
        while records("killed.runs") < kept {
            assert!(killed.try_wait().expect("asked").is_none(), "not killed");
            std::thread::yield_now();
        }
        killed.kill().expect("killed");
        killed.wait().expect("over");
        assert!(
            !place.path("killed.zst").exists(),
            "no dictionary of a part"
        );
    }
    let last = campaign("killed.runs", "killed.zst").output().expect("ran");
    assert!(last.status.success(), "{last:?}");
    assert_eq!(records("killed.runs"), all, "none lost, none made twice");
    let said = |output: &Output| String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(said(&last), said(&whole));
    let dictionary = |name: &str| std::fs::read(place.path(name)).expect("saved");
    assert!(dictionary("killed.zst") == dictionary("whole.zst"));
}

/// Goal: a sound unit that a laptop found nothing wrong with is not half suspected. A passed run has no trace that tells how
/// the unit was reached, and what a sound unit measures depends on that: its relay drops in 10 to 20 ms aboard, in 30 to
/// 60 on a bench, as the run was compared with.
#[test]
fn a_laptops_run_that_passed_is_compared_with_laptops() {
    let place = Place::with_database();
    place.ptu("run ptu --harness none").exits(0);
    let run = place.json("runs show latest --json");
    assert_eq!(run["run"]["connection"], "ptu");
    let said = place.json("diagnose latest --json");
    // What a laptop at a standing train cannot see, as a sensor that gives no pulses, stays possible.
    let healthy = said["no_fault"].as_f64().expect("a probability");
    let suspected = |part: &str| {
        let of_part = |one: &&Value| one["part"] == part;
        let each = list(&said["candidates"]).iter().filter(of_part);
        each.filter_map(|one| one["probability"].as_f64())
            .sum::<f64>()
    };
    assert!(healthy > 0.6 && suspected("io_board") < 0.05, "{said}");
}
