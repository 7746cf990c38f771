//! What hurried hands, other sizes and another window do: nothing false is shown, and nothing is lost.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;

use crate::common::window::{Window, latest, settings};
use crate::common::{Place, list, relay_fault, text};
use crate::layout::{SIZES, complaints};
use eframe::egui::Key;
use fuzzing::draw;
use ptu_options::Page;
use ptu_report::words::{Language, Words};
use ptu_runs::bench_worker::Phase;
use ptu_window::Settings;

/// Number of buttons of a page that are tried.
const MOST: usize = 120;

fn words() -> &'static Words {
    Language::English.words()
}

/// A window on the history of a bad unit, with a simulated unit that has the same fault.
fn connected(page: Page) -> Window {
    let place = Place::with_bad_unit();
    let mut settings = Settings {
        operator: "Kim".into(),
        ..settings(page)
    };
    settings.unit.faults = vec!["eb_relay.slow".into()];
    Window::connected(place, settings)
}

/// Rows that a person or a run writes: runs, notes, and the events of each fault by their kind.
fn written(window: &Window) -> BTreeMap<String, u32> {
    let database = rusqlite::Connection::open(window.place.path("history.db")).expect("database");
    let mut all = BTreeMap::new();
    for (of, each) in [
        ("run", "''"),
        ("run_note", "''"),
        ("fault_event", "fault || ' ' || kind"),
    ] {
        let asked = format!("SELECT {each}, count(*) FROM {of} GROUP BY 1");
        let mut asked = database.prepare(&asked).expect("a question");
        let row = |row: &rusqlite::Row<'_>| Ok((row.get::<_, String>(0)?, row.get(1)?));
        for row in asked.query_map([], row).expect("an answer") {
            let (each, count) = row.expect("a row");
            all.insert(format!("{of} {each}"), count);
        }
    }
    all
}

/// Sheets and waveforms that were written.
fn files(window: &Window) -> usize {
    let all = std::fs::read_dir(window.place.path("")).expect("a folder");
    let names = all.map(|file| file.expect("a file").file_name());
    let is_one = |name: &OsString| {
        ["sheet", "wave"]
            .iter()
            .any(|of| name.to_string_lossy().starts_with(of))
    };
    names.filter(is_one).count()
}

/// Waits until the database has answered every question, and no run goes on.
fn settle(window: &mut Window) {
    for _ in 0..3 {
        let last = window.app().queries.run(|_| Ok(()));
        window.until("answers", |_| last.take().is_some());
        window.step();
    }
    if window.phase() == Phase::Running {
        window.key(Key::F12);
        window.wait_for_phase(Phase::Idle);
    }
}

/// Goal: a click that was meant once acts once. Method: every button of a page, and those that come by it, is clicked twice within
/// 200 ms; no row is written twice by it, no second file, and no unit is armed.
#[test]
fn every_button_clicked_twice_writes_once_and_arms_nothing() {
    let words = words();
    let looked_for = [
        words.faults.find,
        words.procedures.find,
        words.traces.filter,
        words.traces.find_signal,
        words.bench.find,
        words.life.search,
    ];
    for page in draw::drawn(Page::ALL, 3) {
        let (mut window, mut wrote) = (connected(page), 0);
        if page == Page::Faults {
            window.click_in(words.common.unit, words.statistics.all_units);
            window.click_part("EB relay · ");
            window.wait_for(words.faults.acknowledge);
        }
        let mut tried: BTreeSet<String> = [words.frame.lock.to_owned()].into();
        let next = |window: &Window, tried: &BTreeSet<String>| {
            let mut buttons = window.buttons().into_iter();
            buttons.find(|(name, at)| {
                let of_page = at.left() > 84.0 && at.top() > 56.0 || name == words.frame.arm;
                of_page && !tried.contains(name)
            })
        };
        while tried.len() < MOST {
            for field in window.empty_fields(&looked_for) {
                window.write(&field, "in haste");
            }
            if next(&window, &tried).is_none() {
                // What is behind a dialog or a menu.
                for _ in 0..2 {
                    window.key(Key::Escape);
                }
                window.page(page);
                window.step();
            }
            let Some((name, _)) = next(&window, &tried) else {
                break;
            };
            tried.insert(name.clone());
            if ["PDF", "HTML", "CSV"].contains(&&*name) {
                let place = window.place.text_path("sheet");
                window.name_file(words.report.file, &place);
            }
            let saves = [words.signals.record, words.signals.save].contains(&&*name);
            if page == Page::Signals && saves {
                let place = window.place.text_path("wave.wav");
                window.name_file(words.common.file, &place);
            }
            settle(&mut window);
            let before = (written(&window), files(&window));
            let mut buttons = window.buttons().into_iter();
            let Some((_, at)) = buttons.find(|(of, _)| *of == name) else {
                continue;
            };
            window.double_click_at(at.center());
            settle(&mut window);
            let after = (written(&window), files(&window));
            for (what, count) in &after.0 {
                let more = count - before.0.get(what).copied().unwrap_or(0);
                assert!(more <= 1, "{page:?}: {name} wrote {more} of {what}");
                wrote += more;
            }
            assert!(after.1 <= before.1 + 1, "{page:?}: {name} wrote two files");
            assert!(!window.shows(words.frame.armed), "{page:?}: {name} arms");
        }
        assert!(tried.len() > 3, "{page:?}: {:?}", window.shown());
        println!("{page:?}: {} buttons, {wrote} rows written", tried.len());
    }
}

/// Goal: who makes the window larger while a run goes on loses nothing of either. Method: a run at the pace of a real unit; each page
/// is shown at each size; all can be read and clicked, and the run goes on to its end.
#[test]
fn each_page_is_resized_while_a_run_goes_on() {
    let words = words();
    let mut window = connected(Page::Procedures);
    let mut realtime = window.app().settings.clone();
    realtime.unit.realtime = true;
    window = Window::connected(window.place, realtime);
    window.click(words.procedures.run);
    window.until("a step", |window| window.steps_run() > 0);
    let mut wrong = Vec::new();
    for page in Page::ALL {
        window.page(page);
        for size in SIZES {
            window.harness().set_size(size.into());
            window.step();
            window.step();
            let found = complaints(&mut window).into_iter();
            wrong.extend(found.map(|found| format!("{page:?} {size:?}: {found}")));
            let phase = window.phase();
            assert_eq!(phase, Phase::Running, "{page:?} {size:?}");
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    let before = window.steps_run();
    window.until("another step", |window| window.steps_run() > before);
    window.key(Key::F12);
    window.wait_for_phase(Phase::Idle);
    let shown = window.steps_run();
    let run = latest(&window);
    assert_eq!(run["run"]["state"], "finished");
    assert!(list(&run["steps"]).len() >= shown as usize, "{shown} steps");
}

/// Goal: two windows on one history tell the same, and what one writes the other does not write again. Method: both acknowledge a fault
/// at once; both run a unit at once.
#[test]
fn two_windows_on_one_file_lose_nothing() {
    let words = words();
    let mut one = connected(Page::Faults);
    let mut other = one.beside(one.app().settings.clone());
    other.connect_simulated();
    let mut both = [&mut one, &mut other];
    for window in &mut both {
        window.click_in(words.common.unit, words.statistics.all_units);
        window.click_part("EB relay · ");
        window.wait_for(words.faults.acknowledge);
    }
    for window in &mut both {
        window.click(words.faults.acknowledge);
    }
    let acknowledged = words.fault_state(fault_db::FaultState::Acknowledged);
    for window in &mut both {
        window.wait_for(acknowledged);
        settle(window);
        assert!(!window.enabled(words.faults.acknowledge));
        window.page(Page::Procedures);
        window.wait_for(words.procedures.run);
    }
    let id = relay_fault(&both[0].place)["id"].clone();
    let shown = ["faults", "show", text(&id), "--json"];
    let shown = both[0].place.json(&shown);
    let by_hand = list(&shown["events"])
        .iter()
        .filter(|event| event["who"] == "Kim");
    let states: Vec<_> = by_hand.map(|event| &event["state"]).collect();
    assert_eq!(states, ["acknowledged"]);
    for window in &mut both {
        window.click(words.procedures.run);
    }
    let mut runs = BTreeSet::new();
    for window in &mut both {
        window.until("the run is stored", |window| window.run_id().is_some());
        runs.insert(window.run_id().expect("just seen"));
    }
    assert_eq!(runs.len(), 2);
    for run in runs {
        let stored = both[0]
            .place
            .json(&["runs", "show", &run.to_string(), "--json"]);
        assert_eq!(stored["run"]["state"], "finished");
        assert_eq!(stored["run"]["verdict"], "failed");
    }
}
