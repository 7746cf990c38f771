//! The technician's window, driven by the names of what is shown: the whole way from connecting to
//! the part that failed, and what goes wrong on it.

use crate::common::window::{Window, latest, own_scripts, settings};
use crate::common::{Place, scripts};
use eframe::egui::{Event, Key, Modifiers, ViewportEvent, ViewportId};
use ptu_options::Page;
use ptu_report::words::Language;
use ptu_runs::bench_worker::Phase;
use ptu_window::{Density, Settings};

/// Runs on the simulated unit take as long as on a real one.
fn realtime(page: Page) -> Settings {
    let mut settings = settings(page);
    settings.unit.realtime = true;
    settings
}

#[test]
fn connects_arms_and_stops_everything_with_one_key() {
    let mut window = Window::open(Page::Bench);
    window.connect_simulated();
    window.wait_for("Arm");
    window.hold("Arm", 1.3);
    window.wait_for("ARMED");
    window.key(Key::F12);
    window.wait_for("Arm");
    window.disconnect();
    window.wait_for("not connected");
}

/// Goal: who follows a run sees its signals as they come. Method: on the page of procedures with the live signals on, a run moves
/// the train: the plot's speed is that of the unit, and it is gone with the switch.
#[test]
fn a_run_is_followed_by_its_signals() {
    let mut window = Window::connected(Place::new(), realtime(Page::Procedures));
    let plot = "Plot: speed ";
    assert!(!window.shows_part(plot));
    window.click_for_part("Live signals", "Plot: speed 0.0 km/h");
    window.click_in("All, none, reload", "None");
    window.click("Overspeed: alarm, service brake, emergency brake");
    window.click("Run");
    window.until("speed in the plot", |window| {
        let shown = window.shown();
        let named = shown.iter().find_map(|text| text.split(plot).nth(1));
        let speed = named.and_then(|rest| rest.split(' ').next()?.parse::<f64>().ok());
        window.phase() == Phase::Running && speed.is_some_and(|speed| speed > 5.0)
    });
    window.click("Live signals");
    assert!(!window.shows_part(plot));
    window.key(Key::F12);
    window.wait_for_phase(Phase::Idle);
}

#[test]
fn a_fault_injected_by_hand_is_found_and_traced_to_its_part() {
    let mut window = Window::open(Page::Procedures);
    window.set_up();
    window.click("Practice");
    window.write("find a fault", "eb_relay.slow");
    window.click("eb_relay.slow");
    window.key(Key::Escape);
    window.connect_simulated();
    window.click_for_part("Run", "Run over: failed");
    window.wait_for_part("the EB relay (eb_relay, ");
    // A step that failed is a click from the trace that shows it.
    window.click("Trace");
    window.wait_for_page(Page::Traces);
    window.wait_for("0.00 s trigger");
    window.page(Page::Procedures);
    window.click("Diagnosis");
    window.wait_for_page(Page::Diagnosis);
    window.wait_for_part("eb_relay");
    let run = latest(&window);
    assert_eq!(run["run"]["verdict"], "failed");
    assert_eq!(run["run"]["injected"], "eb_relay.slow");
}

/// Goal: the page of a run says what its reader needs. Method: a run that passes, in an operator's view, which has no source, then
/// in an engineer's; its end leaves no blank page.
#[test]
fn an_operator_reads_no_source_and_a_passed_run_says_so() {
    let place = Place::new();
    let script = "procedure(title = \"Asks\", suspect = \"-\")\n\
        step(\"asks\", do = [prompt(\"There?\", within = s(600))], measure = value(\"v\", speed))\n";
    let scripts = own_scripts(&place, script);
    let mut settings = settings(Page::Procedures);
    settings.density = Density::Operator;
    let mut window = Window::with(Place::new(), &scripts, settings);
    let words = Language::English.words();
    window.connect_simulated();
    window.click_for(words.procedures.run, "There?");
    assert!(!window.shows_part("own.star:"));
    window.click(words.frame.menu);
    window.click(words.frame.engineer);
    window.key(Key::Escape);
    window.wait_for_part("own.star:");
    window.click_for_part("Yes", "Run over: passed");
    let passed = words.procedures.all_passed.replace("{n}", "1");
    window.wait_for(&passed);
}

/// Goal: a note that is being written when the diagnosis comes is not lost to it. Method: whoever answers is
/// held up by a question of our own, asked before; the diagnosis comes when half of the note is written, and the
/// other half is typed without another look at where the field is.
#[test]
fn a_note_is_written_on_while_the_conclusion_comes() {
    let place = Place::new();
    let scripts = own_scripts(
        &place,
        "procedure(title = \"Alarm\", suspect = \"tra\")\n\
         step(\"sounds\", do = [prompt(\"Quiet here?\", within = s(600))],\n\
         expect = [becomes(alarm, True, within = ms(200))])\n",
    );
    let mut settings = settings(Page::Procedures);
    settings.operator = "Lee".into();
    let mut window = Window::with(Place::new(), &scripts, settings);
    window.connect_simulated();
    window.click_for("Run", "Quiet here?");
    window.click_for_part("Yes", "Run over: failed");
    window.click_for("Run", "Quiet here?");
    let (release, held) = std::sync::mpsc::channel();
    let question = move |_: &_| {
        held.recv().expect("let go");
        Ok(())
    };
    let held_up = window.app().queries.run(question);
    window.click_for_part("Yes", "Run over: failed");
    window.write("note on this run", "relay K3 ");
    assert!(!window.shows_part("cannot tell: "));
    release.send(()).expect("held up");
    window.wait_for_part("cannot tell: ");
    assert!(held_up.take().is_some());
    window.harness().event(Event::Text("clicks late".into()));
    window.step();
    window.click_for("Save note", "Note saved");
    assert_eq!(latest(&window)["notes"][0]["text"], "relay K3 clicks late");
}

#[test]
fn the_least_of_steps_finds_the_part_too() {
    let mut settings = settings(Page::Procedures);
    settings.unit.faults = vec!["tra.dead".into()];
    let mut window = Window::connected(Place::new(), settings);
    window.click_for_part("Find the part", "the TRA (tra, ");
    assert!(latest(&window)["run"]["steps_run"].as_u64() < Some(200));
}

#[test]
fn speaks_korean_from_one_frame_to_the_next() {
    let mut window = Window::open(Page::Procedures);
    window.wait_for("not connected");
    window.speak_korean();
    for name in [
        "시험대",
        "시험 절차",
        "고장 이력",
        "진단",
        "시험 성적서",
        "연결 안 됨",
    ] {
        window.wait_for(name);
    }
    assert!(!window.shows("not connected"), "no English is left over");
    window.connect_simulated();
}

#[test]
fn a_run_is_paused_stepped_and_stopped_and_its_record_closed() {
    let mut window = Window::connected(Place::new(), realtime(Page::Procedures));
    window.click("Run");
    window.wait_for_phase(Phase::Running);
    window.click_for_part("Pause", "Paused before: ");
    let before = window.steps_run();
    window.click("One step");
    window.until("one more step", |window| window.steps_run() > before);
    window.wait_for_part("Paused before: ");
    assert_eq!(window.steps_run(), before + 1);
    window.click("Go on");
    window.click_for_part("Stop", "Run over: aborted");
    let run = latest(&window);
    assert_eq!(run["run"]["verdict"], "aborted");
    assert_eq!(run["run"]["state"], "finished");
    window.wait_for_phase(Phase::Idle);
}

#[test]
fn stop_all_ends_a_run_with_its_clean_up_however_often_it_is_pressed() {
    let mut window = Window::connected(Place::new(), realtime(Page::Procedures));
    window.click("Run");
    window.until("a step", |window| window.steps_run() > 0);
    for _ in 0..5 {
        window.key(Key::F12);
    }
    window.wait_for_part("Run over: aborted");
    let run = latest(&window);
    assert_eq!(run["run"]["verdict"], "aborted");
    let run = window.run().expect("a run");
    let procedures = run.procedures.iter();
    let messages = procedures.map(|procedure| procedure.findings.to_string());
    let messages: String = messages.collect();
    assert!(messages.contains("stopped by the operator"), "{messages}");
    assert!(!messages.contains("cut short"), "{messages}");
}

/// Goal: a message holds while it is shown. Method: a run that is stopped, and another that is begun; a port that is not
/// there, and a unit that is.
#[test]
fn what_is_over_is_no_longer_said() {
    let mut settings = realtime(Page::Procedures);
    settings.unit.endpoint = "serial:/dev/no-such-port".into();
    let mut window = Window::with(Place::new(), scripts(), settings);
    window.connect();
    window.wait_for_part("Not connected");
    window.set_up();
    window.click("simulated unit");
    window.key(Key::Escape);
    window.connect_simulated();
    assert!(!window.shows_part("Not connected"));
    window.click("Run");
    window.wait_for_phase(Phase::Running);
    window.key(Key::F12);
    // On a slow machine the message that the run stops is over before the next picture.
    window.wait_for_part("Run over: aborted");
    window.click("Run");
    window.wait_for_phase(Phase::Running);
    assert!(!window.shows_part("Run over"));
}

#[test]
fn letting_go_in_a_run_closes_its_record_first() {
    let mut window = Window::connected(Place::new(), realtime(Page::Procedures));
    window.click("Run");
    window.wait_for_phase(Phase::Running);
    // A key beside those of the pages ends no run.
    window.disconnect();
    window.step();
    assert_eq!(window.phase(), Phase::Running);
    window.click("SIM-0001");
    window.click_for_part("Disconnect", "outputs safe");
    window.wait_for("not connected");
    assert_eq!(latest(&window)["run"]["verdict"], "aborted");
}

#[test]
fn reaching_a_unit_can_be_given_up() {
    // The server never answers: the unit is still being reached however slowly the window is drawn.
    let silent = std::net::TcpListener::bind("127.0.0.1:0").expect("a free port");
    let mut settings = settings(Page::Bench);
    settings.unit.endpoint = format!("tcp:{}", silent.local_addr().expect("its address"));
    let mut window = Window::with(Place::new(), scripts(), settings);
    window.connect();
    window.click("cancel");
    // Whether its files were still being read or its port already open: it is let go and stays so.
    window.wait_for("not connected");
    for _ in 0..60 {
        window.step();
    }
    assert!(window.shows("not connected"));
}

#[test]
fn a_script_asks_and_the_answer_decides() {
    let place = Place::new();
    let scripts = own_scripts(
        &place,
        "procedure(title = \"Lamp\", suspect = \"-\")\n\
         step(\"the lamp lights\", do = [prompt(\"Does the lamp light?\", within = s(600))])\n",
    );
    for (answer, verdict) in [("Yes", "passed"), ("No", "failed")] {
        let mut window = Window::with(Place::new(), &scripts, settings(Page::Procedures));
        window.connect_simulated();
        window.click_for("Run", "Does the lamp light?");
        // No key says what was seen.
        window.pass(0.7);
        let harness = window.harness();
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
        window.step();
        window.click_for_part(answer, &format!("Run over: {verdict}"));
    }
}

#[test]
fn a_script_that_no_longer_compiles_is_said_and_not_run() {
    let place = Place::new();
    let good = "procedure(title = \"Wait\", suspect = \"-\")\nstep(\"waits\", do = [wait(s(1))], measure = value(\"v\", speed))\n";
    let folder = own_scripts(&place, good);
    let mut window = Window::with(Place::new(), &folder, settings(Page::Procedures));
    window.connect_simulated();
    window.wait_for("Wait");
    std::fs::write(folder.join("own/own.star"), "procedure(title = \n").expect("written");
    window.click_for_part("Run", "The scripts have errors");
    window.wait_for_part("own/own.star:");
    assert!(!window.enabled("Run"));
    // What would take the whole memory takes a process of its own with it, and the window stays.
    ptu_runs::run::loading::load_apart(crate::common::program("ptu"));
    std::fs::write(
        folder.join("own/own.star"),
        format!("{good}x = [0] * 1000000000\n"),
    )
    .expect("written");
    window.click_in("All, none, reload", "Reload scripts");
    window.wait_for_part("needs more than 512 MB of memory");
    assert!(!window.enabled("Run"));
    std::fs::write(folder.join("own/own.star"), good).expect("written");
    window.click_in("All, none, reload", "Reload scripts");
    window.click_for_part("Run", "Run over: passed");
}

#[test]
fn a_unit_that_starts_again_by_itself_is_said() {
    let mut settings = settings(Page::Bench);
    settings.unit.faults = vec!["power_supply.dips".into()];
    let mut window = Window::with(Place::new(), scripts(), settings);
    window.connect();
    window.wait_for_part("The unit was started again");
    assert!(window.app().units.chosen().is_connected());
}

#[test]
fn a_port_that_is_not_there_is_said() {
    let mut settings = settings(Page::Bench);
    settings.unit.endpoint = "serial:/dev/no-such-port".into();
    let mut window = Window::with(Place::new(), scripts(), settings);
    window.connect();
    window.wait_for_part("Not connected");
    window.wait_for_part("/dev/no-such-port");
    window.wait_for("not connected");
}

#[test]
fn a_database_that_is_none_or_locked_is_said_and_the_unit_stays_connected() {
    let place = Place::new();
    place.write("history.db", "this is no database");
    let mut window = Window::connected(place, settings(Page::Procedures));
    window.click_for_part("Run", "The run was not begun");
    assert!(window.app().units.chosen().is_connected());
    window.click("Noted");
    assert!(!window.shows_part("The run was not begun"));

    std::fs::remove_file(window.place.path("history.db")).expect("removed");
    window.click_for_part("Run", "Run over: passed");
    let lock = rusqlite::Connection::open(window.place.path("history.db")).expect("database");
    lock.execute_batch("PRAGMA locking_mode = EXCLUSIVE; BEGIN EXCLUSIVE")
        .expect("locked");
    window.click("Run");
    window.until("the trouble", |window| {
        window.shows_part("The run was not begun") || window.shows_part("could not be recorded")
    });
    drop(lock);
    let before = window.place.json("runs list --json");
    window.click("Run");
    window.until("one more run", |window| {
        let id = window.run_id();
        id.is_some_and(|id| !before.to_string().contains(&id.to_string()))
    });
}

#[test]
fn a_window_closed_in_mid_run_closes_the_record_and_keeps_its_settings() {
    let settings = Settings {
        operator: "Kim".into(),
        ..realtime(Page::Procedures)
    };
    let mut window = Window::connected(Place::new(), settings);
    window.click("Run");
    window.until("the run", |window| {
        let run = window.run();
        run.is_some_and(|run| run.present.is_some())
    });
    let root = ViewportId::ROOT;
    let viewports = &mut window.harness().input_mut().viewports;
    viewports
        .entry(root)
        .or_default()
        .events
        .push(ViewportEvent::Close);
    window.step();
    window.until("the end", |window| window.app().closed);
    let run = latest(&window);
    assert_eq!(run["run"]["verdict"], "aborted");
    assert_eq!(run["run"]["state"], "finished");
    let kept = Settings::load(&window.place.path("config/window.json"));
    assert_eq!(
        (kept.operator.as_str(), kept.page),
        ("Kim", Page::Procedures)
    );
}

#[test]
fn two_units_are_tested_side_by_side() {
    let mut settings = settings(Page::Procedures);
    settings.unit.faults = vec!["tra.dead".into()];
    let mut window = Window::connected(Place::new(), settings);
    window.click("Add a unit");
    window.connect();
    window.until("both", |window| {
        window
            .app()
            .units
            .iter()
            .all(|unit| unit.phase() == Phase::Idle)
    });
    window.click("Run on all units");
    window.until("both runs", |window| {
        let mut units = window.app().units.iter();
        units.all(|unit| unit.run.as_ref().is_some_and(|run| run.id().is_some()))
    });
    let runs = window.place.json("runs list --json");
    assert_eq!(runs.as_array().map(Vec::len), Some(2));
    // Which unit is said of each.
    window.wait_for_part("SIM-0001: Run over: ");
}

#[test]
fn every_page_is_reached_by_its_key_and_shows_something_in_both_languages() {
    let mut window = Window::open(Page::Bench);
    for language in Language::ALL {
        for page in Page::ALL {
            window.page(page);
            window.step();
            assert_eq!(window.app().page(), page);
            assert!(window.shows(page.name(language.words())));
        }
        if language == Language::English {
            window.speak_korean();
        }
    }
}

#[test]
fn tab_and_space_are_enough_to_connect() {
    let mut window = Window::open(Page::Case);
    window.wait_for("Connect");
    let focused = |window: &mut Window| {
        let harness = window.harness();
        let name = harness.ctx.memory(|memory| memory.focused());
        name.is_some() && {
            use egui_kittest::kittest::Queryable;
            harness.get_by_label("Connect").is_focused()
        }
    };
    for _ in 0..40 {
        if focused(&mut window) {
            break;
        }
        window.key(Key::Tab);
        window.step();
    }
    assert!(focused(&mut window), "Tab reaches Connect");
    window.harness().event(Event::Key {
        key: Key::Space,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: Default::default(),
    });
    window.wait_for("SIM-0001");
}
