//! Faults of the train around the unit: what TCMS finds is kept like what the unit finds, with the part, the
//! car, the signals at that moment and a trace; around a unit on a port, too.

use crate::common::served::Unit;
use crate::common::{Place, list, text};
use serde_json::Value;

/// A train that pulls away by hand and brakes again, in a mode that needs no code.
const PULLS_AWAY: &str = r#"procedure(title = "Train", title_ko = "차량", suspect = "tcms")
step("stands ready",
    do = [cab.acknowledge(), cab.mode("yard"), until(mode, "yard", within = s(2)), until(eb, "released", within = s(2))],
)
step("pulls away",
    do = [train.drive(True), cab.controller(4), wait(s(3)), cab.controller(-7), wait(s(4)), cab.controller(0)],
    measure = maximum("greatest_speed", train_speed, low = kmh(5)),
)
"#;

/// The desk proves its doors closed and its controller in the middle.
const DESK: &str = r#"procedure(title = "Desk", title_ko = "운전대", suspect = "door_contact")
step("doors are proved closed",
    do = wait(s(1)),
    expect = becomes(doors, "closed", within = s(1)),
)
"#;

/// The one stored fault of this name.
fn fault<'a>(report: &'a Value, name: &str) -> &'a Value {
    let faults = list(&report["faults"]).iter();
    let found: Vec<_> = faults.filter(|fault| fault["name"] == name).collect();
    assert_eq!(found.len(), 1, "{name} in {report}");
    found[0]
}

/// The label of a signal in a freeze frame.
fn frozen<'a>(fault: &'a Value, signal: &str) -> &'a Value {
    let freeze = list(&fault["freeze_frame"]).iter();
    let found: Vec<_> = freeze.filter(|sample| sample["name"] == signal).collect();
    assert_eq!(found.len(), 1, "{signal} in {fault}");
    &found[0]["label"]
}

#[test]
fn what_tcms_finds_is_a_fault_with_its_car_and_what_stood_around_it() {
    for (mode, event, part, car, lamps) in [
        ("inverter.dead", "inverter_failed", "inverter", 2, "failure"),
        (
            "brake_unit.dead",
            "brake_unit_failed",
            "brake_unit",
            4,
            "failure",
        ),
        (
            "inverter.regeneration_lost",
            "regeneration_cut_out",
            "inverter",
            3,
            "none",
        ),
    ] {
        let place = Place::new();
        place.write("train.star", PULLS_AWAY);
        place.run(&["train.star"]).0.exits(0);
        let (said, report) = place.run(&["train.star", "--inject", mode]);
        said.exits(1);
        assert_eq!(report["run"]["injected"], mode);
        let found = fault(&report, event);
        assert_eq!(found["part"], part, "{found}");
        assert!(found["trace_id"].is_string(), "{found}");

        let shown = place.json(&["faults", "show", text(&found["id"]), "--json"]);
        let said = text(&shown["occurrence_list"][0]["message"]);
        let named = said.starts_with("TCMS: ") && said.contains(&format!("(car {car})"));
        assert!(named && said.contains("TCMS time"), "{said}");
        assert_eq!(frozen(&shown["occurrence_list"][0], "lamps"), lamps);
        assert_eq!(frozen(&shown["occurrence_list"][0], "tcms_mode"), "yard");
        let table = place
            .ptu(&["faults", "show", text(&found["id"])])
            .exits(0)
            .out;
        for words in [event, &format!("part {part}"), &format!("(car {car})")] {
            assert!(table.contains(words), "{words} in {table}");
        }
        let trace = place.json(&["trace", "show", text(&found["trace_id"]), "--json"]);
        let channels = list(&trace["signals"]);
        assert!(channels.iter().any(|channel| channel["name"] == "tcms_fsb"));
    }
}

/// The unit is another's; the train around it is this bench's, and so are the train's faults. What TCMS
/// says before the first step counts.
#[test]
fn faults_of_the_train_work_around_a_unit_on_a_port() {
    let unit = Unit::in_lock_step(&[]);
    let place = Place::new();
    place.write("desk.star", DESK);
    let at = ["desk.star", "--unit", &unit.address];
    let (said, report) = place.run(
        &[
            &at[..],
            &["--inject", "door_contact.open,master_controller.pot_low"],
        ]
        .concat(),
    );
    said.exits(1);
    assert_eq!(
        fault(&report, "controller_failed")["part"],
        "master_controller"
    );
    assert_eq!(fault(&report, "check_failed")["part"], "door_contact");
    place
        .ptu(
            &[
                &["run"],
                &at[..],
                &["--inject", "door_contact.open,tra.dead"],
            ]
            .concat(),
        )
        .exits(2)
        .explains(&["--inject", "ato-under-test --inject"]);
}

#[test]
fn parts_and_modes_of_the_train_are_in_the_catalogue() {
    let place = Place::new();
    let parts = place.json(&["catalog", "parts", "--json"]);
    let modes = place.json(&["catalog", "faults", "--json"]);
    for part in [
        "inverter",
        "brake_unit",
        "brake_cylinder",
        "master_controller",
        "door_contact",
        "head_control_relay",
        "tcms",
    ] {
        let known = list(&parts).iter().any(|lru| lru["id"] == part);
        let broken = list(&modes).iter().any(|mode| mode["part"] == part);
        assert!(known && broken, "{part}");
    }
    let weak = list(&modes)
        .iter()
        .find(|mode| mode["id"] == "brake_cylinder.weak");
    assert_eq!(weak.map(|mode| &mode["car"]), Some(&Value::from(5)));
    let relay = list(&modes)
        .iter()
        .find(|mode| mode["id"] == "eb_relay.open");
    assert_eq!(
        relay.map(|mode| (&mode["car"], &mode["on"])),
        Some((&Value::Null, &Value::from("unit")))
    );
}
