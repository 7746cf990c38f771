//! Every injectable fault: the suite fails where it should, and keeps a fault with a trace around it.
//!
//! Method: the table says for each fault mode which step must fail, and which modes no stored fault
//! names the broken part of. A mode that is not in the table fails the test, so that nobody adds one
//! without saying what finds it. What a fault of the train makes fail suspects the train, and what one
//! of the unit makes fail does not.

use std::collections::BTreeSet;
use std::sync::Mutex;

use crate::common::{Place, has_shape, list, number, text};
use glob::Pattern;
use serde_json::Value;

/// Trace rows are this far apart.
const PERIOD_MS: f64 = 50.0;
/// One row less than what is recorded before a trigger: what fails with power-up has no row at 0 s.
const BEFORE_S: f64 = 10.0 - PERIOD_MS / 1000.0;
const AFTER_S: f64 = 5.0;
/// Suites run side by side.
const WORKERS: usize = 2;

/// Fault mode → procedure and words in the name of a step that must fail.
const FOUND_BY: &[(&str, &str, &str)] = &[
    ("atp_receiver.dead", "atp/power_up", "start-up self-test"),
    ("atp_receiver.detuned", "atp/power_up", "start-up self-test"),
    ("atp_receiver.stuck", "atp/overspeed", "code 0 stops"),
    (
        "speed_sensor_[12].dead",
        "atp/speed_input",
        "on both inputs",
    ),
    (
        "speed_sensor_1.missing_teeth",
        "atp/speed_input",
        "on both inputs",
    ),
    ("speed_sensor_2.noisy", "atp/power_up", "stays healthy"),
    ("eb_relay.welded", "atp/overspeed", "alarm, FSB, EB"),
    (
        "eb_relay.open",
        "atp/power_up",
        "brake released in a manned cab",
    ),
    ("eb_relay.slow", "atp/overspeed", "alarm, FSB, EB"),
    ("fsb_output.dead", "atp/overspeed", "FSB comes before EB"),
    (
        "io_board.door_stuck_closed",
        "door/interlocks",
        "a door that opens while moving",
    ),
    (
        "io_board.door_stuck_open",
        "door/interlocks",
        "closed doors free it",
    ),
    (
        "io_board.door_enable_dead",
        "door/interlocks",
        "the right side is enabled",
    ),
    ("marker_antenna.dead", "ato/markers", "PSM1 is detected"),
    ("tra.dead", "ato/markers", "TRA answers"),
    (
        "fsk_board.receiver_dead",
        "twc/exchange",
        "received and answered",
    ),
    (
        "fsk_board.receiver_errors",
        "twc/exchange",
        "received and answered",
    ),
    (
        "fsk_board.transmitter_dead",
        "twc/exchange",
        "received and answered",
    ),
    (
        "twc_cpu.wrong_station",
        "twc/exchange",
        "received and answered",
    ),
    ("rs485_link.receiver_dead", "tcms/link", "both directions"),
    ("rs485_link.receiver_errors", "tcms/link", "both directions"),
    (
        "rs485_link.transmitter_dead",
        "tcms/link",
        "both directions",
    ),
    ("ato_cpu.dead", "ato/automatic_mode", "ATP sets Automatic"),
    (
        "ato_cpu.full_effort",
        "ato/automatic_mode",
        "limit less 5 km/h",
    ),
    (
        "ato_cpu.overrun",
        "ato/station_run",
        "section 61, empty train",
    ),
    (
        "ato_cpu.saturated_effort",
        "ato/station_run",
        "section 61, empty train",
    ),
    (
        "ato_cpu.saturated_effort",
        "ato/automatic_mode",
        "nearly full power",
    ),
    (
        "ato_cpu.wrong_track_database",
        "ato/station_run",
        "section 61, empty train",
    ),
    (
        "atp_cpu.wrong_wheel_diameter",
        "atp/speed_input",
        "on both inputs",
    ),
    (
        "marker_antenna.deaf_to_psm4",
        "ato/markers",
        "PSM4 is detected",
    ),
    (
        "tra.fails_on_the_way",
        "ato/station_run",
        "section 61, empty train",
    ),
    ("test_board.dead", "atp/power_up", "start-up self-test"),
    ("test_board.dead", "twc/ptu_exchange", "its end is noticed"),
    ("inverter.dead", "tcms/powering_braking", "N to P4"),
    (
        "inverter.regeneration_lost",
        "tcms/powering_braking",
        "N to B7",
    ),
    ("brake_unit.dead", "tcms/not_released", "air on every car"),
    (
        "brake_cylinder.weak",
        "tcms/not_released",
        "air on every car",
    ),
    (
        "brake_cylinder.not_releasing",
        "tcms/not_released",
        "released at departure",
    ),
    (
        "master_controller.pot_[lh]*",
        "tcms/train_lines",
        "controller at N",
    ),
    ("door_contact.open", "tcms/train_lines", "doors closed"),
    ("door_contact.bridged", "tcms/train_lines", "doors open"),
    (
        "head_control_relay.dead",
        "tcms/train_lines",
        "its head control relay picks up",
    ),
    ("head_control_relay.stuck", "tcms/train_lines", "cab left"),
    ("tcms.s*", "tcms/train_lines", "alive counter moves"),
    (
        "atp_receiver.insensitive",
        "atp/power_up",
        "start-up self-test",
    ),
    ("atp_receiver.reads_high", "atp/limit_speed", "code 0 gives"),
    (
        "atp_receiver.drops_out",
        "ato/station_run",
        "section 61, empty train",
    ),
    (
        "atp_receiver.detunes_when_warm",
        "atp/limit_speed",
        "both ends of the rate tolerance",
    ),
    (
        "atp_antenna.weak",
        "atp/limit_speed",
        "just above the threshold",
    ),
    ("atp_antenna.dead", "atp/limit_speed", "code 75 gives"),
    (
        "atp_antenna.loose",
        "ato/station_run",
        "section 61, empty train",
    ),
    (
        "atp_antenna.loose_at_speed",
        "atp/overspeed",
        "code 75: at the limit",
    ),
    ("speed_sensor_1.noisy", "atp/power_up", "stays healthy"),
    (
        "speed_sensor_[12].drops_out",
        "atp/speed_input",
        "followed down to standstill",
    ),
    (
        "speed_sensor_1.loose_at_speed",
        "atp/overspeed",
        "code 45: at the limit",
    ),
    (
        "speed_sensor_2.missing_teeth",
        "atp/overspeed",
        "code 45: at the limit",
    ),
    (
        "speed_sensor_2.noisy_at_speed",
        "atp/overspeed",
        "code 45: at the limit",
    ),
    (
        "eb_relay.welds_when_warm",
        "atp/overspeed",
        "code 75: alarm, FSB, EB",
    ),
    ("eb_relay.sticks", "atp/overspeed", "alarm, FSB, EB"),
    (
        "eb_relay.drops_out",
        "door/interlocks",
        "run to the next platform",
    ),
    (
        "fsb_output.stuck_on",
        "atp/overspeed",
        "code 75: at the limit",
    ),
    ("fsb_output.slow", "atp/overspeed", "FSB comes before EB"),
    (
        "fsb_output.drops_out",
        "tcms/full_service",
        "without a break",
    ),
    (
        "io_board.door_flickers",
        "door/interlocks",
        "run to the next platform",
    ),
    (
        "io_board.door_enable_stuck",
        "door/interlocks",
        "no doors are enabled away",
    ),
    (
        "io_board.cab_input_dead",
        "atp/power_up",
        "seen by the unit",
    ),
    ("io_board.cab_input_stuck", "atp/power_up", "without a cab"),
    (
        "io_board.mode_input_dead",
        "atp/power_up",
        "seen by the unit",
    ),
    (
        "io_board.controller_input_dead",
        "ato/automatic_mode",
        "without a neutral controller",
    ),
    (
        "tra.loses_pulses",
        "ato/markers",
        "at their places on the way",
    ),
    ("tra.drops_out", "ato/markers", "at their places on the way"),
    (
        "marker_antenna.weak",
        "ato/markers",
        "at their places on the way",
    ),
    (
        "marker_antenna.deaf_to_psm1",
        "ato/markers",
        "PSM1 is detected",
    ),
    (
        "marker_antenna.loose_at_speed",
        "ato/markers",
        "at their places on the way",
    ),
    (
        "fsk_board.receiver_fades",
        "ato/station_run",
        "section 61, empty train",
    ),
    (
        "fsk_board.transmitter_errors",
        "twc/exchange",
        "each frame is heard",
    ),
    ("twc_antenna.dead", "twc/exchange", "received and answered"),
    ("twc_antenna.weak", "twc/exchange", "each frame is heard"),
    (
        "twc_antenna.loose",
        "ato/markers",
        "at their places on the way",
    ),
    ("twc_cpu.dead", "twc/exchange", "received and answered"),
    ("twc_cpu.slow", "twc/exchange", "answered at once"),
    (
        "twc_cpu.hangs",
        "ato/station_run",
        "section 61, empty train",
    ),
    (
        "power_supply.dips",
        "door/interlocks",
        "run to the next platform",
    ),
    (
        "power_supply.dips_when_warm",
        "atp/overspeed",
        "code 65: at the limit",
    ),
    (
        "power_supply.dips_at_speed",
        "atp/speed_input",
        "70 km/h on both inputs",
    ),
    (
        "test_board.weak_code",
        "atp/ptu_limit_speed",
        "weak test code",
    ),
    (
        "test_board.wrong_speed",
        "atp/ptu_overspeed",
        "measured on both inputs",
    ),
    (
        "rs485_link.transmitter_errors",
        "tcms/not_released",
        "air on every car",
    ),
    (
        "rs485_link.noisy",
        "ato/station_run",
        "section 61, empty train",
    ),
    (
        "ato_cpu.offset_effort",
        "ato/automatic_mode",
        "ATP sets Automatic",
    ),
    (
        "ato_cpu.freezes",
        "ato/station_run",
        "section 61, empty train",
    ),
    (
        "atp_cpu.clock_*",
        "ato/station_run",
        "section 61, empty train",
    ),
    ("inverter.weak", "tcms/powering_braking", "N to P4"),
    (
        "inverter.trips_when_warm",
        "tcms/powering_braking",
        "full train, N to P4",
    ),
    (
        "brake_unit.drops_out",
        "tcms/regeneration",
        "electric brake at 41 km/h",
    ),
    (
        "brake_cylinder.sticks",
        "tcms/not_released",
        "released at departure",
    ),
    (
        "master_controller.pot_drifts",
        "tcms/train_lines",
        "controller at B1",
    ),
    (
        "master_controller.pot_drops_out",
        "atp/speed_input",
        "followed down to standstill",
    ),
    (
        "door_contact.loose",
        "tcms/train_lines",
        "doors stay proved closed",
    ),
    (
        "door_contact.loose_at_speed",
        "tcms/train_lines",
        "doors stay proved closed",
    ),
    (
        "head_control_relay.drops_out",
        "tcms/powering_braking",
        "full train, N to P4",
    ),
    ("tcms.hangs", "ato/station_run", "section 61, empty train"),
    ("air_supply.low", "tcms/train_lines", "has its pressure"),
    (
        "air_supply.leak",
        "tcms/brake_cut",
        "brake goes to the other pairs",
    ),
    (
        "air_supply.switch_dead",
        "tcms/emergency_line",
        "main reservoir low: the line opens",
    ),
];

/// Modes that diagnosis takes for another part's at the default seed, and why.
const NOT_DIAGNOSED: &[(&str, &str)] = &[
    (
        "atp_receiver.drops_out",
        "code lost in spells is code lost in spells, in the antenna or behind it",
    ),
    (
        "twc_antenna.loose",
        "frames lost in spells on both ways, which a CPU that hangs in spells loses, too",
    ),
    (
        "twc_cpu.hangs",
        "frames lost in spells, which a modem that fades loses, too",
    ),
];

/// Parts of the train around the unit.
const TRAIN_PARTS: [&str; 8] = [
    "inverter",
    "brake_unit",
    "brake_cylinder",
    "master_controller",
    "door_contact",
    "head_control_relay",
    "tcms",
    "air_supply",
];

/// Modes that no stored fault names the part of, and why. Of those that come and go none need be named: a
/// part that is sound whenever it is looked at is found by what its spells do to others.
const PART_NOT_NAMED: &[(&str, &str)] = &[
    (
        "atp_receiver.stuck",
        "sets in 20 s after power-up, when the receiver's own check is over; what shows is brakes",
    ),
    (
        "io_board.cab_input_stuck",
        "the relay that does not drop with the cab is what the step looks at",
    ),
    (
        "twc_antenna.weak",
        "frames lost in the antenna count as lost in the modem behind it",
    ),
    (
        "test_board.weak_code",
        "what a weak test signal does not do is looked for in what it tests",
    ),
    (
        "test_board.wrong_speed",
        "what a wrong test signal does is looked for in what it tests",
    ),
];

/// Modes of the unit that make a step fail which suspects the train, and why.
const TRAIN_SUSPECTED: &[(&str, &str)] = &[
    (
        "rs485_link.*_errors",
        "a link that is lost already is not lost when TCMS falls silent",
    ),
    (
        "atp_cpu.clock_fast",
        "a unit that no longer hears its inputs brakes a train that is tested",
    ),
];

struct Mode {
    id: String,
    lru: String,
    comes_and_goes: bool,
}

#[test]
fn every_injectable_fault_is_found_and_kept_with_its_trace() {
    let catalogue = Place::new();
    let signals = names_of_signals(&catalogue);
    let modes = modes(&catalogue);
    assert!(modes.len() >= 12, "{} fault modes", modes.len());
    let waiting = Mutex::new(modes.iter());
    let problems = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..WORKERS {
            scope.spawn(|| {
                while let Some(mode) = next(&waiting) {
                    let found = check(mode, &signals);
                    problems.lock().expect("problems").extend(found);
                }
            });
        }
    });
    let problems = problems.into_inner().expect("problems");
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn the_table_names_no_fault_that_is_gone() {
    let modes = modes(&Place::new());
    let named = FOUND_BY.iter().map(|(glob, ..)| *glob);
    let excused = PART_NOT_NAMED
        .iter()
        .chain(TRAIN_SUSPECTED)
        .chain(NOT_DIAGNOSED);
    for glob in named.chain(excused.map(|(glob, _)| *glob)) {
        let matches = |mode: &Mode| fits(glob, &mode.id);
        assert!(modes.iter().any(matches), "no fault mode {glob}");
    }
}

#[test]
fn two_faults_at_once_are_both_seen() {
    let place = Place::new();
    let (said, report) = place.run(&["--inject", "tra.dead,rs485_link.transmitter_dead"]);
    said.exits(1);
    assert_eq!(
        report["run"]["injected"],
        "tra.dead,rs485_link.transmitter_dead"
    );
    let parts: BTreeSet<_> = list(&report["faults"])
        .iter()
        .map(|fault| text(&fault["lru"]))
        .collect();
    assert!(
        parts.contains("tra") && parts.contains("rs485_link"),
        "{parts:?}"
    );
}

fn next<'a>(waiting: &Mutex<std::slice::Iter<'a, Mode>>) -> Option<&'a Mode> {
    waiting.lock().expect("modes").next()
}

fn modes(place: &Place) -> Vec<Mode> {
    let catalogue = place.json(&["catalog", "faults", "--json"]);
    let mode = |entry: &Value| {
        has_shape(
            entry,
            &[
                ("id", "text"),
                ("lru", "text"),
                ("mode", "text"),
                ("severity", "text"),
                ("weight", "number"),
                ("unsafe", "bool"),
                ("kind", "text"),
            ],
        );
        Mode {
            id: text(&entry["id"]).to_owned(),
            lru: text(&entry["lru"]).to_owned(),
            comes_and_goes: entry["kind"] == "intermittent",
        }
    };
    list(&catalogue).iter().map(mode).collect()
}

fn names_of_signals(place: &Place) -> BTreeSet<String> {
    let signals = place.json(&["catalog", "signals", "--json"]);
    list(&signals)
        .iter()
        .map(|signal| text(&signal["name"]).to_owned())
        .collect()
}

fn fits(glob: &str, id: &str) -> bool {
    Pattern::new(glob).expect("a glob").matches(id)
}

/// Runs the suite on a unit with this fault; what is wrong with the outcome.
fn check(mode: &Mode, signals: &BTreeSet<String>) -> Vec<String> {
    let place = Place::new();
    let (said, report) = place.run(&["--inject", &mode.id]);
    let mut problems = Vec::new();
    // A unit that starts anew again and again is also lost on the link now and then.
    let exits = if mode.lru == "power_supply" {
        [1, 3]
    } else {
        [1, 1]
    };
    if !said.code.is_some_and(|code| exits.contains(&code)) || said.err.contains("panicked") {
        problems.push(said.all());
    }
    problems.extend(check_steps(mode, &report));
    problems.extend(check_parts(mode, &report));
    problems.extend(check_side(mode, &report));
    problems.extend(check_traces(&place, &report, signals));
    problems.extend(check_diagnosis(mode, &place));
    let named = |problem| format!("{}: {problem}", mode.id);
    problems.into_iter().map(named).collect()
}

/// Diagnosis puts the broken part first, whatever the stored faults name.
fn check_diagnosis(mode: &Mode, place: &Place) -> Option<String> {
    let diagnosis = place.json(&["diagnose", "latest", "--json"]);
    let first = &diagnosis["candidates"][0]["lru"];
    let right = *first == *mode.lru;
    let excused = NOT_DIAGNOSED.iter().find(|(id, _)| *id == mode.id);
    match (right, excused) {
        (false, None) => Some(format!("diagnosed as {first}: {}", diagnosis["conclusion"])),
        (true, Some((_, reason))) => {
            Some(format!("diagnosed now; strike out of the table: {reason}"))
        }
        _ => None,
    }
}

fn check_steps(mode: &Mode, report: &Value) -> Vec<String> {
    let expected: Vec<_> = FOUND_BY
        .iter()
        .filter(|(glob, ..)| fits(glob, &mode.id))
        .collect();
    if expected.is_empty() {
        return vec!["not in the table: say which step finds it".into()];
    }
    let fails = |procedure: &str, words: &str| {
        list(&report["steps"]).iter().any(|step| {
            step["verdict"] == "failed"
                && step["procedure"] == procedure
                && text(&step["name"]).contains(words)
        })
    };
    expected
        .into_iter()
        .filter(|(_, procedure, words)| !fails(procedure, words))
        .map(|(_, procedure, words)| format!("{procedure}: no step \"…{words}…\" failed"))
        .collect()
}

fn check_parts(mode: &Mode, report: &Value) -> Option<String> {
    let faults = list(&report["faults"]);
    let named = faults.iter().any(|fault| fault["lru"] == *mode.lru);
    let excused = PART_NOT_NAMED.iter().find(|(id, _)| *id == mode.id);
    match (named, excused) {
        _ if faults.is_empty() => Some("no fault stored".into()),
        _ if mode.comes_and_goes => None,
        (false, None) => Some(format!("no stored fault names {}", mode.lru)),
        (true, Some((_, reason))) => Some(format!(
            "names its part now; strike out of the table: {reason}"
        )),
        _ => None,
    }
}

/// Unit and train are not taken for each other: no part of the other side is suspected, and a broken
/// train fails nothing but the procedures that test the train. What is sound while it is proved and
/// lets go later may be taken for anything by one step.
fn check_side(mode: &Mode, report: &Value) -> Vec<String> {
    let excused = TRAIN_SUSPECTED.iter().any(|(glob, _)| fits(glob, &mode.id));
    if mode.comes_and_goes || excused {
        return Vec::new();
    }
    let of_train = |part: &str| TRAIN_PARTS.contains(&part);
    let train_is_broken = of_train(&mode.lru);
    let blamed = list(&report["faults"])
        .iter()
        .filter(|fault| of_train(text(&fault["lru"])) != train_is_broken)
        .map(|fault| format!("suspects the other side: {fault}"));
    let failed = list(&report["steps"])
        .iter()
        .filter(|step| train_is_broken && step["verdict"] == "failed")
        .filter(|step| !text(&step["procedure"]).starts_with("tcms/"))
        .map(|step| format!("fails a test of the unit: {step}"));
    blamed.chain(failed).collect()
}

/// Every stored fault has a trace, and at least one trace has its whole window.
fn check_traces(place: &Place, report: &Value, signals: &BTreeSet<String>) -> Vec<String> {
    let mut problems = Vec::new();
    let mut whole = 0;
    for fault in list(&report["faults"]) {
        let Some(id) = fault["trace_id"].as_str() else {
            problems.push(format!("a fault without a trace: {fault}"));
            continue;
        };
        let trace = place.json(&["trace", "show", id, "--json"]);
        let (window, all) = window(&trace);
        if window.0 < BEFORE_S {
            problems.push(format!("trace {id}: {} s before the trigger", window.0));
        }
        if window.1 < AFTER_S && trace["partial"] != true {
            problems.push(format!("trace {id}: {} s after the trigger", window.1));
        }
        if number(&trace["period_ms"]) != PERIOD_MS || all != *signals {
            problems.push(format!("trace {id}: not all signals every {PERIOD_MS} ms"));
        }
        whole += u32::from(window.0 >= BEFORE_S && window.1 >= AFTER_S);
    }
    if whole == 0 {
        problems.push("no trace with its whole window".into());
    }
    problems
}

/// Seconds before and after the trigger, and the signals that are there for all of that time.
fn window(trace: &Value) -> ((f64, f64), BTreeSet<String>) {
    let rows = number(&trace["rows"]);
    let trigger = number(&trace["trigger_row"]);
    let seconds = |rows: f64| rows * number(&trace["period_ms"]) / 1000.0;
    let complete = list(&trace["channels"])
        .iter()
        .filter(|channel| list(&channel["samples"]).len() == rows as usize)
        .map(|channel| text(&channel["name"]).to_owned())
        .collect();
    ((seconds(trigger), seconds(rows - 1.0 - trigger)), complete)
}
