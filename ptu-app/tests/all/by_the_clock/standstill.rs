//! Tester or unit stands still or is killed: what the other makes of it, and within which time the unit is safe.

use std::time::{Duration, Instant};

use crate::common::served::{Observer, Running, Unit, passes, released};
use crate::common::{Place, list, number, text};
use fuzzing::amount;
use protocol::message::{Message, Outputs, StatusBits};

/// Steps of a second or two.
const FEW_STEPS: [&str; 3] = ["atp/limit_speed", "--step", "code ?5 gives*"];
/// A killed tester's unit is safe again within this time.
const SAFE_WITHIN: Duration = Duration::from_millis(1000);

/// Time that the observer and a busy machine may add.
const SLACK: Duration = Duration::from_millis(200);

fn eb_applied(message: &Message) -> bool {
    matches!(message, Message::IoOutput(out) if !out.outputs.contains(Outputs::EB_RELAY))
}

/// Goal: a computer that holds a served unit up changes nothing that the unit sees. Method: it stands still for
/// longer than it bears to hear nothing, while the tester goes on, for which it was silent and slow.
#[test]
fn a_unit_that_stood_still_has_heard_its_inputs_all_the_while() {
    let unit = Unit::on_pty(&[]);
    let place = Place::new();
    let arguments = [&FEW_STEPS[..], &["--report", "report.json"]].concat();
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
    // Some ten seconds of steps, so that the run is under way still when its first step is known here.
    let arguments = [
        "atp/limit_speed",
        "--step",
        "code*",
        "--report",
        "report.json",
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
    (0..amount(1)).for_each(|_| killed_in_an_overspeed_step());
}

fn killed_in_an_overspeed_step() {
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

    let killed_run = &place.json("runs list --json")[0];
    assert_eq!(killed_run["state"], "interrupted");
    assert!(killed_run["verdict"].is_null(), "{killed_run}");
    assert_eq!(killed_run["steps_run"], 1, "what was recorded is kept");
    passes(&place, &unit, "tcms/link");
    let states: Vec<_> = list(&place.json("runs list --json"))
        .iter()
        .map(|run| text(&run["state"]).to_owned())
        .collect();
    assert_eq!(states, ["finished", "interrupted"]);
}

/// Goal: no test signal outlives its tester. Method: killed in the step of the next code, after most of the
/// time that of the code before took; a campaign also kills earlier.
#[test]
fn killed_in_an_overspeed_step_of_the_test_board_the_test_signals_go_within_a_second() {
    let turns = amount(1);
    for turn in 1..=turns {
        killed_in_a_step_of_the_test_board(0.5 + 0.2 * turn as f64 / turns as f64);
    }
}

/// Killed after this share of the time that the step before took.
fn killed_in_a_step_of_the_test_board(share: f64) {
    let unit = Unit::on_pty(&[]);
    let place = Place::new();
    let mut run = Running::start(&place, &unit, &["ptu/overspeed", "--step", "code ?5*"]);
    let steps = run.recorded_steps(2);
    assert_eq!(steps[0]["verdict"], "passed", "{}", steps[0]);
    std::thread::sleep(Duration::from_secs_f64(
        share * number(&steps[0]["bench_time_s"]),
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
    assert_eq!(place.json("runs list --json")[0]["state"], "interrupted");
    passes(&place, &unit, "ptu/markers");
}
