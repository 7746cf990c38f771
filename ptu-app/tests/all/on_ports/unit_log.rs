//! A unit's own event log, read over its port: faults with freeze frames in the history, each once.

use std::time::Duration;

use crate::common::served::{Observer, Running, Unit};
use crate::common::{Place, list, number, text};
use protocol::message::{Answer, Message, SetClock};
use serde_json::Value;

/// Reads the unit's log into the place's history.
#[track_caller]
fn import(place: &Place, unit: &Unit, more: &[&str]) -> Value {
    let arguments = ["faults", "import", "--unit", &unit.address, "--json"];
    place.json(&[&arguments[..], more].concat())
}

fn names(faults: &Value) -> Vec<&str> {
    list(faults)
        .iter()
        .map(|fault| text(&fault["name"]))
        .collect()
}

/// Goal: what a unit logged elsewhere becomes faults here, once. Method: it is driven with a dead speed
/// sensor by one tester, and its log read by another.
#[test]
fn what_a_unit_logged_elsewhere_becomes_faults_once() {
    let unit = Unit::on_tcp(&["--inject", "speed_sensor_1.dead", "--serial-no", "FLD-1"]);
    let (workshop, depot) = (Place::new(), Place::new());
    let arguments = ["atp/overspeed", "--step", "code 25: at the limit*"];
    Running::start(&workshop, &unit, &arguments)
        .finish()
        .exits(1);

    let first = import(&depot, &unit, &["--who", "Kim"]);
    assert_eq!(first["unit_serial"], "FLD-1");
    assert_eq!(first["complete"], true);
    let dead = list(&first["faults"])
        .iter()
        .find(|f| f["name"] == "tacho1_dead");
    let dead = dead.unwrap_or_else(|| panic!("{first}"));
    assert_eq!(dead["part"], "speed_sensor_1");
    let frozen = |name: &str| {
        let samples = list(&dead["freeze_frame"]).iter();
        samples
            .clone()
            .find(|sample| sample["name"] == name)
            .cloned()
    };
    let speed = frozen("speed").expect("the speed it froze");
    assert!(number(&speed["value"]) > 1.0, "{speed}");
    for name in [
        "limit",
        "position",
        "mode",
        "eb_cause",
        "parameter",
        "log_index",
    ] {
        assert!(frozen(name).is_some(), "no {name} in {dead}");
    }
    assert!(
        frozen("carrier_hz").is_none(),
        "an entry does not tell of it"
    );

    let runs = depot.json("runs list --json");
    let run = &list(&runs)[0];
    assert_eq!(run["source"], format!("log of {}", unit.address));
    assert_eq!(
        (&run["verdict"], &run["operator"]),
        (&"failed".into(), &"Kim".into())
    );
    assert_eq!(run["step_count"], 0);
    depot.ptu("runs show latest").exits(0);

    let second = import(&depot, &unit, &[]);
    assert_eq!(number(&second["imported"]), 0.0, "{second}");
    assert_eq!(second["known"], first["imported"]);
    // But what a unit logs that nobody speaks to, a while after the tester left.
    let of_others = |told: &Value| number(&told["entries"]) - number(&told["left_out"]["alone"]);
    assert_eq!(
        of_others(&second),
        of_others(&first),
        "reading adds nothing to the log"
    );
    assert_eq!(depot.run_ids().len(), 1);

    // The bench that drove the unit has judged the fault already.
    let own = import(&workshop, &unit, &[]);
    assert!(!names(&own["faults"]).contains(&"tacho1_dead"), "{own}");
    assert!(number(&own["left_out"]["under_test"]) > 0.0, "{own}");

    let other = format!("faults import --unit {} --serial-no FLD-2", unit.address);
    depot
        .ptu(&other)
        .exits(3)
        .explains(&["FLD-1", "FLD-2", "serial number"]);
    assert_eq!(depot.run_ids().len(), 1);
}

/// Goal: a laptop with a wrong clock that reads a unit first hides none of its faults. Method: it tells the unit the year
/// 2025, and that nobody keeps its clock right; another laptop then asks for the faults of the last seven days.
#[test]
fn a_wrong_clock_told_before_hides_no_fault() {
    let unit = Unit::on_pty(&["--inject", "speed_sensor_1.dead", "--serial-no", "FLD-3"]);
    let mut wrong = Observer::on(&unit);
    wrong.send(SetClock {
        utc_ms: 1_735_689_600_000,
        uncertainty_ms: u16::MAX,
    });
    wrong.wait(Duration::from_secs(5), "the answer", |message| {
        matches!(message, Message::StimulusAnswer(answer) if answer.answer == Answer::Accepted)
    });
    drop(wrong);
    let (workshop, depot) = (Place::new(), Place::new());
    let arguments = ["atp/overspeed", "--step", "code 25: at the limit*"];
    Running::start(&workshop, &unit, &arguments)
        .finish()
        .exits(1);

    let read = import(&depot, &unit, &["--when", "7d"]);
    assert!(names(&read["faults"]).contains(&"tacho1_dead"), "{read}");
    assert_eq!(number(&read["left_out"]["too_old"]), 0.0, "{read}");
    let dead = list(&read["faults"])
        .iter()
        .find(|fault| fault["name"] == "tacho1_dead");
    let first_at = dead.map(|fault| text(&fault["at"]));
    assert!(
        !first_at.is_some_and(|at| at.starts_with("2025-01-01")),
        "{read}"
    );
}

#[test]
fn without_a_unit_nothing_is_stored() {
    let place = Place::new();
    let earlier = place.recorded_run();
    // A free port might be taken by another test.
    place
        .ptu("faults import --unit tcp:127.0.0.1:1")
        .exits(3)
        .explains(&["127.0.0.1:1", "check that the unit is served there"]);
    place
        .ptu("faults import --unit sim")
        .exits(2)
        .explains(&["simulated unit", "--unit"]);
    place
        .ptu("faults import --unit lockstep:/dev/pts/0")
        .exits(2)
        .explains(&["lock step", "--unit serial:PATH"]);
    assert_eq!(place.run_ids(), [earlier]);
}
