//! Runs on a unit on a port that end before their time: whoever dies or is stopped leaves the unit safe and the record
//! closed.

use std::time::{Duration, Instant};

use crate::common::served::{Observer, Running, Unit, passes, released};
use crate::common::terminal::{Terminal, ended};
use crate::common::{Place, list, text};
use protocol::message::Message;

/// Time that the observer and a busy machine may add.
const SLACK: Duration = Duration::from_millis(200);

/// A stopped run makes its outputs safe and ends within this time.
const ENDS_WITHIN: Duration = Duration::from_secs(45);

/// Goal: a question waits for its answer, whatever is typed meanwhile. Method: at a terminal Ctrl-D, then 201 letters that begin as
/// an answer does, which are none, and then "yes".
#[test]
fn a_question_takes_its_answer_after_an_end_of_input_and_a_line_that_is_none() {
    let (place, terminal) = (Place::new(), Terminal::open());
    let script = place.write(
        "ask.star",
        "procedure(title = \"Test\", title_ko = \"시험\", needs = \"ptu\")\n\
     step(\"asked\", do = prompt(\"Is the lamp lit?\"))\n",
    );
    let mut ptu = terminal.start(&place.command(&["run", &script]));
    terminal.until_shown("[y/n]");
    terminal.type_line("\u{4}");
    terminal.type_line(&"y".repeat(201));
    terminal.until_shown("type y for yes");
    assert!(ptu.try_wait().expect("its state").is_none(), "it is over");
    terminal.type_line("yes");
    assert_eq!(ended(&mut ptu, || terminal.read()), Some(0));
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
     step(\"long\", do = wait(s(60)), measure = value(\"v\", speed))\n\
     step(\"never\", do = wait(s(1)), measure = value(\"v\", speed))\n",
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
        .map(|step| (text(&step["kind"]), text(&step["verdict"])))
        .collect();
    let steps = ["passed", "aborted", "skipped"].map(|verdict| ("step", verdict));
    assert_eq!(verdicts[..3], steps);
    assert_eq!(verdicts[3..], [("clean-up", "error")]);
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
    while place.steps_so_far().is_empty() {
        assert!(
            begun.elapsed() < ENDS_WITHIN,
            "no step within {ENDS_WITHIN:?}"
        );
        terminal.read();
        std::thread::sleep(Duration::from_millis(100));
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
    let run = &place.json("runs list --json")[0];
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
    let run = &place.json("runs list --json")[0];
    assert_eq!(run["unit_serial"], "TCP-7");
    assert_eq!(run["source"], unit.address);
    let other = ["tcms/link", "--serial-no", "TCP-8"];
    Running::start(&place, &unit, &other)
        .finish()
        .exits(3)
        .explains(&["TCP-7", "TCP-8", "serial number"]);
}
