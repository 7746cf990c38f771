//! The window on a real display: a picture of every page, in a language that is drawn, kept in the target directory to be looked at,
//! and a window that is closed or told to end.

use std::cell::Cell;
use std::time::{Duration, Instant};

use crate::common::display::{Display, Shown};
use crate::common::picture::Picture;
use crate::common::{Place, has, list};
use fuzzing::draw;
use ptu_options::Page;
use ptu_runs::run::BenchChoice;
use ptu_window::Settings;

/// Pages, in the order of their keys F1 to F6.
const PAGES: [&str; 6] = [
    "bench",
    "procedures",
    "traces",
    "faults",
    "diagnosis",
    "report",
];

/// Where the button that begins a run is on the page of procedures.
const RUN: [&str; 2] = ["494", "68"];

/// Where a field is on the page of sheets.
const FIND: [&str; 2] = ["190", "90"];

/// Time after which the click is repeated.
const AGAIN: Duration = Duration::from_secs(3);

#[test]
fn every_page_is_shown_on_a_real_display() {
    let place = Place::new();
    let failed = place.ptu("run atp --inject eb_relay.slow");
    assert_eq!(failed.code, Some(1), "{}", failed.err);
    let display = Display::new(&place);
    for language in draw::drawn(["en", "ko"], 2) {
        // Not on the page that it was closed on, of which the first picture could be.
        let from_the_first = ["--unit", "sim", "--lang", language, "--page", "bench"];
        let shown = Shown::open(&place, &display, &from_the_first);
        let mut pictures: Vec<Picture> = Vec::new();
        for (number, page) in (1..).zip(PAGES) {
            shown.key(&format!("F{number}"));
            // The page before has settled, too, and may still be there.
            shown.until(page, |display| {
                let picture = display.picture();
                pictures.iter().all(|other| picture.differs(other) > 0.01)
            });
            let picture = shown.settled();
            picture.keep(&format!("{page}-{language}"));
            assert!(picture.colours() > 20, "{page} shows something");
            pictures.push(picture);
        }
        for (place, one) in pictures.iter().enumerate() {
            for (after, other) in pictures.iter().enumerate().skip(place + 1) {
                assert!(
                    one.differs(other) > 0.01,
                    "{} and {} look alike in {language}",
                    PAGES[place],
                    PAGES[after]
                );
            }
        }
        shown.close();
    }
}

/// Goal: a serial number goes from the window into another program. Method: what is typed into a field is copied by keys, and
/// the display's clipboard has an owner.
#[test]
fn what_is_copied_is_on_the_clipboard_of_the_system() {
    let place = Place::new();
    let display = Display::new(&place);
    let shown = Shown::open(&place, &display, &["--page", "report"]);
    shown.settled();
    assert!(!display.has_copied());
    shown.until("a copy", |display| {
        let [x, y] = FIND;
        display.tool(&["mousemove", x, y, "click", "1"]);
        display.tool(&["type", "R-0815"]);
        display.tool(&["key", "ctrl+a", "ctrl+c"]);
        display.has_copied()
    });
    shown.close();
}

/// Goal: a run is not lost with the window. Method: a run that takes as long as on a real unit, and the
/// window closed, or told to end, in the midst of it.
#[test]
fn a_window_closed_in_mid_run_leaves_a_closed_record() {
    for told_to_end in [None, Some("TERM"), Some("HUP")] {
        let place = Place::new();
        let settings = Settings {
            page: Page::Procedures,
            unit: BenchChoice {
                realtime: true,
                ..BenchChoice::default()
            },
            ..Settings::default()
        };
        let file = place.path("config/ptu/window.json");
        settings.save(&file).expect("settings");
        let display = Display::new(&place);
        let shown = Shown::open(&place, &display, &["--unit", "sim"]);
        shown.settled();
        let [x, y] = RUN;
        let clicked = Cell::new(None::<Instant>);
        shown.until("the run", |display| {
            // The unit may not be there yet, and the button not be enabled. In a run another stands there,
            // which pauses it: it is in its midst all the same.
            if clicked.get().is_none_or(|at| at.elapsed() > AGAIN) {
                display.tool(&["mousemove", x, y, "click", "1"]);
                clicked.set(Some(Instant::now()));
            }
            place.ptu("runs show latest").code == Some(0)
        });
        match told_to_end {
            Some(signal) => shown.tell(signal),
            None => shown.close(),
        }
        let runs = place.json("runs list --json");
        let [run] = list(&runs) else {
            panic!("one run: {runs}")
        };
        assert_eq!(run["verdict"], "aborted", "{run}");
        assert_eq!(run["state"], "finished", "{run}");
    }
}

#[test]
fn without_a_display_it_says_so_and_ends() {
    let place = Place::with_database();
    let say = |arguments: &[&str], display: Option<&str>| {
        let mut ptu = place.command(arguments);
        ptu.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
        ptu.envs(display.map(|name| ("DISPLAY", name)));
        let output = ptu.output().expect("ptu starts");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(3), "{said}");
        assert!(!said.contains("panicked"), "{said}");
        said
    };
    // Without a verb it is the window, too.
    for arguments in [&["gui"][..], &[]] {
        let said = say(arguments, None);
        has(&said, &["no display", "ptu run"]);
        let said = say(arguments, Some(":4711"));
        assert!(said.contains("cannot open a window"), "{said}");
    }
}
