//! How much `ptu run` says, and which procedures it leaves out.

use crate::common::{Place, list, text};

/// Goal: whoever adjusts a limit sees each value without opening the record. Method: a run at length has every step and
/// every measured value of the record, with its limits.
#[test]
fn at_length_each_step_and_each_value_are_said() {
    let place = Place::new();
    let said = place.ptu("run atp/overspeed -v").exits(0);
    let run = place.json("runs show latest --json");
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
