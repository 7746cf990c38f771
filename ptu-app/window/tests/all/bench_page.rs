//! The bench page, driven by the names of what it shows: the unit live, stimuli by hand.

use btu_rig::rig::Harness;
use eframe::egui::Key;
use egui_kittest::kittest::Queryable;

use crate::common::{
    Place, scripts,
    window::{Window, settings},
};
use ptu_options::Page;
use ptu_report::words::Language;
use ptu_runs::run::BenchChoice;
use ptu_window::Settings;

/// A bench with a simulated unit connected to it.
fn connected(settings: Settings) -> Window {
    let words = settings.language.words();
    let mut window = Window::with(Place::new(), scripts(), settings);
    window.connect();
    window.wait_for(words.frame.arm);
    window
}

/// Closes groups of stimuli, so that those below come into view.
fn fold(window: &mut Window, groups: &[&str]) {
    for group in groups {
        window.click(group);
    }
}

fn on_bench() -> Settings {
    settings(Page::Bench)
}

/// A speed above the limit of the code given makes the emergency brake lamp say so.
///
/// Method: code 25 in the antenna, wheels to 40 km/h at once; nothing brakes them, so that the brake follows
/// whatever the grace at a step of the limit.
#[test]
fn a_speed_above_the_limit_applies_the_emergency_brake_and_stop_all_takes_it_away() {
    let mut window = connected(on_bench());
    window.wait_for("EB: released");
    window.click_for("Speed code: 25", "limit: 25.0 km/h");
    window.click_for("Go to speed", "Overspeed alarm: on");
    window.wait_for("EB: applied");
    window.wait_for("EB cause: overspeed");
    window.wait_for_part("212 Overspeed: emergency brake");
    window.click_for("Stop all", "measured: 0.0 km/h");
    window.wait_for("Speed code: no code");
}

/// Goal: who stops a train that runs is told at once that it is being stopped, and when it is. Method: 40 km/h by hand;
/// everything is stopped without a run, on another page.
#[test]
fn stopping_everything_without_a_run_is_said_at_once() {
    let mut window = connected(on_bench());
    window.click_for("Go to speed", "measured: 40.0 km/h");
    window.page(Page::Report);
    window.key(Key::F12);
    window.step();
    assert!(window.shows_part("stopping: outputs are being made safe"));
    window.until("safe outputs", |window| {
        !window.shows_part("stopping: outputs")
    });
    assert!(!window.shows_part("not confirmed safe"));
}

/// Goal: an order of the wayside is given by hand, and what becomes of it is seen. Method: one that the train, with a
/// driver at the cab, is not in the state for.
#[test]
fn an_order_of_the_wayside_is_given_and_its_state_is_seen() {
    let mut window = connected(on_bench());
    fold(&mut window, &["ATP signal", "Speed", "Train lines"]);
    window.click("TWC");
    window.click_for("Wayside: good", "Order state: —");
    window.click_for_part("Order: turn back", "413 Order refused");
    window.wait_for("Order state: none");
    window.click_for("not sent", "Order state: —");
}

/// Goal: signals of the TEST board reach an armed unit only, and go away with "Stop all".
#[test]
fn the_test_board_is_for_an_armed_unit_only() {
    let mut window = connected(on_bench());
    fold(&mut window, &["ATP signal", "Speed", "Train lines"]);
    window.click_for("TEST board", "Test code: 55");
    assert!(!window.enabled("Test code: 55"));
    assert!(!window.enabled("Test marker: PSM1"));
    assert!(!window.enabled("Clear event log"));
    window.hold("Arm", 1.3);
    window.wait_for("ARMED");
    window.click_for("Test code: 55", "limit: 55.0 km/h");
    window.wait_for("Speed code: 55");
    window.click_for("Stop all", "Arm");
    window.until("the TEST board out of reach", |window| {
        !window.enabled("Test code: 55")
    });
}

/// Goal: what was laid by hand is not shown once it is gone, whatever page was in front then. Method: a
/// section laid, "Stop all" pressed on another page, and back.
#[test]
fn a_section_laid_by_hand_is_forgotten_with_stop_all_on_another_page() {
    let mut window = connected(on_bench());
    fold(&mut window, &["ATP signal", "Speed", "Train lines"]);
    window.wait_for_part("no section laid along the way");
    window.click("Markers");
    window.click("Section: Lay section");
    window.until("a section", |window| {
        !window.shows_part("no section laid along the way")
    });
    window.page(Page::Procedures);
    let bench_epoch = |window: &Window| {
        let unit = window.app().units.chosen();
        unit.bench.live().bench_epoch
    };
    let before = bench_epoch(&window);
    window.key(Key::F12);
    window.until("a safe bench", |window| bench_epoch(window) > before);
    window.page(Page::Bench);
    window.wait_for_part("no section laid along the way");
}

/// Goal: a laptop on the maintenance port has the TEST board first, and what needs the harness says why it
/// cannot be given.
#[test]
fn a_laptop_has_no_harness() {
    let unit = BenchChoice {
        harness: Harness::None,
        ..BenchChoice::default()
    };
    let mut window = connected(Settings { unit, ..on_bench() });
    window.wait_for("Test code: 55");
    fold(&mut window, &["TEST board", "ATP signal"]);
    window.wait_for("Speed code: 55");
    assert!(!window.enabled("Speed code: 55"));
    window.harness().get_by_label("Speed code: 55").hover();
    window.wait_for("Goes through the bench harness; only the maintenance port is connected");
    fold(&mut window, &["TEST board"]);
    window.hold("Arm", 1.3);
    window.click_for("Test code: 45", "limit: 45.0 km/h");
}

/// Goal: the page in Korean, technical words as the field writes them.
#[test]
fn the_page_speaks_korean() {
    let mut window = connected(Settings {
        language: Language::Korean,
        ..on_bench()
    });
    window.wait_for("EB: 완해");
    window.wait_for("출입문: 닫힘");
    window.click_for("속도 코드: 55", "제한: 55.0 km/h");
    fold(&mut window, &["ATP 신호", "속도"]);
    window.click_for_part("출입문: 열림", "역행 차단 원인: 출입문");
    // What is given is told with a button that takes it away.
    window.click_for("제거 출입문", "출입문: 닫힘");
    window.click_for("제거 속도 코드", "속도 코드: 무코드");
    fold(&mut window, &["인통선"]);
    window.write("입력 찾기", "시험 코드");
    window.wait_for("시험 코드: 55");
    assert!(!window.shows("속도 코드: 55"));
    window.write_over("입력 찾기", " ");
    window.click_for("TEST 보드", "시험 코드: 55");
}

/// Goal: a unit is armed on purpose, and disarmed by a nervous hand, too. Method: clicks on Arm, which is held; a double
/// click on Disarm, in whose place Arm comes.
#[test]
fn a_unit_is_armed_by_holding_and_disarmed_by_any_click() {
    let mut window = connected(on_bench());
    window.double_click("Arm");
    window.hold("Arm", 0.5);
    assert!(!window.shows("ARMED"));
    window.hold("Arm", 1.3);
    window.wait_for("ARMED");
    window.double_click("Disarm");
    window.wait_for("Arm");
    for _ in 0..20 {
        window.step();
    }
    assert!(window.shows("Arm"));
}
