//! The window on a unit on a port: one that dies, and that of a train, without the bench harness, the whole way from the
//! connection to the part that failed, the unit's log and its run record, in both languages.

use crate::common::served::Unit;
use crate::common::window::{Window, latest, own_scripts, settings, settings_in};
use crate::common::{Place, list, scripts};
use eframe::egui::Key;
use ptu_options::Page;
use ptu_report::words::{Language, Words};
use ptu_runs::bench_worker::Phase;

/// Something that begins with `first` and ends with the last words of `pattern` is shown.
fn told(window: &Window, first: &str, pattern: &str) -> bool {
    let last = pattern.rsplit('}').next().expect("words");
    let shown = window.shown();
    let mut shown = shown.iter();
    shown.any(|text| text.starts_with(first) && text.ends_with(last))
}

/// Goal: everything a laptop can do is done by clicks. Method: a train whose EB relay is slow, after a service of one section:
/// the Bench page and a self-test by hand, identity and self-test as procedures, the part, log, run record, comparison.
fn the_whole_way(language: Language) {
    let words: &Words = language.words();
    let place = Place::with_database();
    // What is known of this fault, whatever the age of the shipped dictionary.
    let campaign = ["campaign", "--harness", "none", "--faults", "eb_relay.slow"];
    place.ptu(&campaign).exits(0);
    let train = Unit::aboard(&["--service", "61", "--inject", "eb_relay.slow"]);
    let mut settings = settings_in(language, Page::Bench);
    settings.unit.endpoint = train.address.clone();
    settings.unit.train_no = "301".into();
    let mut window = Window::with(place, scripts(), settings);
    window.connect();
    window.wait_for(words.frame.arm);

    // The stimuli, and the list of procedures later, are longer than the window is high.
    window
        .harness()
        .set_size(eframe::egui::vec2(1280.0, 1500.0));
    let test_code = format!("{}: 55", words.bench.test_code);
    window.wait_for(&test_code);
    assert!(!window.enabled(&test_code));
    window.wait_for(words.bench.run_self_test);
    assert!(!window.enabled(words.bench.run_self_test));
    window.hold(words.frame.arm, 1.3);
    window.wait_for(words.frame.armed);
    window.click(words.bench.run_self_test);
    let failed = format!(", {}", words.common.failed);
    let of_item = |text: &str, item: &str| text.starts_with(&format!("{item}: "));
    window.until("what the self-test found", |window| {
        let shown = window.shown();
        let mut items = shown.iter();
        let relay = items.find(|text| of_item(text, words.bench.item_eb_relay));
        relay.is_some_and(|text| text.ends_with(&failed))
            && shown
                .iter()
                .any(|text| of_item(text, words.bench.item_test_board))
    });
    window.click_for(words.frame.disarm, words.frame.arm);

    window.page(Page::Procedures);
    window.click_in(words.procedures.choice, words.procedures.none);
    for title in match language {
        Language::English => [
            "Identity and configuration of the unit",
            "Self-test of the unit",
        ],
        Language::Korean => ["장치 식별 및 구성 확인 (PTU)", "자체시험 확인 (PTU)"],
    } {
        window.click(title);
    }
    window.click(words.procedures.run);
    window.wait_for_part(
        language.choose(["the EB relay (eb_relay, ", "비상제동 계전기 (eb_relay, "]),
    );
    let run = window.place.json("runs show latest --json");
    for step in run["steps"].as_array().expect("steps") {
        if step["procedure"] == "ptu/identity" {
            assert_eq!(step["verdict"], "passed", "{step}");
        }
    }

    window.disconnect();
    window.wait_for(words.frame.not_connected);
    window.page(Page::Faults);
    window.click_in(words.memory.title, words.memory.import);
    window.until("the log", |window| {
        told(window, "SIM-0001: ", words.memory.imported)
    });
    window.page(Page::Traces);
    window.click_in(words.memory.title, words.memory.pull);
    window.until("the run record", |window| {
        told(window, "SIM-0001: ", words.memory.pulled)
    });
    let pulled = |window: &Window| {
        let shown = window.shown();
        let mut shown = shown.into_iter();
        shown.find(|text| text.ends_with(words.traces.no_fault))
    };
    window.until("the pulled run", |window| pulled(window).is_some());
    let trace = pulled(&window).expect("just seen");
    window.click(&trace);
    window.click_for_part(words.memory.compare, "line line8 section 61");
}

#[test]
#[ignore = "long suite: minutes of clicks on a served train"]
fn the_whole_way_on_a_train_is_clicked_through_in_both_languages() {
    for language in Language::ALL {
        the_whole_way(language);
    }
}

/// Goal: another unit than the one asked for is told as that, in words of the window. Method: a unit of one serial number,
/// a window set to another, then to the right one.
#[test]
fn another_unit_than_asked_for_is_said_and_forgotten_once_connected() {
    let unit = Unit::on_tcp(&["--serial-no", "TCP-7"]);
    let mut settings = settings(Page::Bench);
    settings.unit.endpoint = unit.address.clone();
    settings.unit.serial = "TCP-8".into();
    let mut window = Window::with(Place::new(), scripts(), settings);
    window.connect();
    window.wait_for_part("is TCP-7, not TCP-8");
    for text in window.shown() {
        assert!(!text.contains("--") && !text.contains("reached"), "{text}");
    }
    window.set_up();
    window.write_over("serial number", "TCP-7");
    window.key(Key::Escape);
    window.connect();
    window.wait_for("TCP-7");
    assert!(!window.shows_part("not TCP-8"));
}

#[test]
fn a_cable_pulled_in_mid_run_is_said_and_the_record_closed() {
    let mut unit = Unit::on_pty(&[]);
    let mut settings = settings(Page::Procedures);
    settings.language = Language::Korean;
    settings.unit.endpoint = unit.address.clone();
    let mut window = Window::with(Place::new(), scripts(), settings);
    window.connect();
    window.wait_for_phase(Phase::Idle);
    window.click("시험 시작");
    window.until("a step", |window| window.steps_run() > 0);
    unit.kill();
    window.wait_for_part("장치와의 링크가 끊어졌습니다");
    window.wait_for_part("시험 종료: 판정 불가");
    window.wait_for_phase(Phase::Offline);
    let run = latest(&window);
    assert_eq!(run["run"]["verdict"], "error");
    assert_eq!(run["run"]["state"], "finished");
}

/// Goal: a pulled cable costs the step it broke off and no more. Method: the unit dies in the second step and is there again; the run
/// goes on with that step, and is linked to the first.
#[test]
fn a_run_whose_link_was_lost_goes_on_with_its_step() {
    let place = Place::new();
    let script = "procedure(title = \"Asks\", suspect = \"-\")\n\
        step(\"waits\", do = [wait(ms(200))], measure = value(\"v\", speed))\n\
        step(\"asks\", do = [prompt(\"There?\", within = s(600))], measure = value(\"w\", speed))\n\
        step(\"then\", do = [wait(ms(200))], measure = value(\"x\", speed))\n";
    let scripts = own_scripts(&place, script);
    let mut unit = Unit::on_tcp(&[]);
    let mut settings = settings(Page::Procedures);
    settings.unit.endpoint = unit.address.clone();
    let mut window = Window::with(Place::new(), &scripts, settings);
    let words = Language::English.words();
    window.connect_simulated();
    window.click_for(words.procedures.run, "There?");
    unit.kill();
    window.wait_for_part("link lost at step 2 of 3");
    window.wait_for(words.frame.link_gone);
    window.wait_for(words.frame.end_run);
    assert!(!window.shows_part("link 100"));
    let broken = latest(&window)["run"]["id"].clone();
    let _again = Unit::at_port(&unit.port);
    window.click_for(words.frame.go_on, "There?");
    assert!(!window.shows(words.frame.link_gone));
    window.click_for_part("Yes", "Run over: passed");
    let rest = latest(&window);
    assert_eq!(rest["run"]["continues"], broken);
    let steps = list(&rest["steps"]).iter();
    let names: Vec<_> = steps.map(|step| &step["name"]).collect();
    assert_eq!(names, ["asks", "then"], "{rest}");
}

#[test]
fn the_windows_buttons_read_the_unit_that_is_not_connected() {
    let unit = Unit::on_tcp(&["--serial-no", "MEM-3"]);
    let mut settings = settings(Page::Faults);
    settings.unit.endpoint = unit.address.clone();
    let mut window = Window::with(Place::new(), scripts(), settings);
    window.click_in("Records kept in the unit", "Import the unit's log");
    window.wait_for_part("MEM-3:");
    window.click("Traces");
    window.click_in("Records kept in the unit", "Pull the run record");
    window.wait_for_part("MEM-3: 0 rows read, 0 new runs");
}
