//! Anything is found by a few of its letters, and nothing is armed or run by it.

use crate::common::window::{Window, on_bad_unit};
use crate::layout::complaints;
use eframe::egui::{Event, Key, Modifiers};
use egui_kittest::kittest::Queryable;
use ptu_options::Page;
use ptu_report::naming::DOT;
use ptu_report::words::{Language, fill};
use ptu_runs::bench_worker::Phase;
use ptu_window::Density;

/// A step of the procedures.
const STEP: &str = "emergency brake released again with a cab";

/// Goal: the one button that a page is for needs no pointer. Method: the case's connects; while something is being looked for it does not.
#[test]
fn the_accent_button_is_pressed_by_a_key_unless_something_stands_over_it() {
    let mut window = Window::open(Page::Case);
    let words = Language::English.words();
    window.wait_for(words.case.first_start);
    let accent = |window: &mut Window| {
        window.pass(0.7);
        let harness = window.harness();
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
        window.step();
        window.phase()
    };
    look_for(&mut window, "xyz");
    assert_eq!(accent(&mut window), Phase::Offline);
    window.key(Key::Escape);
    window.step();
    // Held down since, it acts no more.
    let hold = |window: &mut Window, key, modifiers, pressed| {
        window.pass(0.7);
        window.harness().event(Event::Key {
            key,
            physical_key: None,
            pressed,
            repeat: false,
            modifiers,
        });
        window.step();
        window.phase()
    };
    look_for(&mut window, "xyz");
    hold(&mut window, Key::Enter, Modifiers::COMMAND, true);
    window.key(Key::Escape);
    window.step();
    let held = hold(&mut window, Key::Enter, Modifiers::COMMAND, true);
    assert_eq!(held, Phase::Offline);
    hold(&mut window, Key::Enter, Modifiers::COMMAND, false);
    assert_ne!(accent(&mut window), Phase::Offline);
    window.wait_for("SIM-0001");
    // Nor does the key that lets the unit go.
    window.key(Key::F9);
    window.wait_for("not connected");
    hold(&mut window, Key::F9, Modifiers::NONE, true);
    window.wait_for_phase(Phase::Idle);
    let held = hold(&mut window, Key::F9, Modifiers::NONE, true);
    assert_eq!(held, Phase::Idle);
}

fn look_for(window: &mut Window, typed: &str) {
    window
        .harness()
        .key_press_modifiers(Modifiers::COMMAND, Key::K);
    window.step();
    let words = window.app().settings.language.words();
    window.write(words.frame.find_what, typed);
}

/// Goal: a fault, a step, a life, a page and an action are each two keys and a few letters away. Method: each is looked for, and Enter
/// takes the first row; what is shown then is what was found, and the unit waits as before.
#[test]
fn a_fault_a_step_a_page_and_an_action_are_found_and_nothing_is_run() {
    for (language, fault, page) in [
        (Language::English, "relay bad-1", "wave"),
        (Language::Korean, "계전기 bad-1", "파형"),
    ] {
        let words = language.words();
        let mut window = on_bad_unit(language);
        window.connect_simulated();
        look_for(&mut window, fault);
        window.wait_for(words.frame.faults);
        assert!(complaints(&mut window).is_empty());
        let field = window.harness().get_by_label(words.frame.find_what).rect();
        let bar = Density::Engineer.sizes().bar + 8.0;
        assert!(field.top() > bar, "the bar is never covered: {field}");
        window.keep_picture(&format!("find {language:?}"));
        window.key(Key::Enter);
        window.wait_for(words.faults.what_was_done);
        assert_eq!(window.app().page(), Page::Faults);

        let step = words.content(STEP);
        look_for(&mut window, &step);
        window.wait_for_part(&step);
        window.key(Key::Enter);
        let one: [(&str, &dyn std::fmt::Display); 2] = [("steps", &1), ("time", &"")];
        window.wait_for_part(&fill(words.procedures.chosen, &one));
        assert_eq!(window.app().page(), Page::Procedures);

        look_for(&mut window, page);
        window.key(Key::Enter);
        window.wait_for_page(Page::Signals);

        look_for(&mut window, words.frame.light);
        window.key(Key::ArrowDown);
        window.key(Key::Enter);
        window.until("a light window", |window| {
            window.app().settings.dark == Some(false)
        });

        look_for(&mut window, "bad-1 no such thing");
        window.wait_for(words.common.nothing);
        window.key(Key::Escape);
        window.step();
        assert!(!window.shows(words.frame.find_what));
        let unit = window.app().units.chosen();
        assert_eq!(unit.phase(), Phase::Idle);
        assert!(unit.run.is_none() && !unit.is_armed());

        window.click(words.frame.menu);
        window.click_for(words.frame.lock, words.frame.locked);
        window
            .harness()
            .key_press_modifiers(Modifiers::COMMAND, Key::K);
        window.step();
        assert!(
            !window.shows(words.frame.find_what),
            "nothing of a locked one"
        );
        window.write(words.case.your_name, "Kim");
        window.click(words.frame.unlock);
        look_for(&mut window, words.frame.disconnect);
        window.wait_for(&[words.frame.disconnect, "F9"].join(DOT));
        window.key(Key::Enter);
        window.wait_for(words.frame.not_connected);
    }
}
