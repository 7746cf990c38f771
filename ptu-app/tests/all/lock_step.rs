//! A unit on a pseudo-terminal in lock step: the clock of both ends is what they send, and the suite passes.

use crate::common::served::{Running, Unit};
use crate::common::{Place, list, number, text};
use serde_json::Value;

/// The clock of both ends is what they send: however busy the machine is, the unit hears each scan.
#[test]
fn a_shuffled_suite_passes_over_a_pseudo_terminal_in_lock_step() {
    let place = Place::new();
    let unit = Unit::in_lock_step(&[]);
    let order = ["--shuffle", "--seed", "7"];
    let arguments = [&["--unit", &unit.address], &order[..]].concat();
    let (said, report) = place.run(&arguments);
    let said = said.exits(0);
    assert_eq!(report["run"]["verdict"], "passed");
    assert_eq!(report["run"]["unit_serial"], "SIM-0001");
    assert!(text(&report["run"]["source"]).starts_with("lockstep:"));
    assert!(list(&report["faults"]).is_empty(), "{}", said.all());
    let planned = place.json("run --list --json");
    assert_eq!(list(&report["steps"]).len(), steps_of(list(&planned)));
}

#[test]
fn a_unit_that_is_not_in_lock_step_is_told() {
    let place = Place::new();
    let unit = Unit::on_pty(&[]);
    let address = unit.address.replace("serial:", "lockstep:");
    place
        .ptu(&["run", "tcms/link", "--unit", &address])
        .exits(3)
        .explains(&["does not answer in lock step", "--lock-step"]);
}

pub fn steps_of(planned: &[Value]) -> usize {
    planned.iter().map(|p| list(&p["steps"]).len()).sum()
}

#[test]
fn a_served_unit_with_a_slow_relay_fails() {
    let unit = Unit::in_lock_step(&["--inject", "eb_relay.slow"]);
    let place = Place::new();
    let arguments = ["atp/power_up", "--report", "report.json"];
    Running::start(&place, &unit, &arguments).finish().exits(1);
    let report = place.read_json("report.json");
    let failed = |step: &&serde_json::Value| step["verdict"] == "failed";
    assert!(list(&report["steps"]).iter().any(|step| failed(&step)));
    let fault = &list(&report["faults"])[0];
    assert_eq!(fault["part"], "eb_relay");
    let trace = place.json(&["trace", "show", text(&fault["trace_id"]), "--json"]);
    assert!(number(&trace["trigger_row"]) >= 40.0, "two seconds before");
}

/// Goal: a unit whose clock goes wrong is named over a wire as in memory. Method: one that is 3 % fast, so that it refuses
/// good frames of the I/O rack, TCMS and the wayside as late; of all steps two procedures.
#[test]
fn a_served_unit_with_a_fast_clock_is_measured_and_named() {
    let unit = Unit::in_lock_step(&["--inject", "atp_cpu.clock_fast"]);
    let place = Place::with_database();
    let procedures = ["atp/limit_speed", "twc/exchange", "--report", "report.json"];
    Running::start(&place, &unit, &procedures).finish().exits(1);
    let report = place.read_json("report.json");
    let mut faults = list(&report["faults"]).iter();
    let measured = faults.find(|fault| fault["code"] == 9002);
    assert_eq!(
        measured.expect("a measured clock")["part"],
        "atp_cpu",
        "{report}"
    );
    let said = place.json("diagnose latest --json");
    assert_eq!(said["candidates"][0]["part"], "atp_cpu", "{said}");
}

/// Goal: a unit without a serial number is no unknown one. Method: its run, and one that reached nobody.
#[test]
fn a_unit_without_a_serial_number_is_shown_as_one() {
    let unit = Unit::in_lock_step(&["--serial-no", ""]);
    let place = Place::new();
    let (said, report) = place.run(&["tcms/link", "--unit", &unit.address]);
    said.exits(0);
    assert_eq!(text(&report["run"]["unit_serial"]), "(no serial number)");
    let (_, report) = place.run("tcms/link --serial-no 'A\u{1b}[2J'");
    assert_eq!(text(&report["run"]["unit_serial"]), "A\\x1b[2J");
}
