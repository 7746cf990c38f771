//! The statistics in the window: the figures of the command line, and bars that lead to their faults.

use crate::common::window::{Window, settings, settings_in};
use crate::common::{Place, list, scripts, text};
use eframe::egui::Key;
use ptu_options::Page;
use ptu_report::limits::short;
use ptu_report::words::{Language, Words, fill};
use ptu_window::Settings;
use serde_json::Value;

/// Two units with a slow relay, one of which was repaired, and one with a dead antenna.
fn depot() -> Place {
    let place = Place::new();
    for (unit, procedure, mode) in [
        ("A-1", "atp/overspeed", "eb_relay.slow"),
        ("A-2", "atp/overspeed", "eb_relay.slow"),
        ("A-1", "twc/exchange", "twc_antenna.dead"),
    ] {
        let run = ["run", procedure, "--serial-no", unit, "--inject", mode];
        place.ptu(&run).exits(1);
    }
    let of_relay = "faults list --cause eb_relay --serial-no A-1 --json";
    let fault = text(&list(&place.json(of_relay))[0]["id"]).to_owned();
    let repair = format!("faults repair {fault} --part eb_relay --new SN-1 --who Kim");
    place.ptu(&repair).exits(0);
    place
}

fn window(place: Place, language: Language) -> Window {
    let settings = settings_in(language, Page::Statistics);
    Window::with(place, scripts(), settings)
}

/// What the bar of a cause says.
fn bar(words: &Words, name: &str, (count, share, sum): (u64, u64, u64)) -> String {
    let more = fill(words.statistics.of_all, &[("share", &share), ("sum", &sum)]);
    format!("{name}: {count} · {more}")
}

#[test]
fn the_figures_are_those_of_the_command_line_and_bars_lead_to_their_faults() {
    for language in Language::ALL {
        let place = depot();
        let stats = place.json("faults stats --json");
        // Each cause has its cases, their share, and the share of all causes so far, in the order
        // of the list.
        let cases = |row: &Value| row["faults"].as_u64().expect("a number");
        let all: u64 = list(&stats).iter().map(cases).sum();
        let percent = |part: u64| (100.0 * part as f64 / all as f64).round_ties_even() as u64;
        let told = |part: &str| {
            let place = list(&stats).iter().position(|row| row["key"] == part);
            let rows = &list(&stats)[..=place.expect("counted")];
            let here = rows.last().map_or(0, cases);
            (here, percent(here), percent(rows.iter().map(cases).sum()))
        };
        assert_eq!(told("eb_relay").0, 2, "{stats}");
        let (relay, antenna) = language.choose([
            ("EB relay", "TWC antenna"),
            ("비상제동 계전기", "TWC 안테나"),
        ]);
        let words = language.words();
        let mut window = window(place, language);
        let of_relay = format!("{relay}: 2 · ");
        window.wait_for_part(&of_relay);
        for (part, name) in [("eb_relay", relay), ("twc_antenna", antenna)] {
            let bar = bar(words, name, told(part));
            assert!(window.shows(&bar), "{bar}: {:#?}", window.shown());
        }
        window.wait_for(words.statistics.mtbf_is);
        window.click_part(&of_relay);
        window.wait_for_page(Page::Faults);
        let chip = format!("{} {relay}  ×", words.faults.cause);
        window.wait_for(&chip);
        assert!(window.shows_part(&format!("{relay} · ")));
        assert!(!window.shows_part(&format!("{antenna} · ")));
        window.click_for_part(&chip, &format!("{antenna} · "));

        window.page(Page::Statistics);
        let month = window.place.json("faults stats --by month --json");
        let month = list(&month).last().expect("this month").clone();
        let of_month = format!("{}: {}", text(&month["key"]), month["faults"]);
        window.click(&of_month);
        let name = text(&month["key"]);
        let chip = format!(
            "{}  ×",
            fill(words.faults.first_seen_in, &[("month", &name)])
        );
        window.wait_for(&chip);
        assert!(window.shows_part(&format!("{antenna} · ")));
    }
}

/// Goal: the control limits on the page are those of `ptu faults trend`. Method: the measurement that comes first, of all units.
#[test]
fn control_limits_are_those_of_the_command_line() {
    for language in Language::ALL {
        let said = &language.words().statistics;
        let place = Place::with_bad_unit();
        let good = ["run", "atp/overspeed", "--serial-no", "A-2"];
        place.ptu(&good).exits(0);
        let first = "SELECT min(name) AS name FROM measurements WHERE value IS NOT NULL";
        let first = place.json(&["db", "query", first, "--json"]);
        let name = text(&list(&first["rows"])[0][0]).to_owned();
        let trend = place.json(&["faults", "trend", &name, "--json"]);
        let number = |value: &Value| short(value.as_f64().expect("a number"));
        let process = &trend["process"];
        let unit = text(&trend["unit"]);
        let mean = [
            ("n", &process["n"] as &dyn std::fmt::Display),
            ("mean", &number(&process["mean"])),
            ("unit", &unit),
        ];
        let [low, high] = [0, 1].map(|end| number(&process["control"][end]));
        let control = [
            ("low", &low as &dyn std::fmt::Display),
            ("high", &high),
            ("unit", &unit),
        ];
        let mut window = window(place, language);
        // The history answers some frames after the page is there.
        window.wait_for_part(&fill(said.mean, &mean));
        window.wait_for_part(&fill(said.control_limits, &control));
        let days = list(&trend["days"]).len();
        assert!(window.shows(&fill(said.chart_of, &[("n", &days)])));
    }
}

/// Goal: from a serial number a technician gets to everything stored about it, and back to the fault. Method: the life of the
/// repaired unit, searched; from its repair to the fault, from the serial number there to the life of the part.
#[test]
fn a_serial_number_leads_to_its_life_and_an_entry_to_its_fault() {
    for language in Language::ALL {
        let words = language.words();
        let mut window = window(depot(), language);
        window.wait_for(words.statistics.mtbf_is);
        window.write(words.life.search, "A-1");
        window.click_for_part(
            words.life.show,
            &fill(words.life.unit, &[("serial", &"A-1")]),
        );
        window.wait_for(words.life.stored);
        let lives = window.place.json("faults life A-1 --json");
        let events = list(&lives[0]["events"]).len();
        let told = fill(
            words.life.span,
            &[("n", &events), ("first", &""), ("last", &"")],
        );
        let told = told.split(',').next().unwrap_or_default().to_owned();
        assert!(window.shows_part(&told), "{told}: {:#?}", window.shown());
        window.click_part(&format!("{}: ", words.event_kind("repair")));
        window.wait_for_page(Page::Faults);
        window.click_for_part("SN-1", &fill(words.life.part, &[("serial", &"SN-1")]));
        window.wait_for(words.life.units_of_part);
        window.click_for(words.life.back, words.statistics.mtbf_is);
        window.write_over(words.life.search, "no-such");
        window.click_for(
            words.life.show,
            &fill(words.life.nothing, &[("serial", &"no-such")]),
        );
    }
}

/// Goal: a depot asks its question again without setting it up. Method: the faults of one part are saved under a name, looked
/// at without the filter, and chosen again; another window has the question, too.
#[test]
fn a_question_is_saved_by_name_and_asked_again() {
    let words = Language::English.words();
    let said = &words.statistics;
    let mut window = Window::with(depot(), scripts(), settings(Page::Faults));
    window.wait_for_part("TWC antenna · ");
    window.write(words.faults.find, "eb_relay");
    window.until("only the relay", |window| {
        !window.shows_part("TWC antenna · ")
    });
    window.click_for(said.questions, said.save_question);
    assert!(!window.enabled(said.save_question));
    window.write(said.question_name, "relays");
    window.click_for(said.save_question, said.forget_question);
    window.key(Key::Escape);
    window.write_over(words.faults.find, "antenna");
    window.wait_for_part("TWC antenna · ");
    window.click(said.questions);
    window.click("relays");
    window.until("only the relay", |window| {
        !window.shows_part("TWC antenna · ")
    });
    let text = serde_json::to_string(&window.app().settings).expect("text");
    let kept: Settings = serde_json::from_str(&text).expect("settings");
    assert_eq!(kept.faults.len(), 1);
    window.click(said.questions);
    window.click_for(said.forget_question, said.question_name);
    assert!(window.app().settings.faults.is_empty());
}

#[test]
fn an_empty_history_says_so() {
    let mut window = window(Place::new(), Language::English);
    window.wait_for(Language::English.words().statistics.nothing);
}

/// Goal: a depot that keeps odometer readings sees faults for each 10 000 km, and what is wrong with its file. Method: a train
/// with a fault and readings of it, named on the page; then the same file with a slip in it.
#[test]
fn faults_for_each_10_000_km_are_those_of_the_command_line() {
    for language in Language::ALL {
        let said = &language.words().statistics;
        let place = Place::new();
        let run = "run atp/overspeed --serial-no A-1 --train-no 612 --inject eb_relay.slow";
        place.ptu(run).exits(1);
        let readings = "train,date,km\n612,2020-01-01,0\n612,2099-01-01,9000000\n";
        let file = place.write("odometers.csv", readings);
        let stats = format!("faults stats --by month --distances {file} --json");
        let mut window = window(place, language);
        window.click_for(said.each_10000_km, said.no_distances);
        window.name_file(said.odometers, &file);
        window.click_for(said.read_odometers, said.per_10000_km);
        let month = window.place.json(&stats);
        let month = list(&month).last().expect("this month").clone();
        let faults = month["distance_faults"].as_u64().expect("a number");
        assert_eq!(month["faults"], faults);
        // The distance grows while the page is looked at.
        let of_month = format!("{}: ", text(&month["key"]));
        let numbers = [
            ("n", &faults as &dyn std::fmt::Display),
            ("km", &"@"),
            ("trains", &1),
        ];
        let numbers = fill(said.rate_is, &numbers);
        let (faults, trains) = numbers.split_once("@").expect("two parts");
        let bar = window.shown().into_iter().find(|bar| {
            bar.starts_with(&of_month) && bar.contains(faults) && bar.ends_with(trains)
        });
        assert!(bar.is_some(), "{:#?}", window.shown());
        assert_eq!(window.app().settings.distances, file);

        window
            .place
            .write("odometers.csv", &readings.replace("9000000", "many"));
        window.click(said.read_odometers);
        let wrong = language.choose([
            "line 3, column 3 (km): \"many\" is no number of kilometres",
            "3행 3열(km): \"many\"은(는) 거리(km) 값이 아닙니다",
        ]);
        window.wait_for_part(wrong);
        // The rest of the page is as it was.
        assert!(window.shows(said.mtbf_is));
    }
}
