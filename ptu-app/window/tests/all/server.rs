//! The window and a server: what two laptops recorded, synced and looked through.

#[path = "../../../../fault-db/tests/server/private.rs"]
#[allow(dead_code, reason = "the tests of fault-db use the rest of it")]
mod owner_only;

use self::owner_only::shared;
use crate::common::scripts;
use crate::common::window::{Window, settings};
use crate::common::{Place, record_bad_unit, relay_fault, text};
use crate::layout::complaints;
use ptu_options::Page;
use ptu_report::words::{Language, fill};
use ptu_window::Settings;

/// Goal: a technician syncs from the window, sees when that was, and which fault two people disagree about. Method: two
/// laptops saw one unit; at the desk its fault is closed, on the other laptop it is repaired; then the window syncs.
#[test]
fn the_window_syncs_and_names_conflicts_and_the_last_sync() {
    for language in Language::ALL {
        let words = language.words();
        let server = shared().database();
        let (one, two) = (Place::new(), Place::new());
        record_bad_unit(&one);
        one.ptu(&["db", "sync", &server]).exits(0);
        // The other laptop has the same history, and decides differently.
        two.ptu(&["db", "import", &one.text_path("history.db")])
            .exits(0);
        let fault = text(&relay_fault(&one)["id"]).to_owned();
        two.ptu(&["faults", "state", &fault, "closed", "--who", "Lee"])
            .exits(0);
        two.ptu(&["db", "sync", &server]).exits(0);
        one.ptu(&["faults", "state", &fault, "acknowledged", "--who", "Kim"])
            .exits(0);

        let settings = Settings {
            language,
            server: server.clone(),
            ..settings(Page::Faults)
        };
        let mut window = Window::with(one, scripts(), settings);
        window.click(words.care.title);
        let last = words
            .care
            .last_synced
            .split("{at}")
            .next()
            .unwrap_or_default();
        window.wait_for_part(last);
        window.click(words.care.sync);
        let synced = words.care.synced.split("{runs}").next().unwrap_or_default();
        let failed = words.care.failed;
        window.until("a sync", |window| {
            window.shows_part(synced) || window.shows_part(failed)
        });
        assert!(window.shows_part(synced), "{:#?}", window.shown());
        let unit = fill(words.care.conflict, &[("unit", &"BAD-1")]);
        let conflict = unit.split("{id}").last().unwrap_or_default();
        let conflict = conflict.split("{fault}").next().unwrap_or_default();
        window.wait_for_part(conflict);
        for (who, state) in [
            ("Lee", words.fault_state(fault_db::FaultState::Closed)),
            ("Kim", words.fault_state(fault_db::FaultState::Acknowledged)),
        ] {
            let said = fill(words.care.says, &[("who", &who), ("state", &state)]);
            assert!(window.shows_part(&said), "{said}: {:#?}", window.shown());
        }
        // All is there: nothing waits, and the address is remembered as it was typed.
        let none = words
            .care
            .last_synced
            .split("{server}")
            .last()
            .unwrap_or_default();
        window.wait_for_part(&fill(none, &[("n", &0)]));
        let synced = window.place.json(&["db", "sync", &server, "--json"]);
        assert_eq!(synced["sent"]["events"], 0, "{synced}");
    }
}

/// Goal: at the desk a server's history is looked through in the window, and nobody writes into it by mistake. Method: a laptop
/// has synced a repaired fault; the window on the server shows it, its life and the statistics, and says why it records nothing.
#[test]
fn the_window_reads_a_server_and_says_why_it_writes_nothing() {
    let server = shared().database();
    let place = Place::with_bad_unit();
    let fault = text(&relay_fault(&place)["id"]).to_owned();
    let repair = format!("faults repair {fault} --part eb_relay --new SN-77 --who Kim");
    place.ptu(&repair).exits(0);
    place.ptu(&["db", "sync", &server]).exits(0);
    // A unit is not connected to a window that could not record what it does.
    let unit = ["gui", "--unit", "sim", "--db", &server];
    place.ptu(&unit).exits(2).explains(&["server", "--unit"]);
    for language in Language::ALL {
        let words = language.words();
        let settings = Settings {
            language,
            operator: "Kim".into(),
            ..settings(Page::Faults)
        };
        let here = Place::new();
        let mut window = Window::on_server(&server, here, settings);
        let relay = language.choose(["EB relay · ", "비상제동 계전기 · "]);
        window.click_part(relay);
        window.wait_for("SN-77");
        window.wait_for(words.care.is_server);
        assert!(!window.shows(words.faults.verify), "{:#?}", window.shown());
        window.click_for(words.memory.title, words.memory.import);
        assert!(!window.enabled(words.frame.connect) && !window.enabled(words.memory.import));
        window.key(eframe::egui::Key::Escape);
        assert_eq!(complaints(&mut window), Vec::<String>::new());
        window.page(Page::Case);
        window.wait_for(words.care.is_server);
        window.key(eframe::egui::Key::F9);
        window.step();
        window.wait_for(words.frame.not_connected);
        window.page(Page::Statistics);
        window.wait_for_part(relay.trim_end_matches(" · "));
        window.page(Page::Report);
        window.wait_for(words.report.write_pdf);
        assert!(!window.enabled(words.report.note_save));
        window.page(Page::Traces);
        window.wait_for(words.traces.events);
        window.page(Page::Faults);
        window.click_for("SN-77", words.life.units_of_part);
        window.click(words.care.title);
        window.click(words.care.check);
        let sound = words.care.sound.split('{').next().unwrap_or_default();
        window.wait_for_part(sound);
        assert!(!window.shows(words.care.sync));
    }
    let faults = place.json(&["faults", "list", "--json", "--db", &server]);
    let here = place.json("faults list --json");
    assert_eq!(faults, here, "nothing was written");
}
