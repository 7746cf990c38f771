//! The page with the test sheet: what it shows, the files it writes, and notes on a run.

use crate::common::window::{Window, own_scripts, settings};
use crate::common::{Place, list, record_bad_unit, scripts};
use eframe::egui::Key;
use ptu_options::Page;
use ptu_report::words::Language;
use ptu_window::Settings;

/// A window on the report page over a run that passed, and a later one that failed.
fn window(language: Language) -> Window {
    let place = Place::new();
    place.recorded_run();
    record_bad_unit(&place);
    on(place, language)
}

fn on(place: Place, language: Language) -> Window {
    let settings = Settings {
        page: Page::Report,
        language,
        operator: "Lee".into(),
        ..Settings::default()
    };
    Window::with(place, scripts(), settings)
}

fn begins(window: &Window, name: &str, with: &[u8]) -> bool {
    std::fs::read(window.place.path(name)).is_ok_and(|file| file.starts_with(with))
}

#[test]
fn the_latest_run_is_shown_and_written_to_files() {
    let mut window = window(Language::English);
    window.wait_for("Test sheet");
    window.wait_for("Failed");
    window.wait_for_part("Unit BAD-1, run");
    window.wait_for("code 25: alarm, FSB, EB");
    window.key(Key::PageDown);
    window.wait_for("472");
    let file = window.place.text_path("mine.pdf");
    window.name_file("file", &file);
    for (button, name, begin) in [
        ("PDF", "mine.pdf", &b"%PDF-"[..]),
        ("HTML", "mine.html", b"<!DOCTYPE html>"),
        ("CSV", "mine.csv", b"\xef\xbb\xbfrun,unit_serial,"),
    ] {
        window.click_for(
            button,
            &format!("Written: {}", window.place.text_path(name)),
        );
        assert!(begins(&window, name, begin), "{name}");
    }
    assert!(window.place.read("mine.html").contains("EB reaction"));
    // Never over a file that is there.
    window.click("PDF");
    let beside = window.place.text_path("mine-2.pdf");
    window.wait_for(&format!("Written: {beside}"));
}

/// What was done last is what the person wants to see, whether it passed or not.
#[test]
fn a_run_that_passed_after_one_that_failed_is_shown() {
    let place = Place::with_bad_unit();
    let good = place.recorded_run();
    let mut window = on(place, Language::English);
    let short = good.get(good.len() - 8..).expect("an id");
    window.wait_for_part(&format!(", run {short}"));
}

/// Goal: nobody takes one unit's sheet for another's. Method: a run of a unit, then the window connects to another; each
/// run that ends there is shown, and an older one of the first unit only when it is clicked, with a word about it.
#[test]
fn the_pages_follow_the_connected_unit_and_the_run_just_made() {
    let place = Place::new();
    let arguments = ["run", "--inject", "eb_relay.slow", "atp/overspeed"];
    place.ptu(&arguments).exits(1);
    let first = place.run_ids().swap_remove(0);
    let apart = Place::new();
    let own = own_scripts(
        &apart,
        "procedure(title = \"Alarm\", suspect = \"tra\")\nstep(\"quiet\", do = [wait(s(1))], measure = value(\"v\", speed))\n",
    );
    let mut settings = settings(Page::Report);
    settings.unit.serial = "ABC-1".into();
    let mut window = Window::with(place, &own, settings);
    window.wait_for_part("Unit SIM-0001, run");
    window.connect();
    window.wait_for("ABC-1");
    window.wait_for("Choose a run in the list.");
    window.page(Page::Diagnosis);
    window.wait_for("Choose a run in the list");
    assert!(!window.shows_part("unit SIM-0001,"));
    for _ in 0..2 {
        window.page(Page::Procedures);
        window.click_for_part("Run", "Run over: passed");
        let latest = window.place.run_ids().swap_remove(0);
        let short = latest.get(latest.len() - 8..).expect("an id").to_owned();
        window.page(Page::Report);
        window.wait_for_part(&format!("Unit ABC-1, run {short}"));
        assert!(!window.shows_part("of another unit"));
        window.click_part(" · SIM-0001");
        let short = first.get(first.len() - 8..).expect("an id");
        window.wait_for_part(&format!("Unit SIM-0001, run {short}"));
        window.wait_for_part("of another unit: SIM-0001, not ABC-1");
    }
}

/// Goal: what another program does is seen, and a loss is not hidden. Method: a window over nothing; a run by the command
/// line appears by itself; then the file is taken away and put back.
#[test]
fn what_another_program_records_is_shown_and_a_lost_database_is_said() {
    let mut window = Window::open(Page::Faults);
    window.wait_for("0 of 0 faults");
    record_bad_unit(&window.place);
    window.until("the faults", |window| {
        !window.shows("0 of 0 faults") && window.shows_part(" faults")
    });
    window.page(Page::Report);
    window.wait_for_part("Unit BAD-1, run");
    let (there, away) = (
        window.place.path("history.db"),
        window.place.path("away.db"),
    );
    std::fs::rename(&there, &away).expect("taken away");
    window.wait_for_part("The database is gone");
    window.page(Page::Faults);
    window.wait_for("The fault history cannot be read");
    assert!(!there.exists(), "made again in silence");
    std::fs::rename(&away, &there).expect("put back");
    window.until("the faults", |window| window.shows_part(" faults"));
    window.until("what is over to go", |window| {
        !window.shows_part("The database is gone")
    });
}

#[test]
fn a_file_that_cannot_be_written_is_said() {
    let mut window = window(Language::English);
    let nowhere = window.place.text_path("no/such/folder/x.pdf");
    window.name_file("file", &nowhere);
    window.click_for_part("PDF", "The report was not written");
    window.wait_for_part("there is no folder");
    window.name_file("file", " ");
    window.click_for("HTML", "name a file");
}

#[test]
fn a_note_is_kept_and_stands_on_the_sheet() {
    let mut window = window(Language::English);
    window.wait_for("code 25: alarm, FSB, EB");
    assert!(!window.enabled("Save note"), "nothing to save");
    window.write("note on this run", "relay K3 clicks late");
    window.click_for("Save note", "Note saved");
    window.wait_for("relay K3 clicks late");
    window.wait_for("Noted by");
    let bad = window.place.run_ids().swap_remove(0);
    let run = window.place.json(&["runs", "show", &bad, "--json"]);
    let [note] = list(&run["notes"]) else {
        panic!("one note: {run}")
    };
    assert_eq!(
        (&note["who"], &note["text"]),
        (&"Lee".into(), &"relay K3 clicks late".into())
    );
}

/// The lines break as on the printed page; what is read and copied is the text.
#[test]
fn a_text_of_several_lines_is_read_as_one() {
    let place = Place::with_bad_unit();
    let text = "relay K3 clicks late, seen from the wall side of the rack; ".repeat(5) + "\n\nend";
    place.ptu(&["runs", "note", "latest", &text]).exits(0);
    let mut window = on(place, Language::English);
    window.wait_for(&text);
    assert!(window.shows("Test sheet   BAD-1"), "the page's header");
}

#[test]
fn a_note_is_written_as_soon_as_a_run_is_over() {
    let mut settings = Settings {
        page: Page::Procedures,
        operator: "Lee".into(),
        ..Settings::default()
    };
    settings.unit.faults = vec!["tra.dead".into()];
    let mut window = Window::connected(Place::new(), settings);
    window.click_for_part("Find the part", "Run over: failed");
    window.write("note on this run", "TRA warm to the touch");
    window.click_for("Save note", "Note saved");
    let latest = ["runs", "show", "latest", "--json"];
    let run = window.place.json(&latest);
    assert_eq!(run["notes"][0]["text"], "TRA warm to the touch", "{run}");
}

/// The sheet has a language of its own, and the window's until one is chosen.
#[test]
fn the_sheet_is_korean_in_a_korean_window_and_english_if_wanted() {
    let mut window = window(Language::Korean);
    window.wait_for("시험 성적서");
    window.wait_for("불합격");
    window.wait_for("미합격 항목");
    window.click_for("English", "What did not pass");
    let file = window.place.text_path("english");
    window.name_file("파일", &file);
    window.click_for_part("HTML", "저장 완료");
    assert!(window.place.read("english.html").contains("lang=\"en\""));
}

#[test]
fn the_sheet_leads_to_the_traces_and_is_there_again_afterwards() {
    let mut window = window(Language::English);
    window.wait_for("code 25: alarm, FSB, EB");
    let traces = window
        .shown()
        .into_iter()
        .find(|name| name.starts_with("Traces ("));
    window.click(&traces.expect("traces of failures"));
    let of_run = |name: &String| name.starts_with("EB relay · code 25: EB reaction 640 ms");
    let first = window.shown().into_iter().find(of_run);
    window.click(&first.expect("a trace"));
    window.wait_for_page(Page::Traces);
    window.key(Key::F6);
    window.wait_for("code 25: alarm, FSB, EB");
}

#[test]
fn notes_are_written_and_shown_on_the_command_line_and_in_reports() {
    let place = Place::new();
    let run = place.recorded_run();
    let note = ["runs", "note", &run, "=HYPERLINK(\"x\")", "--who", "김"];
    place.ptu(&note).exits(0);
    place.ptu(&["runs", "note", &run, " "]).exits(2);
    place.ptu("runs note ffffffff x").exits(2);
    let said = place.ptu(&["runs", "show", &run]).exits(0);
    assert!(
        said.out.contains("=HYPERLINK") && said.out.contains('김'),
        "{}",
        said.out
    );
    for language in ["en", "ko"] {
        let (html, pdf) = (format!("{language}.html"), format!("{language}.pdf"));
        let show = ["runs", "show", &run, "--lang", language];
        let reports = ["--report", &html, "--report", &pdf];
        place.ptu(&[&show[..], &reports].concat()).exits(0);
        assert!(place.read(&html).contains("=HYPERLINK(&quot;x&quot;)"));
    }
}
