//! A train to plug a laptop into: only the maintenance channel comes out, and none but it goes in.

use std::time::{Duration, Instant};

use protocol::message::{
    Channel, EbCause, Identify, IoInput, Message, Mode, ModeSwitch, Status, StatusBits, TrainLines,
};
use rustix::process::Signal;
use serde_json::Value;

use crate::common::served::{Observer, Running, Unit};
use crate::common::terminal::{Terminal, ended};
use crate::common::{Place, has, list, text};

/// Longest time anything takes here, on a busy machine.
const SOON: Duration = Duration::from_secs(20);

/// Waits for a status of this kind.
fn status(laptop: &mut Observer, what: &str, wanted: impl Fn(&Status) -> bool) -> Status {
    let mut found = None;
    laptop.wait(SOON, what, |message| {
        assert_eq!(message.channel(), Channel::Ptu, "{message:?}");
        if let Message::Status(status) = message {
            found = Some(*status).filter(|status| wanted(status));
        }
        found.is_some()
    });
    found.expect("just found")
}

fn ready(laptop: &mut Observer) -> Status {
    let ready = StatusBits::STARTED | StatusBits::INPUTS_OK | StatusBits::TCMS_OK;
    status(laptop, "a unit that is ready", |status| {
        status.bits.contains(ready) && status.eb_cause == EbCause::None
    })
}

/// Goal: a laptop is answered and plays no train. Method: identity and status; inputs on the port that would change
/// the mode; then the cab quits.
#[test]
fn a_laptop_is_answered_on_the_maintenance_channel_and_plays_no_train() {
    let mut train = Unit::aboard(&["--serial-no", "SG-0142"]);
    let mut laptop = Observer::on(&train);
    let before = ready(&mut laptop);
    assert_eq!(before.mode, Mode::Manual);
    laptop.send(Identify {});
    laptop.wait(
        SOON,
        "the identity",
        |message| matches!(message, Message::Identity(who) if who.serial.starts_with(b"SG-0142")),
    );
    let yard = IoInput {
        lines: TrainLines::all(),
        mode_switch: ModeSwitch::Yard,
        ..IoInput::default()
    };
    (0..10).for_each(|_| laptop.send(yard));
    let refused = before.rejected_frames + 10;
    let after = status(&mut laptop, "ten refused frames", |status| {
        status.rejected_frames == refused
    });
    assert_eq!((after.mode, after.eb_cause), (Mode::Manual, EbCause::None));
    train.say("quit");
    assert_eq!(train.exit_code(), Some(0));
}

/// Goal: what happens to a train reaches the unit and is survived. Method: pushed and stopped, acknowledged, keyed,
/// without supply and with it again; nobody in the cab; SIGTERM.
#[test]
fn a_train_obeys_its_cab_and_ends_by_a_signal() {
    let mut train = Unit::aboard(&["--service", "61"]);
    let mut laptop = Observer::on(&train);
    let served = ready(&mut laptop);
    assert!(served.events > 6, "the service is in the log: {served:?}");
    train.say("move 15");
    status(&mut laptop, "a train that moves and brakes", |s| {
        s.eb_cause == EbCause::Overspeed
    });
    train.say("stop");
    status(&mut laptop, "a standing train", |s| s.speed1_cms == 0);
    // The button counts once the unit has proved the standstill, for half a second.
    laptop.wait(SOON, "a second", {
        let began = Instant::now();
        move |_| began.elapsed() >= Duration::from_secs(1)
    });
    train.say("ack");
    ready(&mut laptop);
    train.say("power off");
    train.say("power on");
    let anew = status(&mut laptop, "a unit that starts", |s| {
        s.events < served.events
    });
    assert!(anew.events < 6, "{anew:?}");
    ready(&mut laptop);
    train.leave_cab();
    ready(&mut laptop);
    train.signal(Signal::TERM);
    assert_eq!(train.exit_code(), Some(0));
}

/// Goal: a laptop alone tests the unit of a train, and finds out by itself that it has no harness; what somebody does to
/// the train meanwhile is an error. Method: procedures of the PTU and one of the bench, then the key turned in a step.
#[test]
fn a_laptop_alone_tests_the_unit_of_a_train() {
    let mut train = Unit::aboard(&["--serial-no", "SG-0142"]);
    let place = Place::new();
    let arguments = [
        "ptu/identity",
        "ptu/markers",
        "atp/power_up",
        "--serial-no",
        "SG-0142",
        "--report",
        "report.json",
    ];
    let said = Running::start(&place, &train, &arguments).finish().exits(0);
    let report = place.read_json("report.json");
    for step in list(&report["steps"]) {
        // No record tells more of this unit than the number that was given.
        let passes = match text(&step["procedure"]) {
            "ptu/identity" => text(&step["name"]).contains("serial number"),
            procedure => procedure.starts_with("ptu/"),
        };
        let verdict = if passes { "passed" } else { "skipped" };
        assert_eq!(step["verdict"], verdict, "{}", said.all());
    }
    let place = Place::new();
    let mut run = Running::start(&place, &train, &["ptu/limit_speed"]);
    run.recorded_steps(1);
    train.say("key off");
    run.finish()
        .exits(3)
        .explains(&["the maintenance key was turned off"]);
}

/// Goal: what happens to a train on a port during a run blames no part: the run is an error that says what happened.
/// Method: each of it once a step of the overspeed procedure is over.
#[test]
fn what_happens_to_a_train_on_a_port_is_an_error_that_says_so() {
    for (orders, words) in [
        (&["move 5"][..], "the train moved"),
        (&["power off"], "unit silent for"),
        (&["power off", "power on"], "the unit restarted"),
        (&[], "the unit is gone"),
    ] {
        let mut train = Unit::aboard(&[]);
        let place = Place::new();
        let mut run = Running::start(&place, &train, &["ptu/overspeed"]);
        run.recorded_steps(1);
        for order in orders {
            train.say(order);
            std::thread::sleep(Duration::from_millis(700));
        }
        if orders.is_empty() {
            train.kill();
        }
        let said = run.finish();
        let told = if orders.is_empty() { "serial:" } else { words };
        assert!(said.err.contains(told), "{orders:?}: {}", said.all());
        let shown = place.json("runs show latest --json");
        assert_eq!(
            shown["run"]["verdict"],
            "error",
            "{orders:?}: {}",
            said.all()
        );
        assert_eq!(shown["run"]["state"], "finished");
        assert_eq!(
            list(&shown["faults"]).len(),
            0,
            "{orders:?}: {}",
            said.all()
        );
        for step in list(&shown["steps"]) {
            assert_ne!(step["verdict"], "failed", "{step}");
        }
        said.exits(3);
    }
}

/// Goal: the unit of a train is held against the train's record, each part of it by name. Method: the unit of train 301
/// in `scripts/fleet.toml`, found by its number; another in its place, and so named; a train without a record.
#[test]
fn the_unit_of_a_train_is_compared_with_the_trains_record() {
    let place = Place::new();
    let identity = |train: &Unit, more: &[&str]| {
        let report = ["ptu/identity", "--report", "report.json"];
        let said = Running::start(&place, train, &[&report, more].concat()).finish();
        let steps = place.read_json("report.json")["steps"].clone();
        let of_script = list(&steps).iter().filter(|step| step["kind"] == "step");
        let told = |step: &Value| {
            (
                text(&step["verdict"]).to_owned(),
                text(&step["message"]).to_owned(),
            )
        };
        (of_script.map(told).collect::<Vec<_>>(), said)
    };
    let recorded = Unit::aboard(&[]);
    let (steps, said) = identity(&recorded, &[]);
    let passed = (String::from("passed"), String::new());
    assert_eq!(steps, vec![passed.clone(); 4], "{}", said.all());
    said.exits(0);
    drop(recorded);

    let other = Unit::aboard(&["--serial-no", "SG-0142"]);
    let (steps, said) = identity(&other, &["--train-no", "301"]);
    assert_eq!(steps[0].0, "failed", "{}", said.all());
    let differs = "the unit says SG-0142, the record of train 301 SIM-0001";
    assert!(steps[0].1.contains(differs), "{}", said.all());
    assert_eq!(steps[1..], vec![passed; 3], "{}", said.all());
    said.exits(1);
    for (more, why) in [
        (&["--train-no", "999"][..], "train 999 has no record"),
        (&[], "no train's record names unit SG-0142"),
    ] {
        let (steps, said) = identity(&other, more);
        for (verdict, message) in &steps {
            assert_eq!(verdict, "skipped", "{}", said.all());
            assert!(message.contains(why), "{message}");
        }
    }
}

/// Goal: what a script asks is answered at the terminal by whoever stands in the cab. Method: the switches of a train,
/// each turned when it is asked for; then without a terminal.
#[test]
fn somebody_at_the_terminal_answers_what_a_script_asks() {
    let mut train = Unit::aboard(&[]);
    let place = Place::new();
    let address = train.address.clone();
    let arguments = ["run", "cab/inputs", "--unit", &address];
    let terminal = Terminal::open();
    let mut run = terminal.start(&place.command(&arguments));
    for (question, order) in [
        ("Is it off? [y/n]", "key off"),
        ("Is it on? [y/n]", "key on"),
        ("switch to yard. Is it there? [y/n]", "mode yard"),
        ("switch to manual. Is it there? [y/n]", "mode manual"),
    ] {
        terminal.until_shown(question);
        train.say(order);
        terminal.type_line("perhaps");
        terminal.until_shown("type y for yes");
        terminal.type_line("y");
    }
    assert_eq!(ended(&mut run, || terminal.read()), Some(0));
    let told = Running::start(&place, &train, &["cab/inputs"]).finish();
    told.exits(3);
    let run = place.json("runs show latest --json");
    let (steps, outside): (Vec<_>, Vec<_>) = list(&run["steps"])
        .iter()
        .partition(|step| step["kind"] == "step");
    assert_eq!(outside.len(), 1, "{run}");
    assert_eq!(outside[0]["message"], "no step was run");
    for step in steps {
        assert_eq!(step["verdict"], "skipped", "{run}");
        assert!(text(&step["message"]).starts_with("needs an operator: Turn the"));
    }
}

/// Goal: an adaptive run goes by the dictionary of the connection that was found, not of the one that is usual. Method:
/// a train without the harness, which nobody stated, and a dictionary for laptops of one fault mode.
#[test]
#[ignore = "long suite: a campaign and a search in lock step"]
fn a_search_on_a_train_takes_the_dictionary_of_a_laptop() {
    let place = Place::with_database();
    let campaign = ["campaign", "--harness", "none", "--faults", "tra.dead"];
    place.ptu(&campaign).exits(0);
    let train = Unit::aboard(&["--inject", "tra.dead"]);
    let said = Running::start(&place, &train, &["--adaptive"]).finish();
    has(&said.out, &["the TRA (tra, "]);
    said.exits(1);
}

#[test]
fn a_train_that_cannot_be_served_says_why() {
    let place = Place::new();
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = taken.local_addr().expect("its address").to_string();
    place
        .ptu(&["train", "--tcp", &address])
        .exits(3)
        .explains(&["listening on", &address]);
    for (arguments, words) in [
        (&["train"][..], "--pty"),
        (&["train", "--pty", "--service", "99"], "no section 99"),
        (&["train", "--pty", "--section", "99"], "no section 99"),
        (&["train", "--pty", "--inject", "tra.daed"], "tra.dead"),
        (&["train", "--serial", "/dev/null@fast"], "not a baud rate"),
    ] {
        place.ptu(arguments).exits(2).explains(&[words]);
    }
}
