//! Every injectable fault: the suite fails where it should, and keeps a fault with a trace around it.
//!
//! Method: the table says for each fault mode which step must fail, and which modes no stored fault
//! names the broken part of. A mode that is not in the table fails the test, so that nobody adds one
//! without saying what finds it. What a fault of the train makes fail suspects the train, and what one
//! of the unit makes fail does not.
//!
//! The whole suite on every mode takes minutes. The check runs for each mode the procedures that the table
//! names, and the whole suite for one mode in twenty, which others are with each commit.

mod runs;

use std::collections::BTreeSet;
use std::sync::Mutex;

use crate::common::{Place, list, normalised, text};
use fuzzing::draw;
use glob::Pattern;
use protocol::injection::{FaultKind, FaultMode};
use protocol::signal::Signal;
use runs::{FaultRun, TestBench, run_program};

/// Trace rows are this far apart.
const PERIOD_MS: f64 = 50.0;
/// Recorded before a trigger, or from before the power-up on.
const BEFORE_S: f64 = 10.0;
const AFTER_S: f64 = 5.0;
/// Suites run side by side.
const WORKERS: usize = 2;

/// The check runs the whole suite on one mode of this many.
const ONE_IN: usize = 20;

/// Procedure for each fault mode (or glob), and words in the name of a step that must fail.
const FOUND_BY: &str = include_str!("found_by.txt");
/// What differs from other modes, with the fault mode (or glob) and the reason: the part that diagnosis names, the part
/// that a stored fault names (of those that come and go none need be named), the side that a step suspects, a procedure
/// of the unit that a fault of the train fails.
const EXCUSED: &str = include_str!("excused.txt");
const PROTECTION: &str = include_str!("../../../../docs/protection.md");
/// The mode of which the whole suite is run through the program itself, command line, printed reports and exit codes
/// included.
const WHOLE_THROUGH_THE_PROGRAM: &str = "eb_relay.slow";
/// Modes that run through the program with the procedures of the table: of the train, of a link, a weak one, one
/// that comes and goes, one that starts the unit again and again.
const THROUGH_THE_PROGRAM: [&str; 5] = [
    "brake_unit.dead",
    "rs485_link.receiver_errors",
    "atp_antenna.weak",
    "door_contact.loose",
    "power_supply.dips",
];

/// Parts of the train around the unit.
const TRAIN_PARTS: &str = "inverter brake_unit brake_cylinder master_controller door_contact head_control_relay tcms air_supply";

#[test]
fn each_fault_fails_the_step_that_the_table_names() {
    let bench = TestBench::new();
    assert!(bench.catalogue.faults.len() >= 12, "fault modes");
    let found = on_each(bench.catalogue.faults.iter(), |mode| {
        let run = bench.run_procedures(mode, &procedures_of(mode));
        problems_of_procedures(mode, &run)
    });
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// Goal: what only the whole suite shows (the part that is named, the diagnosis, that no other procedure
/// fails) comes up soon after the commit that breaks it. Method: other modes with each commit.
#[test]
fn some_faults_are_found_by_the_whole_suite() {
    let bench = TestBench::new();
    let drawn = draw::drawn(&bench.catalogue.faults, ONE_IN);
    let found = on_each(drawn.into_iter(), |mode| problems(mode, &bench.run(mode)));
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// Problems of each mode, two of them side by side.
fn on_each<'a>(
    modes: impl Iterator<Item = &'a FaultMode> + Send,
    problems_of: impl Fn(&FaultMode) -> Vec<String> + Sync,
) -> Vec<String> {
    let waiting = Mutex::new(modes);
    let next = || waiting.lock().expect("modes").next();
    let found = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..WORKERS {
            scope.spawn(|| {
                while let Some(mode) = next() {
                    let wrong = problems_of(mode);
                    found.lock().expect("problems").extend(wrong);
                }
            });
        }
    });
    found.into_inner().expect("problems")
}

/// The program says of a faulty unit what the same run in process gives.
#[test]
fn a_fault_is_found_through_the_program_as_in_process() {
    let bench = TestBench::new();
    let mode_of = |id: &str| {
        let mode = bench.catalogue.faults.iter().find(|mode| mode.id == id);
        mode.expect("a fault mode of the catalogue")
    };
    let mode = mode_of(WHOLE_THROUGH_THE_PROGRAM);
    let found = run_program(&mode.id, &BTreeSet::new());
    assert_eq!(problems(mode, &found), [""; 0]);
    is_the_same(&mode.id, found, bench.run(mode));
    for id in draw::drawn(THROUGH_THE_PROGRAM, 3) {
        let mode = mode_of(id);
        let procedures = procedures_of(mode);
        let found = run_program(id, &procedures);
        assert_eq!(problems_of_procedures(mode, &found), [""; 0]);
        is_the_same(id, found, TestBench::of(&procedures).run(mode));
    }
}

fn is_the_same(id: &str, found: FaultRun, in_process: FaultRun) {
    assert_eq!(found.exit, in_process.exit, "{id}");
    let reports = (normalised(found.report), normalised(in_process.report));
    assert_eq!(reports.0, reports.1, "{id}");
    assert_eq!(found.named, in_process.named, "{id}");
}

/// The procedures that the table names for this fault.
fn procedures_of(mode: &FaultMode) -> BTreeSet<&'static str> {
    let rows = found_by().filter(|(glob, ..)| fits(glob, &mode.id));
    rows.map(|(_, procedure, _)| procedure).collect()
}

#[test]
fn the_tables_name_no_fault_that_is_gone() {
    let catalogue = Place::new().json("catalog faults --json");
    let modes = list(&catalogue);
    let excused = columns(EXCUSED).map(|(_, glob, _)| glob);
    for glob in found_by().map(|(glob, ..)| glob).chain(excused) {
        assert!(
            modes.iter().any(|mode| fits(glob, text(&mode["id"]))),
            "no fault mode {glob}"
        );
    }
}

/// Each row of the table of protections is run: a step proves it, and each fault mode that takes it away is found by
/// the step of the table here. A mode that leaves a train less protected is in one of them.
#[test]
fn every_row_of_the_protection_table_is_run() {
    let bench = TestBench::new();
    let modes = &bench.catalogue.faults;
    let mut wrong = Vec::new();
    let mut broken = Vec::new();
    for row in PROTECTION.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<_> = row.trim_matches('|').split(" | ").map(str::trim).collect();
        let [name, .., proved_by, broken_by] = cells[..] else {
            panic!("columns of {row}");
        };
        // Once by function, with its classes, beside its own row.
        if by_function().filter(|line| line.contains(name)).count() != 1 {
            wrong.push(format!("{name}: not once by function"));
        }
        let (procedure, words) = proved_by.split_once(": ").expect("procedure and step");
        if !bench.has_step(procedure.trim_matches('`'), words) {
            wrong.push(format!("{name}: no step {proved_by}"));
        }
        for glob in broken_by.split('`').skip(1).step_by(2) {
            let fitting = modes.iter().filter(|mode| fits(glob, &mode.id));
            let before = broken.len();
            broken.extend(fitting.map(|mode| mode.id.as_str()));
            if before == broken.len() {
                wrong.push(format!("{name}: no fault mode {glob}"));
            }
        }
    }
    let found = |id: &str| found_by().any(|(glob, ..)| fits(glob, id));
    let unfound = broken.iter().filter(|id| !found(id));
    wrong.extend(unfound.map(|id| format!("{id}: no step finds it")));
    let unsafe_modes = modes.iter().filter(|mode| mode.unsafe_);
    let unnamed = unsafe_modes.filter(|mode| !broken.contains(&mode.id.as_str()));
    wrong.extend(unnamed.map(|mode| format!("{}: in no row", mode.id)));
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Rows of the table of hazards by function.
fn by_function() -> impl Iterator<Item = &'static str> {
    let (_, table) = PROTECTION
        .split_once("| Function | Row |")
        .expect("hazards by function");
    table
        .lines()
        .skip(2)
        .take_while(|line| line.starts_with('|'))
}

#[test]
fn two_faults_at_once_are_both_seen() {
    let place = Place::new();
    let (said, report) = place.run("--inject tra.dead,rs485_link.transmitter_dead");
    said.exits(1);
    assert_eq!(
        report["run"]["injected"],
        "tra.dead,rs485_link.transmitter_dead"
    );
    let parts: BTreeSet<_> = list(&report["faults"])
        .iter()
        .map(|fault| text(&fault["part"]))
        .collect();
    assert!(
        parts.contains("tra") && parts.contains("rs485_link"),
        "{parts:?}"
    );
}

fn fits(glob: &str, id: &str) -> bool {
    Pattern::new(glob).expect("a glob").matches(id)
}

/// The table's rows: glob, procedure, words of the step.
fn found_by() -> impl Iterator<Item = (&'static str, &'static str, &'static str)> {
    columns(FOUND_BY)
}

/// Rows of three columns.
fn columns(
    table: &'static str,
) -> impl Iterator<Item = (&'static str, &'static str, &'static str)> {
    table.lines().map(|line| {
        let (first, rest) = line.split_once("  ").expect("a row of the table");
        let (second, third) = rest.trim_start().split_once("  ").expect("three columns");
        (first, second, third.trim_start())
    })
}

/// Reason for which this is an exception in this fault mode, if it may be one.
fn excused(what: &str, mode: &FaultMode) -> Option<&'static str> {
    let mut rows = columns(EXCUSED).filter(|(of, glob, _)| *of == what && fits(glob, &mode.id));
    rows.next().map(|(.., why)| why)
}

/// Problems of a run of the procedures that the table names for this fault. The named part and the diagnosis,
/// which need other procedures, are not judged.
fn problems_of_procedures(mode: &FaultMode, run: &FaultRun) -> Vec<String> {
    let mut problems = Vec::new();
    if run.exit != 1 {
        problems.push(format!("exit {}", run.exit));
    }
    if list(&run.report["faults"]).is_empty() {
        problems.push("no fault stored".into());
    }
    problems.extend(check_steps(mode, run));
    problems.extend(check_side(mode, run));
    problems.extend(check_traces(run));
    let named = |problem| format!("{}: {problem}", mode.id);
    problems.into_iter().map(named).collect()
}

/// Problems in the outcome of a run of the whole suite on a unit with this fault.
fn problems(mode: &FaultMode, run: &FaultRun) -> Vec<String> {
    let mut problems = Vec::new();
    if run.exit != 1 {
        problems.push(format!("exit {}", run.exit));
    }
    problems.extend(check_steps(mode, run));
    problems.extend(check_parts(mode, run));
    problems.extend(check_side(mode, run));
    problems.extend(check_traces(run));
    problems.extend(check_diagnosis(mode, run));
    let named = |problem| format!("{}: {problem}", mode.id);
    problems.into_iter().map(named).collect()
}

/// Diagnosis puts the broken part first, or says what to measure to tell it from others, whatever the stored faults name.
fn check_diagnosis(mode: &FaultMode, run: &FaultRun) -> Option<String> {
    let excused = excused("not diagnosed", mode);
    match (
        run.named.iter().any(|part| part == mode.lru.as_str()),
        excused,
    ) {
        (false, None) => Some(format!("diagnosed as {}", run.named.join(" or "))),
        (true, Some(reason)) => Some(format!("diagnosed now; strike out of the table: {reason}")),
        _ => None,
    }
}

fn check_steps(mode: &FaultMode, run: &FaultRun) -> Vec<String> {
    let expected: Vec<_> = found_by()
        .filter(|(glob, ..)| fits(glob, &mode.id))
        .collect();
    if expected.is_empty() {
        return vec!["not in the table: say which step finds it".into()];
    }
    let fails = |procedure: &str, words: &str| {
        list(&run.report["steps"]).iter().any(|step| {
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

fn check_parts(mode: &FaultMode, run: &FaultRun) -> Option<String> {
    let faults = list(&run.report["faults"]);
    let named = faults
        .iter()
        .any(|fault| fault["part"] == mode.lru.as_str());
    match (named, excused("part not named", mode)) {
        _ if faults.is_empty() => Some("no fault stored".into()),
        _ if comes_and_goes(mode) => None,
        (false, None) => Some(format!("no stored fault names {}", mode.lru)),
        (true, Some(reason)) => Some(format!(
            "names its part now; strike out of the table: {reason}"
        )),
        _ => None,
    }
}

/// Unit and train are not taken for each other: no part of the other side is suspected, and a broken
/// train fails nothing but the procedures that test the train. What is sound while it is proved and
/// lets go later may be taken for anything by one step.
fn check_side(mode: &FaultMode, run: &FaultRun) -> Vec<String> {
    if comes_and_goes(mode) || excused("train suspected", mode).is_some() {
        return Vec::new();
    }
    let of_train = |part: &str| TRAIN_PARTS.split(' ').any(|one| one == part);
    let train_is_broken = of_train(mode.lru.as_str());
    let blamed = list(&run.report["faults"])
        .iter()
        // An event that names no part suspects nobody.
        .filter(|fault| fault["part"] != "unknown")
        .filter(|fault| of_train(text(&fault["part"])) != train_is_broken)
        .map(|fault| format!("suspects the other side: {fault}"));
    let failed = list(&run.report["steps"])
        .iter()
        .filter(|step| train_is_broken && step["verdict"] == "failed" && step["kind"] == "step")
        .filter(|step| {
            let procedure = text(&step["procedure"]);
            let excused = excused(&format!("fails {procedure}"), mode);
            !procedure.starts_with("tcms/") && excused.is_none()
        })
        .map(|step| format!("fails a test of the unit: {step}"));
    blamed.chain(failed).collect()
}

/// Every stored fault has a trace, and at least one trace has its whole window.
fn check_traces(run: &FaultRun) -> Vec<String> {
    let signals: BTreeSet<_> = Signal::ALL
        .iter()
        .map(|signal| signal.definition().name.to_owned())
        .collect();
    let mut problems = Vec::new();
    let without = list(&run.report["faults"])
        .iter()
        .filter(|fault| fault["trace_id"].as_str().is_none());
    problems.extend(without.map(|fault| format!("a fault without a trace: {fault}")));
    for trace in &run.traces {
        let id = &trace.id;
        if trace.before_s < BEFORE_S && !trace.from_power_up {
            problems.push(format!(
                "trace {id}: {} s before the trigger",
                trace.before_s
            ));
        }
        if trace.after_s < AFTER_S && !trace.partial {
            problems.push(format!("trace {id}: {} s after the trigger", trace.after_s));
        }
        if trace.period_ms != PERIOD_MS || trace.complete != signals {
            problems.push(format!("trace {id}: not all signals every {PERIOD_MS} ms"));
        }
    }
    let whole = |trace: &runs::Window| {
        (trace.before_s >= BEFORE_S || trace.from_power_up) && trace.after_s >= AFTER_S
    };
    if !run.traces.iter().any(whole) {
        problems.push("no trace with its whole window".into());
    }
    problems
}

fn comes_and_goes(mode: &FaultMode) -> bool {
    mode.kind() == FaultKind::Intermittent
}
