//! The way of one case: from the symptom to the signed sheet in ten clicks, in both languages.

use crate::common::Place;
use crate::common::window::{Window, latest, on_bad_unit, settings};
use crate::common::{list, scripts, text};
use crate::layout::{complaints, complaints_of};
use eframe::egui::{Event, Key, Modifiers};
use ptu_options::Page;
use ptu_report::words::{Language, Words, fill};
use ptu_window::{Density, Settings};

/// Where the unit of these cases is brought to.
const DEPOT: &str = "Sinnae 2";

/// Symptom of the case.
const SYMPTOM: &str = "brakes late or not at all";

/// Clicks that a case may take.
const CLICKS: usize = 10;

/// A window whose clicks are counted.
struct Counted {
    window: Window,
    clicks: usize,
    /// The window is used by keys alone.
    by_key: bool,
    /// What can be clicked is to be so high, points.
    lowest: f32,
    /// What could not be read or clicked on the way.
    wrong: Vec<String>,
}

impl Counted {
    fn click(&mut self, label: &str) {
        self.press(label);
        self.clicks += 1;
    }

    /// Presses something by what this window is used by.
    fn press(&mut self, label: &str) {
        match self.by_key {
            true => self.window.press(label),
            false => self.window.click_last(label),
        }
    }

    /// Writes this in place of what is in a field.
    fn write(&mut self, label: &str, written: &str) {
        if !self.by_key {
            return self.window.write_over(label, written);
        }
        self.window.tab_to(label, true);
        let harness = self.window.harness();
        harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
        self.window.step();
        let written = Event::Text(written.into());
        self.window.harness().event(written);
        self.window.step();
    }

    /// Connects the simulated unit, and has the failed part looked for; in English.
    fn look_for_part(&mut self) {
        let case = &Language::English.words().case;
        self.click("Connect");
        self.window.wait_for("SIM-0001");
        self.click(case.unknown);
        self.click(case.find_part);
    }

    /// Leads as far as the dialog in which the sheet of a found part is signed.
    fn open_sign(&mut self) {
        let case = &Language::English.words().case;
        self.look_for_part();
        self.window.wait_for(case.record_repair);
        self.click(&format!("7 {}", case.stage_sheet));
        self.click(case.sign);
    }

    /// Looks at the page as a person would who reads it.
    fn look(&mut self, stage: &str) {
        if self.by_key {
            return;
        }
        let found = complaints_of(&mut self.window, self.lowest).into_iter();
        self.wrong
            .extend(found.map(|said| format!("{stage}: {said}")));
        let settings = &self.window.app().settings;
        let (language, density) = (settings.language, settings.density);
        let wide = self.window.harness().ctx.content_rect().right();
        let name = format!("case {stage} {wide} {language:?} {density:?}");
        self.window.keep_picture(&name);
    }
}

/// A window on the case page, small or as a laptop has it, and a simulated unit with these faults.
fn window(language: Language, size: [f32; 2], density: Density, faults: &str) -> Counted {
    let mut settings = Settings {
        language,
        density,
        operator: "Kim".into(),
        depot: DEPOT.into(),
        ..settings(Page::Case)
    };
    settings.unit.faults = faults.split(',').map(str::to_owned).collect();
    let mut window = Window::with(Place::new(), scripts(), settings);
    window.harness().set_size(size.into());
    // Bars that have more lines in another size have their height in the picture after.
    window.step();
    window.step();
    Counted {
        window,
        clicks: 0,
        by_key: false,
        lowest: match density {
            // A low window has a lower rail.
            Density::Operator if size[1] < 660.0 => 44.0,
            Density::Operator => 48.0,
            Density::Engineer => 28.0,
        },
        wrong: Vec::new(),
    }
}

/// A window in English whose case has found a part of a unit with these faults, and asks for the repair.
fn repairing(faults: &str) -> Counted {
    let case = &Language::English.words().case;
    let size = [1280.0, 800.0];
    let mut counted = window(Language::English, size, Density::Operator, faults);
    counted.look_for_part();
    counted.window.until("the result", |window| {
        let run = window.app().units.chosen().run_of_case();
        let is_told = window.shows(case.record_repair);
        // While it is worked out what a run says, no way leads away from it.
        if run.is_some_and(|run| !run.is_running()) && !is_told {
            assert!(!window.enabled(case.back) && !window.enabled("2 Symptom"));
        }
        is_told
    });
    counted.click(case.record_repair);
    counted.window.wait_for(case.serial_new);
    counted
}

/// Goal: a signature that was begun is nobody else's. Method: its dialog is open when another page is shown, and there the window is
/// locked; back at the case there is no dialog.
#[test]
fn a_signature_that_was_begun_goes_with_its_page() {
    let words = Language::English.words();
    let case = &words.case;
    let mut counted = window(
        Language::English,
        [1280.0, 800.0],
        Density::Operator,
        "eb_relay.slow",
    );
    counted.open_sign();
    let window = &mut counted.window;
    window.wait_for(case.sign_hint);
    window.page(Page::Procedures);
    window.click(words.frame.menu);
    window.click_for(words.frame.lock, words.frame.locked);
    window.page(Page::Case);
    window.wait_for(case.sign);
    window.step();
    assert!(!window.shows(case.sign_hint));
}

/// Goal: the part is found, replaced and proven by as few clicks as there are decisions, and what is stored is what was
/// done. Method: a slow EB relay, in both languages, on both sizes of a depot's laptop.
fn from_symptom_to_signed_sheet(language: Language, size: [f32; 2], density: Density) {
    signed_sheet(window(language, size, density, "eb_relay.slow"));
}

/// Leads the window from the symptom to the signed sheet.
fn signed_sheet(mut counted: Counted) {
    let settings = &counted.window.app().settings;
    let (language, density) = (settings.language, settings.density);
    let size = counted.window.harness().ctx.content_rect().right();
    let words: &Words = language.words();
    let case = &words.case;
    let relay = language.choose(["EB relay", "비상제동 계전기"]);
    counted.look("start");
    counted.click(words.frame.connect);
    counted.window.wait_for("SIM-0001");
    counted.window.wait_for(case.unknown);
    counted.look("symptom");
    counted.click(&words.content(SYMPTOM));
    counted.click(case.find_part);
    counted.window.wait_for(case.record_repair);
    counted.window.wait_for_part("eb_relay");
    let path = counted.window.shows_part("atp/power_up: ");
    assert_eq!(
        path,
        density == Density::Engineer,
        "an operator reads no paths"
    );
    counted.look("why");
    // Where the part is on the way of the signal, and what a good unit did.
    counted.press(case.way);
    counted.window.until("the marked part", |window| {
        let shown = window.shown().into_iter();
        shown
            .filter(|said| said.starts_with(relay))
            .any(|said| said.ends_with(case.suspected))
    });
    counted.look("way");
    counted.press(case.beside);
    counted.window.wait_for(case.beside_twin);
    counted.look("result");
    let found = latest(&counted.window);
    assert_eq!(found["run"]["symptom"], "brakes_late");
    let part = language.choose(["the EB relay", relay]);
    assert!(
        counted
            .window
            .shows(&fill(case.probably, &[("part", &part)]))
    );
    let id = text(&found["run"]["id"]);
    assert!(
        counted.window.shows_part(&id[id.len() - 8..]),
        "the run is named"
    );
    counted.click(case.record_repair);
    counted.window.wait_for(case.serial_new);
    counted.look("repair");
    counted.write(case.serial_old, "R-0815");
    counted.write(case.serial_new, "R-4711");
    counted.click(case.save);
    counted.window.wait_for(case.fitted);
    let repaired = fill(case.recorded, &[("part", &relay)]);
    counted.window.wait_for(&repaired);
    counted.look("proof");
    counted.click(case.fitted);
    counted.click(case.prove);
    counted.window.wait_for(case.sign);
    counted.window.wait_for(words.report.write_pdf);
    counted.look("sheet");
    let proof = latest(&counted.window)["run"]["id"].clone();
    let proof = text(&proof);
    if size >= 1280.0 {
        assert!(
            counted.window.shows(&proof[proof.len() - 8..]),
            "the sheet's run is named"
        );
    }
    // What was said when the unit was brought, beside the check that found the part; a small screen shows less at once.
    if language == Language::English && size >= 1280.0 {
        for said in [DEPOT, "Brakes late or not at all", "Found by"] {
            counted.window.scroll_to(said);
        }
    }
    counted.click(case.sign);
    counted.window.wait_for(case.sign_hint);
    counted.look("signature");
    counted.click(&fill(case.sign_as, &[("who", &"Kim")]));
    let signed = fill(case.signed_by, &[("who", &"Kim")]);
    counted.window.wait_for(&signed);
    // The dialog is out of the way in the picture after.
    counted.window.step();
    let file = counted.window.place.text_path("sheet.pdf");
    counted.press(words.report.file);
    counted.write(words.report.file, &file);
    counted.window.key(Key::Escape);
    counted.click(words.report.write_pdf);
    counted.window.wait_for(words.report.open_file);
    assert!(counted.window.place.path("sheet.pdf").is_file());
    // Where the sheet is written is known without a click; this test has a place of its own.
    assert!(counted.clicks <= CLICKS, "{} clicks", counted.clicks);
    let wrong = &counted.wrong;
    assert!(wrong.is_empty(), "{size} {language:?} {wrong:#?}");

    let window = counted.window;
    let proof = latest(&window);
    assert_eq!(proof["run"]["verdict"], "passed");
    assert_eq!(list(&proof["notes"])[0]["who"], "Kim", "{}", proof["notes"]);
    let faults = window.place.json("faults list --json");
    assert!(!list(&faults).is_empty());
    for fault in list(&faults) {
        assert_eq!(fault["state"], "verified", "{fault}");
        let shown = window
            .place
            .json(&["faults", "show", text(&fault["id"]), "--json"]);
        let mut events = list(&shown["events"]).iter();
        let repair = events.find(|event| event["kind"] == "repair");
        let repair = &repair.expect("a repair")["repair"];
        assert_eq!(repair["part"], "eb_relay");
        assert_eq!(repair["serial_old"], "R-0815");
        assert_eq!(repair["serial_new"], "R-4711");
    }
}

/// Goal: who starts the program for the first time is led to a part by a demonstration; who has a history, to its units.
#[test]
fn a_first_start_offers_a_demonstration_that_finds_a_part() {
    for language in [Language::English, Language::Korean] {
        let words = language.words();
        let mut counted = window(language, [1280.0, 800.0], Density::Operator, "");
        counted.window.wait_for(words.case.first_start);
        counted.look("first start");
        counted.click(words.case.demonstrate);
        counted.window.wait_for("SIM-0001");
        counted.window.wait_for(words.case.unknown);
        counted.click(&words.content(SYMPTOM));
        counted.click(words.case.find_part);
        counted.window.wait_for(words.case.record_repair);
        counted.window.wait_for_part("eb_relay");
        let wrong = &counted.wrong;
        assert!(wrong.is_empty(), "{language:?} {wrong:#?}");
        let found = latest(&counted.window);
        assert_eq!(found["run"]["symptom"], "brakes_late");
    }
}

#[test]
fn a_case_takes_ten_clicks_in_english() {
    from_symptom_to_signed_sheet(Language::English, [1280.0, 800.0], Density::Operator);
}

#[test]
fn a_case_takes_an_engineer_ten_clicks_too() {
    from_symptom_to_signed_sheet(Language::English, [900.0, 600.0], Density::Engineer);
}

#[test]
fn a_case_takes_ten_clicks_in_korean() {
    from_symptom_to_signed_sheet(Language::Korean, [1280.0, 800.0], Density::Operator);
}

#[test]
fn a_case_takes_ten_clicks_in_korean_on_a_small_screen() {
    from_symptom_to_signed_sheet(Language::Korean, [900.0, 600.0], Density::Operator);
}

/// Goal: who has no pointer comes as far, and sees where the keyboard is. Method: the same way with Tab, Space and what is typed.
#[test]
fn a_case_needs_no_pointer() {
    for (language, size, density) in [
        (Language::English, [1280.0, 800.0], Density::Engineer),
        (Language::Korean, [900.0, 600.0], Density::Operator),
    ] {
        let mut counted = window(language, size, density, "eb_relay.slow");
        counted.by_key = true;
        signed_sheet(counted);
    }
}

/// Goal: a repair that did not help is found out. Method: the part that was found is changed, and a second fault is still
/// there; the run that is to prove the repair fails, and the case is back at a result.
#[test]
fn a_repair_that_did_not_help_leads_back_to_the_result() {
    let case = &Language::English.words().case;
    let mut counted = repairing("eb_relay.slow,fsb_output.dead");
    // As a scanner types: each number ends with Enter, and the next one goes into the next field.
    counted.window.write(case.serial_old, "R-0815");
    for typed in ["R-4711", "cleaned its contacts"] {
        counted.window.key(Key::Enter);
        counted.window.step();
        let typed = Event::Text(typed.into());
        counted.window.harness().event(typed);
        counted.window.step();
    }
    counted.click(case.save);
    // Undone, the form is there again as it was written, and nothing is repaired.
    counted
        .window
        .wait_for(Language::English.words().frame.undo);
    let harness = counted.window.harness();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    counted.window.wait_for(case.save);
    let repaired = ["faults", "list", "--state", "repaired", "--json"];
    assert_eq!(list(&counted.window.place.json(&repaired)).len(), 0);
    counted.click(case.save);
    counted.window.wait_for(case.fitted);
    let shown = ["faults", "show", "latest", "--json"];
    let shown = counted.window.place.json(&shown);
    let mut events = list(&shown["events"]).iter();
    let repair = events.find(|event| event["kind"] == "repair");
    let repair = &repair.expect("a repair")["repair"];
    assert_eq!(repair["serial_old"], "R-0815");
    assert_eq!(repair["serial_new"], "R-4711");
    assert_eq!(repair["note"], "cleaned its contacts");
    counted.click(case.fitted);
    counted.click(case.prove);
    counted.window.wait_for(case.record_repair);
    assert_eq!(latest(&counted.window)["run"]["verdict"], "failed");
    let faults = counted.window.place.json("faults list --json");
    assert!(
        list(&faults)
            .iter()
            .all(|fault| fault["state"] != "verified")
    );
    // The next repair is to be fitted before it can be proved.
    counted.click(case.record_repair);
    counted.window.wait_for(case.serial_new);
    counted.window.write(case.note, "fitted another");
    counted.click(case.save);
    counted.window.wait_for(case.prove);
    assert!(!counted.window.enabled(case.prove));
}

/// Goal: a case is settled by its own runs alone. Method: a run of another page fails while the case waits for its proof.
#[test]
fn a_run_of_another_page_is_none_of_the_case() {
    let words = Language::English.words();
    let case = &words.case;
    let mut counted = repairing("eb_relay.slow");
    counted.window.write(case.note, "cleaned its contacts");
    counted.click(case.save);
    counted.window.wait_for(case.fitted);
    counted.window.page(Page::Procedures);
    let found = latest(&counted.window)["run"]["id"].clone();
    counted.window.wait_for(words.procedures.run);
    counted.window.click(words.procedures.run);
    counted.window.until("another run is over", |window| {
        let run = &latest(window)["run"];
        run["id"] != found && run["verdict"] == "failed"
    });
    counted.window.wait_for_part("the EB relay");
    counted.window.page(Page::Case);
    counted.window.step();
    counted.window.wait_for(case.fitted);
    assert!(!counted.window.shows(case.record_repair));
}

/// Goal: a unit that was here before needs no typing. Method: one click on it, and its case has its history.
#[test]
fn a_unit_seen_before_is_chosen_by_one_click() {
    for language in Language::ALL {
        let case = &language.words().case;
        let mut window = on_bad_unit(language);
        window.harness().set_size([900.0, 600.0].into());
        window.wait_for(case.seen_last);
        window.click_part("BAD-1 · ");
        assert!(complaints(&mut window).is_empty());
        window.click_last(language.words().frame.connect);
        window.wait_for("BAD-1");
        window.wait_for(case.open_faults);
    }
}

/// Goal: a unit that comes for the first time waits for nothing. Method: the history knows another unit; this one is connected.
#[test]
fn a_unit_never_seen_has_no_history_and_says_so() {
    let words = Language::Korean.words();
    let mut window = on_bad_unit(Language::Korean);
    window.click_last(words.frame.connect);
    window.wait_for("SIM-0001");
    window.wait_for(words.case.nothing_known);
}

/// Goal: a key signs with its PIN alone, and a wrong one costs no more than typing it again. Method: a key of this place; a wrong PIN,
/// after which nothing is stored and the dialog stands as it was chosen; the right one.
#[test]
fn a_wrong_pin_signs_nothing_and_keeps_what_was_chosen() {
    let case = &Language::English.words().case;
    let size = [1280.0, 800.0];
    let mut counted = window(Language::English, size, Density::Operator, "eb_relay.slow");
    let window = &mut counted.window;
    let keys = window.place.path("ptu/keys");
    std::fs::create_dir_all(&keys).expect("a folder");
    window.place.write("pin.txt", "246810\n");
    let new = "key new --who Kim-Signer --out ptu/keys/mine.key --pin-file pin.txt";
    window.place.ptu(new).exits(0);
    counted.open_sign();
    let window = &mut counted.window;
    window.click_last(case.key);
    window.click("mine");
    let sign = fill(case.sign_as, &[("who", &"Kim-Signer")]);
    window.write(case.pin, "135791");
    window.click_for_part(&sign, case.not_signed);
    assert!(!window.shown().iter().any(|said| said.contains("135791")));
    assert!(list(&latest(window)["notes"]).is_empty());
    window.wait_for(case.pin_first);
    window.write(case.pin, "246810");
    window.click_for(
        &sign,
        &fill(case.signed_with_key, &[("who", &"Kim-Signer")]),
    );
    assert!(!window.shows(case.sign_hint));
    let notes = latest(window)["notes"].clone();
    assert_eq!(list(&notes)[0]["who"], "Kim-Signer", "{notes}");
}
