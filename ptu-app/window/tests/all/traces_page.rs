//! The page of recorded traces, driven by the names of what is shown.

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::common::window::{Window, settings};
use crate::common::{Place, scripts};
use eframe::egui::Key;
use ptu_options::Page;
use ptu_report::words::Language;
use ptu_window::Settings;

/// A window on the traces of a unit whose EB relay is slow.
fn window(settings: Settings) -> Window {
    let place = Place::new();
    crate::common::record_bad_unit(&place);
    let settings = Settings {
        page: Page::Traces,
        ..settings
    };
    Window::with(place, scripts(), settings)
}

/// Writes the view as CSV, and reads it: heads and rows.
fn csv(window: &mut Window, save: &str, field: &str) -> (Vec<String>, Vec<Vec<String>>) {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    // A new name each time: the message about the last file is still shown.
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let name = window.place.text_path(&format!("view-{count}"));
    window.click_for(window.app().settings.language.words().traces.save, field);
    clear(window, field);
    window.write(field, &name);
    window.click(save);
    let file = PathBuf::from(format!("{name}.csv"));
    // The file is there before all of it is written; that it is saved is said afterwards.
    window.wait_for(&format!("saved: {}", file.display()));
    let text = std::fs::read_to_string(&file).expect("written");
    std::fs::remove_file(&file).expect("there");
    let text = text.strip_prefix('\u{feff}').expect("a mark of UTF-8");
    let mut lines = text
        .lines()
        .map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    (lines.next().expect("heads"), lines.collect())
}

/// Empties a text field.
fn clear(window: &mut Window, field: &str) {
    use eframe::egui::Modifiers;
    use egui_kittest::kittest::Queryable;
    window.wait_for(field);
    let harness = window.harness();
    harness
        .get_all_by_label(field)
        .last()
        .expect("seen")
        .focus();
    harness.step();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.key_press(Key::Delete);
    harness.step();
}

/// The place a head tells, as `A −2.80 s`, in the axis' unit.
fn told_place(window: &Window, cursor: &str) -> f64 {
    let heads = window.shown();
    let head = heads
        .iter()
        .find_map(|text| text.strip_prefix(&format!("{cursor} ")))
        .unwrap_or_else(|| panic!("no place of {cursor}: {heads:#?}"));
    let number = head.split(' ').next().expect("a number");
    number.replace('−', "-").parse().expect("a number")
}

#[test]
fn the_latest_trace_is_open_and_the_cursor_tells_what_the_table_has() {
    let mut window = window(Settings::default());
    window.wait_for_part("unit BAD-1");
    // What was wrong is marked, and is a way to where it was.
    window.wait_for_part("s EB relay · code 25: EB reaction 640 ms, limit 472");
    window.wait_for("0.00 s trigger");
    window.wait_for("speed");

    window.click("Cursor A");
    let (heads, rows) = csv(&mut window, "Save CSV", "file name, without its ending");
    let column = |name: &str| {
        heads
            .iter()
            .position(|head| head == name)
            .expect("a column")
    };
    assert_eq!(heads[0], "time_s");
    let at = told_place(&window, "A");
    let near = |row: &&Vec<String>| (row[0].parse::<f64>().expect("a time") - at).abs() < 0.006;
    let row = rows.iter().find(near).expect("the row under the cursor");
    let speed: f64 = row[column("speed_kmh")].parse().expect("a speed");
    let speed = (speed * 1000.0).round() / 1000.0;
    assert!(
        window.shows(&format!("{speed} km/h")),
        "{:#?}",
        window.shown()
    );

    // Zoomed in there are fewer rows, and all of them again when it fits.
    for _ in 0..4 {
        window.click("Zoom in");
    }
    let (_, part) = csv(&mut window, "Save CSV", "file name, without its ending");
    assert!(
        part.len() < rows.len() / 3,
        "{} of {}",
        part.len(),
        rows.len()
    );
    window.click("Fit");
    let (_, again) = csv(&mut window, "Save CSV", "file name, without its ending");
    assert_eq!(again.len(), rows.len());
}

#[test]
fn over_distance_cursors_keep_their_rows_and_differences_are_told() {
    let mut window = window(Settings::default());
    window.wait_for("0.00 s trigger");
    window.click("Zoom in");
    window.click("Zoom in");
    // A click puts cursor A where the pointer is, here in the middle.
    window.click("lanes");
    window.key(Key::ArrowRight);
    window.key(Key::ArrowRight);
    window.click("Cursor B");
    let (a, b) = (told_place(&window, "A"), told_place(&window, "B"));
    assert!(b > a, "{a} {b}");
    // The last "Statistics" is this page's own; the one before it is the name of another page.
    window.click_last("Statistics");
    window.wait_for(&format!("between the cursors: {:.2} s", b - a));

    window.click_for("distance", "0.00 m trigger");
    window.wait_for_part("between the cursors");
    assert!(window.shows_part(" m"), "{:#?}", window.shown());
    let (heads, _) = csv(&mut window, "Save CSV", "file name, without its ending");
    assert_eq!(heads[..2], ["time_s", "distance_m"]);
    window.click_for_part("Clear", "in view: ");
}

#[test]
fn the_good_twin_tells_which_signals_deviate() {
    let mut window = window(Settings::default());
    window.wait_for("0.00 s trigger");
    window.click("what to compare with");
    window.click_for_part("good twin", "signals deviate, first eb at");
    window.click_for("Show them", "≠ deviates");
    window.click("what to compare with");
    window.click("nothing");
    window.until("no comparison", |window| !window.shows("≠ deviates"));
}

#[test]
fn a_signal_the_trace_lacks_says_so_and_lanes_are_chosen_by_name() {
    let lanes = ["eb", "cabin_temperature"].map(str::to_owned).to_vec();
    let mut window = window(Settings {
        lanes,
        ..Settings::default()
    });
    window.wait_for("not in this trace");
    window.click("Signals");
    window.click("hide: cabin_temperature");
    window.until("the lane is gone", |window| {
        !window.shows("not in this trace")
    });
    window.write("find a signal", "hcr");
    window.click("hcr");
    clear(&mut window, "find a signal");
    window.click("up: hcr");
    window.click_for("Automatic", "down: speed");
}

#[test]
fn in_korean_a_trace_is_found_by_its_fault_and_unit() {
    let mut window = window(Settings {
        language: Language::Korean,
        ..Settings::default()
    });
    window.wait_for("0.00 s 트리거");
    let filter = "필터: 장치, 시험, 날짜, 고장";
    window.write(filter, "bad-1 atp_cpu");
    window.until("fewer traces", |window| {
        let shown = window.shown();
        let rows = |part: &str| shown.iter().filter(|text| text.contains(part)).count();
        rows("ATP CPU 보드 · ") > 0
    });
    clear(&mut window, filter);
    window.write(filter, "GOOD-9");
    window.wait_for("필터에 맞는 신호 기록이 없음");
    window.click_for("거리", "0.00 m 트리거");
}

#[test]
fn a_database_that_is_none_is_told_and_the_window_stays() {
    let place = Place::new();
    place.write("history.db", "this is no database");
    let settings = settings(Page::Traces);
    let mut window = Window::with(place, scripts(), settings);
    window.wait_for_part("The traces cannot be listed");
    for _ in 0..3 {
        window.step();
    }
    assert!(window.shows_part("The traces cannot be listed"));
}

/// Goal: the page and the messages tell in the same words why there is no trace. Method: the samples of a trace are overwritten.
#[test]
fn a_trace_that_cannot_be_opened_is_told_in_the_same_words() {
    let place = Place::with_bad_unit();
    place.change(
        "history.db",
        "UPDATE trace SET data = zeroblob(length(data))",
    );
    let mut window = Window::with(place, scripts(), settings(Page::Traces));
    let begins = Language::English.words().traces.cannot_open;
    window.wait_for_part(begins);
    window.step();
    // The sign stands before a message alone; the reason follows.
    let shown = window.shown();
    let said = shown.windows(2);
    let said = said.filter(|two| two[0].trim_start_matches("⚠ ") == begins);
    let reasons: Vec<_> = said.map(|two| &two[1]).collect();
    assert!(reasons.len() > 1 && !reasons[0].is_empty(), "{shown:?}");
    assert!(reasons.iter().all(|why| *why == reasons[0]), "{shown:?}");
}

/// Goal: two speeds can be read off one axis, and a stretch is looked at and left again. Method: the limit is put into the
/// lane of the speed, which is kept; a drag with the right button, and back.
#[test]
fn signals_share_a_lane_and_a_stretch_is_zoomed_to_and_left() {
    use eframe::egui::{Event, Modifiers, PointerButton, pos2};
    use egui_kittest::kittest::{NodeT, Queryable};
    let lanes = ["speed", "limit", "eb"].map(str::to_owned).to_vec();
    let mut window = window(Settings {
        lanes,
        ..Settings::default()
    });
    window.wait_for("0.00 s trigger");
    window.click("Signals");
    let join = "in one lane with the signal above: limit";
    window.click(join);
    window.step();
    let joined = window.harness().get_by_label(join);
    let joined = joined.accesskit_node().toggled();
    assert!(format!("{joined:?}").contains("True"), "{joined:?}");
    assert!(!window.shows("in one lane with the signal above: eb"));
    let field = "file name, without its ending";
    let (heads, rows) = csv(&mut window, "Save CSV", field);
    assert_eq!(heads[..3], ["time_s", "speed_kmh", "limit_kmh"]);

    // The layout is kept under a name, and comes back after others were shown.
    window.click("layouts");
    window.write("name", "brakes");
    window.click("Save this layout");
    window.key(Key::Escape);
    window.click("Automatic");
    window.click("layouts");
    window.click("brakes");
    window.click_for("layouts", "Forget it");
    window.key(Key::Escape);
    let (heads, _) = csv(&mut window, "Save CSV", field);
    assert_eq!(heads[1..], ["speed_kmh", "limit_kmh", "eb"]);

    assert!(!window.enabled("Zoom back"));
    let rect = window.harness().get_by_label("lanes").rect();
    let at = |share: f32| pos2(rect.left() + share * rect.width(), rect.center().y);
    let button = |share, pressed| Event::PointerButton {
        pos: at(share),
        button: PointerButton::Secondary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    for events in [
        vec![Event::PointerMoved(at(0.4)), button(0.4, true)],
        vec![Event::PointerMoved(at(0.5))],
        vec![Event::PointerMoved(at(0.6))],
        vec![button(0.6, false)],
    ] {
        window.harness().input_mut().events.extend(events);
        window.step();
    }
    let (_, part) = csv(&mut window, "Save CSV", field);
    assert!(
        part.len() < rows.len() / 3,
        "{} of {}",
        part.len(),
        rows.len()
    );
    window.click("Zoom back");
    let (_, again) = csv(&mut window, "Save CSV", field);
    assert_eq!(again.len(), rows.len());
}

/// A file as a desktop hands it over.
#[derive(Debug)]
struct Dropped(PathBuf);

impl eframe::egui::DroppedFile for Dropped {
    fn path(&self) -> &std::path::Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

/// Goal: what another program recorded is seen beside the unit's trace without a command. Method: an export of the open trace
/// in each format is dropped on the page and deviates nowhere, nor does a part of it; one with another value does; a file that
/// cannot be read is told.
#[test]
fn a_dropped_file_is_laid_behind_the_trace() {
    let mut window = window(Settings::default());
    window.wait_for("0.00 s trigger");
    // The page has the first trace of the latest run open.
    let store = fault_db::Store::open_read_only(&window.place.path("history.db")).expect("read");
    let run = store.resolve_run("latest").expect("a run");
    let open = store.traces(run).expect("traces")[0].id.to_string();
    let drop = |window: &mut Window, file: &std::path::Path| {
        let dropped = Dropped(file.to_owned());
        window
            .harness()
            .input_mut()
            .dropped_files
            .push(std::sync::Arc::new(dropped));
        // What was said of the file before goes with the second frame.
        window.step();
        window.step();
    };
    let part = ["--window", "-1..1"];
    for (name, part) in [
        ("other.csv", &[][..]),
        ("whole.parquet", &[]),
        ("part.parquet", &part),
        ("part.mcap", &part),
    ] {
        let file = window.place.path(name);
        let to = window.place.text_path(name);
        let export = [&["trace", "export", &open, "--out", &to][..], part].concat();
        window.place.ptu(&export).exits(0);
        drop(&mut window, &file);
        window.wait_for("no signal differs");
    }
    let file = window.place.path("other.csv");
    let text = std::fs::read_to_string(&file).expect("exported");
    assert!(text.contains(",released"), "{}", &text[..300]);
    std::fs::write(&file, text.replace(",released", ",applied")).expect("changed");
    drop(&mut window, &file);
    window.wait_for_part("signals deviate, first ");
    for (name, told) in [
        ("other.parquet", "damaged, or no Parquet file"),
        ("other.docx", "Only .csv, .parquet and .mcap files"),
    ] {
        window.place.write(name, "this is no trace");
        let other = window.place.path(name);
        drop(&mut window, &other);
        window.wait_for_part(told);
    }
}

/// Goal: what a technician saw in a trace is found by whoever looks at it next. Method: a note at cursor A, read back
/// in the window, by `trace show` and `runs show`, and in the file beside an exported one.
#[test]
fn a_note_at_the_cursor_is_kept_with_its_place() {
    let mut window = window(Settings {
        operator: "kim".into(),
        ..Settings::default()
    });
    window.wait_for("0.00 s trigger");
    assert!(!window.shows("note at cursor A"));
    window.click("Cursor A");
    let at_s = told_place(&window, "A");
    window.write("note at cursor A", "the wheel slips");
    window.click_for_part("Save note", "s the wheel slips");
    let told = window.shown().into_iter();
    let told: Vec<_> = told
        .filter(|text| text.ends_with("s the wheel slips"))
        .collect();
    let place = format!("{at_s:.2} s").replace('-', "−");
    assert_eq!(told, [format!("1  {place} the wheel slips")]);

    let store = fault_db::Store::open_read_only(&window.place.path("history.db")).expect("read");
    let run = store.resolve_run("latest").expect("a run");
    let open = store.traces(run).expect("traces")[0].id.to_string();
    let place_of = &window.place;
    let json = place_of.json(&["trace", "show", &open, "--json"]);
    let note = &json["notes"][0];
    assert_eq!(
        (&note["who"], &note["text"]),
        (&"kim".into(), &"the wheel slips".into())
    );
    let time_s = note["time_s"].as_f64().expect("a time");
    assert!((time_s - at_s).abs() < 0.006, "{time_s} {at_s}");
    for command in [&["trace", "show", &open][..], &["runs", "show", "latest"]] {
        let said = place_of.ptu(command).out;
        assert!(
            said.contains("the wheel slips") && said.contains(&place),
            "{said}"
        );
    }
    let to = place_of.text_path("noted.csv");
    place_of
        .ptu(&["trace", "export", &open, "--out", &to])
        .exits(0);
    let beside = place_of.path("noted.csv-metadata.json");
    let beside = std::fs::read_to_string(beside).expect("written");
    assert!(beside.contains("the wheel slips"), "{beside}");
}
