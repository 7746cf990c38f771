//! The page of automatic runs.

use crate::common::window::{Window, settings, settings_in};
use crate::common::{Place, number, scripts};
use ptu_options::Page;
use ptu_report::words::Language;

/// Goal: who has no terminal drives the same run as the command line. Method: a full train is driven from the window in both
/// languages; figures, place of the stop and events are those of the command.
#[test]
fn a_run_from_the_window_is_that_of_the_command_line() {
    for language in Language::ALL {
        let words = language.words();
        let place = Place::new();
        let command = ["drive", "--load", "full", "--controller", "pss", "--json"];
        let said = place.ptu(&command);
        let run: serde_json::Value = serde_json::from_str(&said.out).expect("JSON");
        let settings = settings_in(language, Page::Drive);
        let mut window = Window::with(place, scripts(), settings);
        for (list, value) in [
            (words.drive.load, words.drive.full),
            (words.drive.controller, "pss"),
        ] {
            window.wait_for(list);
            window.click_last(list);
            window.click(value);
        }
        window.click_for(words.drive.drive, words.drive.figures);
        let error_cm = format!("{:.1} cm", number(&run["stop_error_m"]) * 100.0);
        let error_cm = error_cm.trim_start_matches('-');
        assert!(window.shows_part(error_cm), "{error_cm}");
        for (key, decimals) in [("run_time_s", 1), ("rms_jerk_m_s3", 3), ("energy_kwh", 2)] {
            window.scroll_to(&format!("{:.decimals$}", number(&run[key])));
        }
        for plot in ["Speed over time", "Position over time", "The last metres"] {
            window.scroll_to(&words.content(plot));
        }
        window.scroll_to(&words.content("stop curve takes over"));
        // Nothing of it is in the history.
        assert!(!window.place.path("history.db").exists());
    }
}

/// Goal: a long order is stopped, and how far it came is told. Method: all sections under all controllers, and Stop.
#[test]
fn a_long_order_is_stopped_and_how_far_it_came_is_told() {
    let words = Language::English.words();
    let mut window = Window::with(Place::new(), scripts(), settings(Page::Drive));
    for (list, value) in [
        (words.drive.section, words.drive.all_sections),
        (words.drive.controller, words.drive.side_by_side),
    ] {
        window.wait_for(list);
        window.click_last(list);
        window.click(value);
    }
    window.click(words.drive.drive);
    window.click_for_part(words.memory.stop, "Stopped: ");
    assert!(window.enabled(words.drive.drive));
}
