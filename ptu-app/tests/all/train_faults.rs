//! Faults of the train around the unit: what TCMS finds is kept like what the unit finds, with the part, the
//! car, the signals at that moment and a trace; around a unit on a port, too.

use crate::common::served::Unit;
use crate::common::{Place, list};
use serde_json::Value;

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
