//! The lock between two shifts: what a locked window still does, and what it does no more.

use crate::common::window::{Window, latest, settings};
use crate::common::{Place, scripts};
use crate::layout::complaints;
use eframe::egui::{Key, Modifiers};
use ptu_options::Page;
use ptu_report::words::Language;
use ptu_runs::bench_worker::Phase;
use ptu_window::Settings;

/// Goal: who has gone home has nothing started, armed or written in his name, and what goes on can be seen and stopped.
/// Method: a run under way when the window is locked; every way to begin something, and F12; then a name.
#[test]
fn a_locked_window_shows_and_stops_and_begins_nothing() {
    for language in Language::ALL {
        let words = language.words();
        let (frame, case) = (&words.frame, &words.case);
        let mut settings = Settings {
            language,
            operator: "Kim".into(),
            ..settings(Page::Procedures)
        };
        settings.unit.realtime = true;
        let mut window = Window::sized([900.0, 600.0], Place::new(), scripts(), settings);
        window.connect_simulated();
        window.click(words.procedures.run);
        window.wait_for_phase(Phase::Running);
        window.page(Page::Case);
        window.click_for(frame.lock, frame.locked);
        assert_eq!(complaints(&mut window), Vec::<String>::new());
        // The run goes on, and is still seen.
        window.page(Page::Bench);
        window.wait_for(words.bench.group_speed);
        assert_eq!(window.phase(), Phase::Running);
        window.key(Key::F12);
        window.wait_for_phase(Phase::Idle);
        assert_eq!(latest(&window)["run"]["verdict"], "aborted");
        assert_eq!(latest(&window)["run"]["operator"], "Kim");

        // No way begins anything, lets the unit go, or writes.
        for page in Page::ALL {
            window.page(page);
            window.step();
            for name in [
                frame.disconnect,
                frame.arm,
                words.procedures.run,
                words.procedures.find_part,
                words.report.write_pdf,
                case.new_case,
            ] {
                assert!(!window.enabled(name), "{} on {page:?}", name);
            }
        }
        let harness = window.harness();
        harness.key_press_modifiers(Modifiers::COMMAND, Key::K);
        window.key(Key::F9);
        window.step();
        assert!(!window.shows(frame.find_what));
        assert_eq!(window.phase(), Phase::Idle, "still connected");
        assert!(!window.enabled(frame.unlock), "without a name");

        window.write(case.your_name, "Lee");
        window.click(frame.unlock);
        window.page(Page::Procedures);
        window.until("the run's button", |window| {
            window.enabled(words.procedures.run)
        });
        assert!(!window.shows(frame.locked));
    }
}
