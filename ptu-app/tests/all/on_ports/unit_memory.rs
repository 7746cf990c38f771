//! Stored memory of a unit, read over its port by commands.

use crate::common::served::{Running, Unit};
use crate::common::{Place, list, number, text};
use serde_json::Value;

fn import(place: &Place, unit: &Unit) -> Value {
    place.json(&["faults", "import", "--unit", &unit.address, "--json"])
}

/// Goal: a log survives power off, and its faults are stored once. Method: a unit with a fault is driven by one
/// tester, switched off and on again without the fault, and read by another, twice.
#[test]
fn faults_of_an_earlier_power_up_are_imported_once() {
    let (workshop, depot) = (Place::new(), Place::new());
    let flash = depot.path("unit.flash");
    let flash = flash.to_str().expect("text");
    let faulty = [
        "--inject",
        "speed_sensor_1.dead",
        "--serial-no",
        "MEM-1",
        "--flash",
        flash,
    ];
    {
        let unit = Unit::on_tcp(&faulty);
        let arguments = ["atp/overspeed", "--step", "code 25: at the limit*"];
        Running::start(&workshop, &unit, &arguments)
            .finish()
            .exits(1);
    }
    let unit = Unit::on_tcp(&["--serial-no", "MEM-1", "--flash", flash]);
    let first = import(&depot, &unit);
    assert_eq!(
        (&first["power_ups"], &first["damaged"]),
        (&2.into(), &0.into())
    );
    let dead = list(&first["faults"])
        .iter()
        .find(|fault| fault["name"] == "tacho1_dead");
    let dead = dead.unwrap_or_else(|| panic!("{first}"));
    let sample = |name: &str| {
        let samples = list(&dead["freeze_frame"]);
        samples
            .iter()
            .find(|sample| sample["name"] == name)
            .cloned()
            .expect(name)
    };
    assert_eq!(number(&sample("power_up")["value"]), 1.0);
    let dated_by = sample("dated_by");
    assert!(
        text(&dated_by["label"]).contains("told in power-up 1"),
        "{dated_by}"
    );
    let second = import(&depot, &unit);
    assert_eq!(number(&second["imported"]), 0.0, "{second}");
    assert_eq!(second["known"], first["imported"]);
}

#[test]
fn a_unit_that_never_drove_has_no_run_to_pull() {
    let unit = Unit::on_tcp(&["--serial-no", "MEM-2"]);
    let place = Place::with_database();
    let pulled = place.json(&["record", "pull", "--unit", &unit.address, "--json"]);
    assert_eq!(
        (number(&pulled["rows"]), number(&pulled["pulled"])),
        (0.0, 0.0)
    );
    assert_eq!(place.run_ids().len(), 0);
    place
        .ptu("record pull --unit sim")
        .exits(2)
        .explains(&["simulated unit"]);
}

/// Goal: a laptop on a train reads all that is whole of a damaged memory, and is told what is not. Method: the memory of a
/// train after a service: a bit of an entry is wrong, an entry is torn in two, a block is overwritten by something else;
/// log and run record over its port each time. A memory that was cut off, or is none, is refused and left as it is.
#[test]
fn a_damaged_memory_aboard_a_train_is_read_as_far_as_it_is_whole() {
    let place = Place::new();
    let flash = place.path("train.flash");
    let arguments = ["--flash", flash.to_str().expect("text")];
    let sound = {
        let mut train = Unit::aboard(&[&arguments[..], &["--service", "61"]].concat());
        let sound = import(&place, &train);
        train.say("quit");
        assert_eq!(train.exit_code(), Some(0));
        sound
    };
    assert_eq!(number(&sound["damaged"]), 0.0, "{sound}");
    let whole = std::fs::read(&flash).expect("the unit's memory");
    let entry = 16;
    for (what, damage) in [
        ("a wrong bit", (entry + 11, 1)),
        ("a torn entry", (entry + 20, 20)),
        ("a block of something else", (0, 4096)),
    ] {
        let mut bytes = whole.clone();
        let (from, length) = damage;
        for byte in &mut bytes[from..from + length] {
            *byte = !*byte ^ 0x5A;
        }
        std::fs::write(&flash, &bytes).expect("written");
        let train = Unit::aboard(&arguments);
        let depot = Place::new();
        let log = import(&depot, &train);
        let lost = number(&sound["entries"]) - number(&log["entries"]);
        assert!(log["complete"] == true, "{what}: {log}");
        if length < 4096 {
            assert_eq!(number(&log["damaged"]), 1.0, "{what}: {log}");
            assert!(lost <= 1.0, "{what}: {lost} entries lost, {log}");
            let told = list(&log["warnings"]);
            assert!(
                told.iter().any(|w| text(w).contains("damaged")),
                "{what}: {log}"
            );
        }
        let pulled = depot.json(&["record", "pull", "--unit", &train.address, "--json"]);
        assert_eq!(number(&pulled["pulled"]), 1.0, "{what}: {pulled}");
    }
    let cut = &whole[..whole.len() / 2];
    let text_file = "a letter".repeat(200).into_bytes();
    for (bytes, words) in [(cut, "was cut off"), (&text_file[..], "something else")] {
        std::fs::write(&flash, bytes).expect("written");
        let all = [&["train", "--pty"], &arguments[..]].concat();
        let said = place.ptu(&all);
        assert!(matches!(said.code, Some(2 | 3)), "{}", said.all());
        assert!(said.err.contains(words), "{}", said.all());
        assert_eq!(
            std::fs::read(&flash).expect("there"),
            bytes,
            "left as it is"
        );
    }
}

/// Goal: no unit's run is taken for another's: two trains with new memories and the same serial number make runs that begin
/// with the same row. The same record pulled again is nothing new. Method: services through two sections, both
/// pulled, and one again.
#[test]
fn records_of_two_sections_are_two_runs_and_each_is_pulled_once() {
    let depot = Place::with_database();
    let pull = |train: &Unit| {
        let pulled = depot.json(&["record", "pull", "--unit", &train.address, "--json"]);
        (number(&pulled["pulled"]), number(&pulled["known"]))
    };
    let trains = ["61", "64"].map(|section| Unit::aboard(&["--service", section]));
    // At one time: a record takes its port half a minute.
    std::thread::scope(|scope| {
        let pull = &pull;
        let pulls = trains
            .each_ref()
            .map(|train| scope.spawn(move || pull(train)));
        for pulled in pulls {
            assert_eq!(pulled.join().expect("pulled"), (1.0, 0.0));
        }
    });
    assert_eq!(pull(&trains[0]), (0.0, 1.0));
    assert_eq!(depot.run_ids().len(), 2);
}

/// Goal: damage in the memory is told, and costs the damaged entry alone; a file that is something else is refused.
/// Method: bytes of the first entry are changed while the unit is off.
#[test]
fn a_damaged_entry_is_told_and_all_others_are_read() {
    let place = Place::new();
    let flash = place.path("unit.flash");
    let arguments = [
        "--serial-no",
        "MEM-4",
        "--flash",
        flash.to_str().expect("text"),
    ];
    let before = {
        let unit = Unit::on_tcp(&arguments);
        import(&place, &unit)
    };
    assert_eq!(number(&before["damaged"]), 0.0);
    let mut bytes = std::fs::read(&flash).expect("the unit's memory");
    // After the block's header: sequence and power-up count of entry 0, then its content.
    bytes[16 + 8 + 3] ^= 0x10;
    std::fs::write(&flash, &bytes).expect("written");
    let after = import(&place, &Unit::on_tcp(&arguments));
    assert_eq!(number(&after["damaged"]), 1.0, "{after}");
    assert!(
        number(&after["entries"]) >= number(&before["entries"]),
        "{after}"
    );
    let told = list(&after["warnings"])
        .iter()
        .any(|warning| text(warning).contains("damaged"));
    assert!(told, "{after}");
}
