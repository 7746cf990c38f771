//! A unit on a port: in lock step the suite passes; in real time, whoever dies or is stopped leaves the unit
//! safe and the record closed.

use std::time::{Duration, Instant};

use crate::common::served::{Observer, Running, Unit};
use crate::common::terminal::{Terminal, ended};
use crate::common::{Place, list, number, text};
use protocol::message::{Message, Outputs, StatusBits};
use serde_json::Value;

/// A killed tester's unit is safe again within this time.
const SAFE_WITHIN: Duration = Duration::from_millis(1000);
/// What the observer and a busy machine may add.
const SLACK: Duration = Duration::from_millis(200);
/// A stopped run makes its outputs safe and ends within this time.
const ENDS_WITHIN: Duration = Duration::from_secs(45);
/// Units tested side by side.
const BENCHES: usize = 6;

fn eb_applied(message: &Message) -> bool {
    matches!(message, Message::IoOutput(out) if !out.outputs.contains(Outputs::EB_RELAY))
}

/// No session holds the unit and no test signal is made.
fn released(message: &Message) -> bool {
    matches!(message, Message::Status(status)
        if !status.bits.contains(StatusBits::ARMED) && status.test_signals.is_empty())
}

/// A short run on the unit passes.
#[track_caller]
fn passes(place: &Place, unit: &Unit, procedure: &str) {
    Running::start(place, unit, &[procedure]).finish().exits(0);
}

/// The clock of both ends is what they send: however busy the machine is, the unit hears each scan.
#[test]
fn a_shuffled_suite_passes_twice_over_a_pseudo_terminal_in_lock_step() {
    let place = Place::new();
    let unit = Unit::in_lock_step(&[]);
    let order = ["--repeat", "2", "--shuffle", "--seed", "7"];
    let arguments = [&["--unit", &unit.address], &order[..]].concat();
    let (said, report) = place.run(&arguments);
    let said = said.exits(0);
    assert_eq!(report["run"]["verdict"], "passed");
    assert_eq!(report["run"]["unit_serial"], "SIM-0001");
    assert!(text(&report["run"]["source"]).starts_with("lockstep:"));
    assert!(list(&report["faults"]).is_empty(), "{}", said.all());
    let planned = place.json(&["run", "--list", "--json"]);
    assert_eq!(list(&report["steps"]).len(), 2 * steps_of(list(&planned)));
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

fn steps_of(planned: &[Value]) -> usize {
    planned.iter().map(|p| list(&p["steps"]).len()).sum()
}

/// The suite is shared out among units on ports of their own, each of which is tested in real time beside
/// the others.
#[test]
#[ignore = "takes four minutes of real time on a quiet machine: scripts/test full"]
fn a_whole_acceptance_suite_over_pseudo_terminals_passes_in_real_time() {
    let place = Place::new();
    let planned = list(&place.json(&["run", "--list", "--json"])).to_vec();
    let passed: usize = std::thread::scope(|scope| {
        let run = |share: Vec<String>| scope.spawn(move || steps_passed(&share));
        let running: Vec<_> = shared_out(&planned).into_iter().map(run).collect();
        let joined = running.into_iter().map(|thread| thread.join());
        joined.map(|steps| steps.expect("a bench")).sum()
    });
    assert_eq!(passed, steps_of(&planned));
}

/// Procedures for each of the benches, the longest dealt out first, each to the bench that has the
/// least to do.
fn shared_out(planned: &[Value]) -> Vec<Vec<String>> {
    let mut longest: Vec<_> = planned
        .iter()
        .map(|p| (number(&p["worst_case_s"]), text(&p["procedure"]).to_owned()))
        .collect();
    longest.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut shares: Vec<(f64, Vec<String>)> = vec![(0.0, Vec::new()); BENCHES];
    for (time_s, procedure) in longest {
        let least = shares.iter_mut().min_by(|a, b| a.0.total_cmp(&b.0));
        let share = least.expect("benches");
        share.0 += time_s;
        share.1.push(procedure);
    }
    shares
        .into_iter()
        .map(|(_, procedures)| procedures)
        .collect()
}

/// Runs the procedures on a unit of their own and counts the steps, all of which have passed.
fn steps_passed(procedures: &[String]) -> usize {
    let unit = Unit::on_pty(&[]);
    let place = Place::new();
    let procedures = procedures.iter().map(String::as_str);
    let arguments: Vec<_> = procedures.chain(["--report", "report.json"]).collect();
    let said = Running::start(&place, &unit, &arguments).finish().exits(0);
    let report = place.read_json("report.json");
    assert!(list(&report["faults"]).is_empty(), "{}", said.all());
    list(&report["steps"]).len()
}

#[test]
fn a_tester_slower_than_the_unit_is_told() {
    let unit = Unit::on_pty(&[]);
    let place = Place::new();
    Running::start(&place, &unit, &["tcms/link", "--slower", "2"])
        .finish()
        .exits(3)
        .explains(&["times as fast", "--slower"]);
    let as_slow = Unit::on_pty(&["--slower", "2"]);
    Running::start(&place, &as_slow, &["tcms/link", "--slower", "2"])
        .finish()
        .exits(0);
}

/// Goal: a computer that holds a served unit up changes nothing that the unit sees. Method: it stands still for
/// longer than it bears to hear nothing, while the tester goes on, for which it was silent and slow.
#[test]
fn a_unit_that_stood_still_has_heard_its_inputs_all_the_while() {
    let unit = Unit::on_pty(&[]);
    let place = Place::new();
    let arguments = ["atp/limit_speed", "--report", "report.json"];
    let mut run = Running::start(&place, &unit, &arguments);
    run.recorded_steps(2);
    unit.stand_still(Duration::from_millis(420));
    let said = run.finish();
    let report = place.read_json("report.json");
    for fault in list(&report["faults"]) {
        let of_tester = ["atc_silent", "check_failed"].contains(&text(&fault["name"]));
        assert!(of_tester, "{}", said.all());
    }
    assert!(
        said.code == Some(0) || said.code == Some(1),
        "{}",
        said.all()
    );
}

/// Goal: a tester that is held up by its own computer blames nobody, and has a verdict all the same. Method: it stands
/// still for longer than the unit bears to hear nothing, which brakes; the step is repeated.
#[test]
fn a_step_in_which_the_tester_stood_still_is_repeated_and_no_fault_of_the_unit() {
    let unit = Unit::on_pty(&[]);
    let place = Place::new();
    let arguments = [
        "atp/limit_speed",
        "tcms/link",
        "--report",
        "report.json",
        "--report",
        "report.junit.xml",
    ];
    let mut run = Running::start(&place, &unit, &arguments);
    run.recorded_steps(1);
    run.stand_still(Duration::from_millis(3000));
    run.finish().exits(0).explains(&[
        "not tested in attempt 1 of 3",
        "stood still for",
        "(2 of 3)",
    ]);
    let report = place.read_json("report.json");
    assert_eq!(report["run"]["verdict"], "passed");
    assert!(list(&report["faults"]).is_empty(), "{}", report["faults"]);
    let of_step = |verdict: &str| {
        let steps = list(&report["steps"]).iter();
        let names = steps.filter(|step| step["verdict"] == verdict);
        names
            .map(|step| text(&step["name"]).to_owned())
            .collect::<Vec<_>>()
    };
    let (skipped, passed) = (of_step("skipped"), of_step("passed"));
    assert!(!skipped.is_empty(), "{report}");
    assert!(skipped.iter().all(|name| passed.contains(name)), "{report}");
}

/// Goal: train lines and pulses that stop mean braking. Method: killed after the step before, early
/// in the ramp, so that the brake is not applied yet.
#[test]
fn killed_in_an_overspeed_step_the_unit_brakes_within_a_second() {
    let unit = Unit::on_pty(&[]);
    let place = Place::new();
    let mut run = Running::start(&place, &unit, &["atp/overspeed", "--step", "code 25*"]);
    run.recorded_steps(1);
    run.kill();
    let killed = Instant::now();
    let mut observer = Observer::on(&unit);
    observer.wait(SLACK, "a brake still released", |message| {
        matches!(message, Message::IoOutput(out) if out.outputs.contains(Outputs::EB_RELAY))
    });
    observer.wait(SAFE_WITHIN + SLACK, "the emergency brake", eb_applied);
    assert!(
        killed.elapsed() < SAFE_WITHIN + SLACK,
        "{:?}",
        killed.elapsed()
    );
    drop(observer);

    let killed_run = &place.json(&["runs", "list", "--json"])[0];
    assert_eq!(killed_run["state"], "interrupted");
    assert!(killed_run["verdict"].is_null(), "{killed_run}");
    assert_eq!(killed_run["step_count"], 1, "what was recorded is kept");
    passes(&place, &unit, "tcms/link");
    let states: Vec<_> = list(&place.json(&["runs", "list", "--json"]))
        .iter()
        .map(|run| text(&run["state"]).to_owned())
        .collect();
    assert_eq!(states, ["finished", "interrupted"]);
}

/// Goal: no test signal outlives its tester. Method: killed in the step of the next code, after most of the
/// time that of the code before took.
#[test]
fn killed_in_an_overspeed_step_of_the_test_board_the_test_signals_go_within_a_second() {
    let unit = Unit::on_pty(&[]);
    let place = Place::new();
    let mut run = Running::start(&place, &unit, &["ptu/overspeed", "--step", "code ?5*"]);
    let steps = run.recorded_steps(2);
    assert_eq!(steps[0]["verdict"], "passed", "{}", steps[0]);
    std::thread::sleep(Duration::from_secs_f64(
        0.7 * number(&steps[0]["bench_time_s"]),
    ));
    run.kill();
    let killed = Instant::now();
    let mut observer = Observer::on(&unit);
    observer.wait(SLACK, "an armed unit with test signals", |message| {
        matches!(message, Message::Status(status)
        if status.bits.contains(StatusBits::ARMED) && !status.test_signals.is_empty())
    });
    let (mut brakes, mut free) = (None, None);
    while killed.elapsed() < 2 * SAFE_WITHIN && (brakes.is_none() || free.is_none()) {
        for message in observer.hear() {
            if eb_applied(&message) {
                brakes.get_or_insert(killed.elapsed());
            }
            if released(&message) {
                free.get_or_insert(killed.elapsed());
            }
        }
    }
    for (what, after) in [("emergency brake", brakes), ("test signals gone", free)] {
        let in_time = after.is_some_and(|after| after < SAFE_WITHIN + SLACK);
        assert!(in_time, "{what} after {after:?}");
    }
    drop(observer);
    assert_eq!(
        place.json(&["runs", "list", "--json"])[0]["state"],
        "interrupted"
    );
    passes(&place, &unit, "ptu/twc");
}

/// Method: a clean-up that cannot succeed is reported when it ran.
#[test]
fn stopped_by_the_operator_the_run_cleans_up_and_leaves_the_unit_disarmed() {
    let unit = Unit::on_pty(&[]);
    let place = Place::new();
    let script = place.write(
        "long.star",
        "load(\"//_ptu.star\", \"train_as_found\", \"train_at_rest\")\n\
     procedure(title = \"Test\", title_ko = \"시험\", needs = \"ptu\", setup = train_at_rest(),\n\
     \x20   cleanup = [until(mode, \"yard\", within = s(1)), train_as_found()])\n\
     step(\"first\", do = [ptu.code(\"25\"), wait(s(1))], expect = becomes(armed, True))\n\
     step(\"long\", do = wait(s(60)))\n\
     step(\"never\", do = wait(s(1)))\n",
    );
    let mut run = Running::start(&place, &unit, &[&script, "--report", "report.json"]);
    run.recorded_steps(1);
    std::thread::sleep(Duration::from_millis(500));
    run.interrupt();
    let stopped = Instant::now();
    let said = run.finish();
    let mut observer = Observer::on(&unit);
    observer.wait(SLACK, "a status", |message| {
        if let Message::Status(status) = message {
            assert!(released(message), "{status:?}");
        }
        matches!(message, Message::Status(_))
    });
    assert!(stopped.elapsed() < ENDS_WITHIN, "{:?}", stopped.elapsed());
    let said = said
        .exits(130)
        .explains(&["stopped by the operator", "clean-up:", "yard"]);
    let report = place.read_json("report.json");
    assert_eq!(report["run"]["verdict"], "aborted", "{}", said.all());
    assert_eq!(report["run"]["state"], "finished");
    let verdicts: Vec<_> = list(&report["steps"])
        .iter()
        .map(|step| text(&step["verdict"]))
        .collect();
    assert_eq!(verdicts, ["passed", "aborted", "skipped"]);
}

/// Goal: a terminal that is closed ends a run as Ctrl-C does. Method: its own terminal goes, and all it could
/// say goes nowhere.
#[test]
fn a_closed_terminal_stops_the_run_and_leaves_the_unit_disarmed() {
    let unit = Unit::on_pty(&[]);
    let place = Place::new();
    let terminal = Terminal::open();
    let arguments = ["run", "--unit", &unit.address, "ptu/overspeed"];
    let mut run = terminal.start(&place.command(&arguments));
    let begun = Instant::now();
    let armed = |place: &Place| {
        let shown = place.ptu(&["runs", "show", "latest", "--json"]);
        let run: Value = serde_json::from_str(&shown.out).unwrap_or_default();
        run["steps"]
            .as_array()
            .is_some_and(|steps| !steps.is_empty())
    };
    while !armed(&place) {
        assert!(
            begun.elapsed() < ENDS_WITHIN,
            "no step within {ENDS_WITHIN:?}"
        );
        terminal.read();
    }
    drop(terminal);
    assert_eq!(ended(&mut run, || {}), Some(130));
    let mut observer = Observer::on(&unit);
    observer.wait(SLACK, "a status", |message| {
        if let Message::Status(status) = message {
            assert!(released(message), "{status:?}");
        }
        matches!(message, Message::Status(_))
    });
    let run = &place.json(&["runs", "list", "--json"])[0];
    assert_eq!(run["verdict"], "aborted", "{run}");
    assert_eq!(run["state"], "finished", "{run}");
}

#[test]
fn a_unit_that_dies_in_a_run_is_an_error_and_the_record_is_closed() {
    let mut unit = Unit::on_pty(&[]);
    let place = Place::new();
    let mut run = Running::start(
        &place,
        &unit,
        &["atp/limit_speed", "--report", "report.json"],
    );
    run.recorded_steps(2);
    unit.kill();
    let died = Instant::now();
    run.finish()
        .exits(3)
        .explains(&[&unit.port, "link to the unit"]);
    assert!(died.elapsed() < ENDS_WITHIN, "{:?}", died.elapsed());
    let report = place.read_json("report.json");
    assert_eq!(report["run"]["verdict"], "error");
    assert_eq!(report["run"]["state"], "finished");
    let steps = list(&report["steps"]);
    assert_eq!(steps[0]["verdict"], "passed");
    assert!(steps.iter().any(|step| step["verdict"] == "error"));
    assert!(steps.iter().all(|step| step["verdict"] != "failed"));
}

#[test]
fn over_tcp_a_procedure_passes_and_the_next_tester_is_let_in() {
    let unit = Unit::on_tcp(&["--serial-no", "TCP-7"]);
    let place = Place::new();
    passes(&place, &unit, "tcms/link");
    let run = &place.json(&["runs", "list", "--json"])[0];
    assert_eq!(run["unit_serial"], "TCP-7");
    assert_eq!(run["source"], unit.address);
    let other = ["tcms/link", "--serial-no", "TCP-8"];
    Running::start(&place, &unit, &other)
        .finish()
        .exits(3)
        .explains(&["TCP-7", "TCP-8", "--serial-no"]);
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
    assert_eq!(fault["lru"], "eb_relay");
    let trace = place.json(&["trace", "show", text(&fault["trace_id"]), "--json"]);
    assert!(number(&trace["trigger_row"]) >= 40.0, "two seconds before");
}

#[test]
fn the_embedded_unit_can_be_run_at_the_wall_clocks_pace() {
    let (said, report) = Place::new().run(&["tcms/link", "--realtime"]);
    said.exits(0);
    let (bench, wall) = (
        &report["run"]["bench_time_s"],
        &report["run"]["wall_time_s"],
    );
    assert!(number(wall) >= number(bench), "{wall} s for {bench} s");
}
