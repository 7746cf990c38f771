//! The fault history and the diagnosis in the window: from a fault to what is done about it, and from
//! a run that cannot be told to the check that would tell.

use std::collections::BTreeSet;

use crate::common::window::{Window, settings_in};
use crate::common::{Place, list, scripts, text};
use eframe::egui::Key;
use ptu_options::Page;
use ptu_report::words::Language;
use ptu_runs::bench_worker::Phase;
use ptu_window::Settings;
use serde_json::Value;

/// A place whose database has one run with this fault.
fn with_a_run(fault: &str, procedures: &[&str]) -> Place {
    let place = Place::new();
    let arguments = [&["run", "--inject", fault][..], procedures].concat();
    let said = place.ptu(&arguments);
    assert_eq!(said.code, Some(1), "{}", said.err);
    place
}

fn on(place: Place, page: Page, language: Language) -> Window {
    let settings = Settings {
        page,
        language,
        operator: "Kim".into(),
        ..Settings::default()
    };
    Window::with(place, scripts(), settings)
}

#[test]
fn a_fault_is_found_acknowledged_repaired_and_its_trace_and_run_are_a_click_away() {
    let place = with_a_run("eb_relay.slow", &["atp/overspeed"]);
    let mut window = on(place, Page::Faults, Language::English);
    window.write("text", "eb_relay");
    window.wait_for_part("1 of ");
    let of_relay = ["faults", "list", "--part", "eb_relay", "--json"];
    let fault: Value = window.place.json(&of_relay)[0].clone();
    window.click_part("EB relay · ");
    window.wait_for("what was done");
    window.wait_for("eb_loop");
    window.write("note", "relay ordered");
    window.click_for("Acknowledge", "acknowledged");
    window.wait_for("relay ordered");
    window.click("Repaired …");
    assert!(
        !window.enabled("Record repair"),
        "nothing says what was done"
    );
    window.write("serial number put in", "SN-77");
    window.click_for("Record repair", "repaired");
    window.wait_for_part("SN-77");
    window.wait_for("Recorded: repaired");
    let id = text(&fault["id"]).to_owned();
    let stored = window.place.json(&["faults", "show", &id, "--json"]);
    assert_eq!(stored["state"], "repaired");
    let events = list(&stored["events"]);
    let who = |event: &&Value| event["who"] == "Kim";
    assert_eq!(events.iter().filter(who).count(), 2);
    // A repair is proven by a run, not by a person's word: closing is not offered.
    assert!(!window.shows(Language::English.words().faults.close));

    for (button, page) in [
        ("Trace", Page::Traces),
        ("Run", Page::Report),
        ("Diagnosis", Page::Diagnosis),
    ] {
        window.page(Page::Faults);
        // The page of the same name stands before it among what can be clicked.
        window.click_last(button);
        window.wait_for_page(page);
    }
}

/// Goal: no click alone closes a fault, and what was closed by mistake is open again. Method: faults of one cause; the dialog has
/// all that close, and closes nothing without a reason and what was looked at.
#[test]
fn faults_are_closed_by_a_reason_and_opened_again() {
    let place = with_a_run("eb_relay.slow", &["atp/overspeed", "atp/power_up"]);
    place.ptu("diagnose latest").exits(0);
    let of_relay = ["faults", "list", "--cause", "eb_relay", "--json"];
    let listed = |place: &Place| place.json(&of_relay).as_array().expect("faults").clone();
    let states = |place: &Place| -> BTreeSet<String> {
        let states = listed(place).into_iter();
        states.map(|fault| fault["state"].to_string()).collect()
    };
    let n = listed(&place).len();
    assert!(n > 1, "faults of one cause");
    let mut window = on(place, Page::Faults, Language::English);
    let said = &Language::English.words().faults;
    window.click_part("EB relay · ");
    window.click_for(
        said.close,
        &said.close_unrepaired.replace("{n}", &n.to_string()),
    );
    let close = said.close_n.replace("{n}", &n.to_string());
    assert!(!window.enabled(&close));
    window.click(said.close_not_found);
    window.step();
    assert!(!window.enabled(&close), "nothing was looked at");
    assert_eq!(states(&window.place), BTreeSet::from(["\"open\"".into()]));
    window.write(said.close_looked, "contacts clean");
    window.click(&close);
    // The page is read again once all of them are written.
    window.wait_for_part("no fault found in the part: contacts clean");
    assert_eq!(states(&window.place), BTreeSet::from(["\"closed\"".into()]));
    window.click_for(said.reopen, said.close);
    assert_eq!(states(&window.place), BTreeSet::from(["\"open\"".into()]));
}

/// Goal: what was written by mistake is undone at once. Method: a fault is acknowledged and undone, noted on and left so
/// until the offer ends.
#[test]
fn what_was_written_about_a_fault_can_be_undone_for_ten_seconds() {
    for language in Language::ALL {
        let place = with_a_run("eb_relay.slow", &["atp/overspeed"]);
        let mut window = on(place, Page::Faults, language);
        let words = language.words();
        let relay = language.choose(["EB relay · ", "비상제동 계전기 · "]);
        window.wait_for_part(relay);
        let of_relay = ["faults", "list", "--part", "eb_relay", "--json"];
        let id = window.place.json(&of_relay)[0]["id"].clone();
        let show = ["faults", "show", text(&id), "--json"];
        let before = window.place.json(&show);
        window.click_part(relay);
        window.write(words.common.note, "wrong unit");
        window.click_for(
            words.faults.acknowledge,
            words.fault_state(fault_db::FaultState::Acknowledged),
        );
        // The second click of two finds nothing to undo.
        window.double_click(words.frame.undo);
        let undone = words.frame.undone.replace("{what} ", "");
        window.wait_for_part(&undone);
        // Nor does it take away what has come to its place.
        window.click_in_haste(words.frame.seen);
        window.wait_for_part(&undone);
        window.wait_for_part(words.frame.undo_reason);
        assert!(!window.shows(words.frame.undo));
        let mut after = window.place.json(&show);
        let withdrawn = after["withdrawn"].take();
        let listed = list(&withdrawn);
        assert_eq!(listed.len(), 1);
        assert_eq!(listed[0]["kind"], "acknowledged");
        assert_eq!(listed[0]["withdrawn"]["who"], "Kim");
        after["withdrawn"] = before["withdrawn"].clone();
        assert_eq!(after, before);

        window.write(words.common.note, "seen");
        window.click_for(words.faults.add_note, words.frame.undo);
        window.pass(11.0);
        window.step();
        assert!(!window.shows(words.frame.undo), "it is over");
    }
}

/// Goal: who reads Korean reads no identifier of a measurement and the part's name. Method: a run that fails by its relay,
/// led by the window; then every page that tells of it.
#[test]
fn korean_pages_name_measurements_parts_and_severities_in_korean() {
    let mut settings = settings_in(Language::Korean, Page::Procedures);
    settings.unit.faults = vec!["eb_relay.slow".into()];
    let mut window = Window::with(Place::new(), scripts(), settings);
    let words = Language::Korean.words();
    window.click_in(words.procedures.choice, words.procedures.none);
    window.click("과속에 따른 ATP 제동 체결");
    window.connect_simulated();
    window.click_for_part(words.procedures.run, "비상제동 계전기 (eb_relay, ");
    window.wait_for_part("EB 반응 시간");
    let report = window.place.json("runs show latest --json");
    let steps = list(&report["steps"]).iter();
    let measured = steps.flat_map(|step| list(&step["measurements"]));
    let mut names: Vec<_> = measured.filter_map(|of| of["name"].as_str()).collect();
    names.dedup();
    assert!(names.contains(&"eb_reaction"), "{names:?}");
    for (page, shows) in [
        (Page::Procedures, "EB 반응 시간"),
        (Page::Faults, "EB 반응 시간"),
        (Page::Diagnosis, "비상제동 계전기 (eb_relay, "),
    ] {
        window.page(page);
        window.wait_for_part(shows);
        if page == Page::Faults {
            window.click_part("비상제동 계전기 · ");
            window.wait_for(words.report.major);
            window.wait_for("9000 점검 불합격");
        }
        for text in window.shown() {
            let is_in =
                |name: &&&str| text.contains(**name) || text.contains(&name.replace('_', " "));
            let english = names.iter().find(is_in);
            assert!(english.is_none(), "{page:?}: {english:?} in {text}");
        }
    }
}

/// Goal: what is written about one fault is never stored on another. Method: a note and a serial number
/// typed for the one, then the other is chosen, acknowledged and repaired.
#[test]
fn what_was_typed_for_one_fault_is_not_stored_on_another() {
    let place = with_a_run("eb_relay.slow", &["atp/overspeed"]);
    let faults = place.json("faults list --json");
    let part = |fault: &Value| text(&fault["part"]).to_owned();
    let faults = list(&faults);
    let other = faults
        .iter()
        .find(|fault| part(fault) != "eb_relay")
        .expect("the run tells of more than the relay");
    assert_eq!(part(other), "atp_cpu");
    let id = text(&other["id"]).to_owned();
    let mut window = on(place, Page::Faults, Language::English);
    window.wait_for_part("2 of 2");
    // The relay is the cause of the other fault.
    assert!(
        window.shows_part("(cause: EB relay)"),
        "{:#?}",
        window.shown()
    );
    window.click_part("EB relay · ");
    window.wait_for("what was done");
    assert!(!window.enabled("Add note"), "there is nothing to add");
    window.write("note", "relay ordered");
    assert!(window.enabled("Add note"));
    window.click("Repaired …");
    window.write("serial number put in", "SN-77");
    window.click("cancel");
    window.click_part("ATP CPU · ");
    window.until("an empty form", |window| !window.enabled("Add note"));
    window.click_for("Acknowledge", "acknowledged");
    window.click("Repaired …");
    window.write("Note", "cleaned");
    window.click_for("Record repair", "repaired");
    let stored = window.place.json(&["faults", "show", &id, "--json"]);
    assert_eq!(stored["state"], "repaired");
    let stored = stored.to_string();
    assert!(!stored.contains("relay ordered"), "{stored}");
    assert!(!stored.contains("SN-77"), "{stored}");
}

#[test]
fn filters_leave_what_they_say_in_korean_too() {
    let place = with_a_run("tra.dead", &["ato/markers"]);
    let of = place.json("faults list --json");
    let of = of.as_array().map_or(0, Vec::len);
    let mut window = on(place, Page::Faults, Language::Korean);
    window.wait_for(&format!("고장 {of}건 중 {of}건"));
    window.write("검색어", "no such fault");
    window.wait_for(&format!("고장 {of}건 중 0건"));
}

/// Goal: one question has one answer. Method: a run that finds its part, one that leaves several, one that is too thin to
/// tell, and one that was stopped; each is asked about on the command line and in the window, in both languages.
#[test]
fn the_window_says_what_the_command_line_says() {
    let runs: [(&[&str], i32, &str); 4] = [
        (
            &["--inject", "eb_relay.slow", "atp/overspeed"],
            1,
            "the EB relay (eb_relay, ",
        ),
        (
            &["--inject", "atp_receiver.dead", "atp/limit_speed"],
            1,
            "next, run",
        ),
        (
            &["--inject", "fsk_board.receiver_dead", "twc/exchange"],
            1,
            "",
        ),
        (&["ato/markers"], 0, "not enough was run"),
    ];
    for (run, code, begins) in runs {
        let place = Place::new();
        place.ptu(&[&["run"], run].concat()).exits(code);
        let answer = place.json("diagnose latest --json");
        let said = |key: &str| text(&answer[key]).to_owned();
        assert!(
            said("conclusion").contains(begins),
            "{}",
            said("conclusion")
        );
        let said_by_text = place.ptu("diagnose latest").exits(0);
        assert!(said_by_text.out.contains(&said("conclusion")));
        let mut window = on(place, Page::Diagnosis, Language::English);
        window.wait_for(&said("conclusion"));
        window.speak_korean();
        window.wait_for(&said("conclusion_ko"));
        let sheet = window.place.text_path("sheet.html");
        let show = ["runs", "show", "latest", "--report", &sheet, "--lang", "ko"];
        window.place.ptu(&show).exits(0);
        assert!(
            window
                .place
                .read("sheet.html")
                .contains(&said("conclusion_ko"))
        );
    }
}

/// Goal: what is read first fits on a page. Method: a run that leaves more than three faults; the fourth is behind "more".
#[test]
fn three_parts_are_shown_and_the_other_candidates_on_demand() {
    let place = with_a_run("atp_receiver.dead", &["atp/limit_speed"]);
    let answer = place.json("diagnose latest --json");
    let candidates = list(&answer["candidates"]).to_vec();
    assert!(candidates.len() > 3, "{answer:#}");
    let mut window = on(place, Page::Diagnosis, Language::English);
    window.wait_for(text(&answer["conclusion"]));
    let shown = |window: &Window| {
        let all = window.shown();
        let is_shown = |candidate: &&Value| {
            let name = text(&candidate["fault"]);
            all.iter().any(|text| text == name)
        };
        candidates.iter().filter(is_shown).count()
    };
    // Each part shows its likeliest fault.
    let parts: BTreeSet<_> = candidates
        .iter()
        .map(|one| one["part"].to_string())
        .collect();
    let at_once = parts.len().min(3);
    assert_eq!(shown(&window), at_once);
    window.click(&format!("more ({})", candidates.len() - at_once));
    window.until("all of them", |window| shown(window) == candidates.len());
}

#[test]
fn what_cannot_be_told_names_the_check_that_would_and_runs_it() {
    // A run of one procedure that fails leaves more than one part to blame.
    let place = with_a_run("atp_receiver.dead", &["atp/limit_speed"]);
    let answer = place.json("diagnose latest --json");
    let next = text(&answer["next_check"]["step"]).to_owned();
    let mut window = on(place, Page::Diagnosis, Language::English);
    window.wait_for(&next);
    window.key(Key::F9);
    window.wait_for_phase(Phase::Idle);
    window.click("Run it");
    window.wait_for_page(Page::Procedures);
    window.wait_for_part("Run over: ");
    let run = window.place.json("runs show latest --json");
    let step = &run["steps"][0];
    let ran = format!(
        "{}: {}",
        step["procedure"].as_str().unwrap_or_default(),
        step["name"].as_str().unwrap_or_default()
    );
    assert_eq!(ran, next);
    assert_eq!(run["steps"].as_array().map(Vec::len), Some(1));
}

/// Goal: what a person did not mean is never written. Method: each button that a state offers is clicked twice within
/// 180 ms, where the first click brings the next state's button under the pointer.
#[test]
fn a_double_click_changes_a_fault_once() {
    let place = with_a_run("eb_relay.slow", &["atp/overspeed"]);
    let faults = place.json("faults list --part eb_relay --json");
    let id = text(&faults[0]["id"]).to_owned();
    let mut window = on(place, Page::Faults, Language::English);
    window.write("text", "eb_relay");
    window.wait_for_part("1 of ");
    window.click_part("EB relay · ");
    let states = |window: &Window| {
        let stored = window.place.json(&["faults", "show", &id, "--json"]);
        let events = list(&stored["events"]).to_vec();
        let states = events.iter().filter(|event| event["who"] == "Kim");
        let states: Vec<_> = states.map(|event| event["state"].clone()).collect();
        states
    };
    window.wait_for("Acknowledge");
    window.double_click("Acknowledge");
    window.until("an acknowledgement", |window| !states(window).is_empty());
    window.wait_for("acknowledged");
    assert_eq!(states(&window), ["acknowledged"]);
    // Neither serial number nor word: nobody could tell later what was repaired.
    window.double_click("Repaired …");
    window.wait_for("serial number put in");
    assert!(!window.enabled("Record repair"));
    window.write("serial number put in", "SN-77");
    window.double_click("Record repair");
    window.wait_for("repaired");
    window.wait_for("Verified");
    assert_eq!(states(&window), ["acknowledged", "repaired"]);
    // Runs verify; a person says why.
    assert!(!window.enabled("Verified"));
    window.write("note", "seen on the train");
    window.click_for("Verified", "verified");
    assert_eq!(states(&window), ["acknowledged", "repaired", "verified"]);
}
