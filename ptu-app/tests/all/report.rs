//! Test sheets and tables of runs, as the program writes them.

use std::collections::BTreeSet;

use crate::common::{Place, is_english, list, text};
use fault_db::Store;
use ptu_report::run::{Sheet, html};
use ptu_report::words::Language;

/// Goal: a sheet in Korean is Korean: steps, messages, sources, fault modes and reasons. Method: runs that fail in
/// different ways; no text of their sheets has three plain English words in a row.
#[test]
fn a_korean_sheet_of_a_failed_run_has_no_english_sentence() {
    let runs = [
        ("atp/limit_speed", "atp_receiver.dead", 1),
        ("atp/overspeed", "eb_relay.slow", 1),
        ("door/*", "io_board.door_enable_dead", 1),
        ("door/*", "door_contact.bridged", 3),
        ("twc/*", "twc_cpu.dead", 1),
        ("tcms/*", "inverter.dead", 1),
        ("ato/markers", "marker_antenna.weak", 1),
    ];
    let mut english = BTreeSet::new();
    for (procedures, fault, code) in runs {
        let place = Place::new();
        let sheet = place.text_path("sheet.html");
        let run = ["run", procedures, "--inject", fault, "--lang", "ko"];
        place
            .ptu(&[&run[..], &["--report", &sheet]].concat())
            .exits(code);
        let page = place.read("sheet.html");
        let body = page.split_once("</style>").map_or(&*page, |(_, body)| body);
        let texts = body.split('<').filter_map(|part| part.split_once('>'));
        let texts = texts.map(|(_, text)| text.trim());
        english.extend(texts.filter(|text| is_english(text)).map(str::to_owned));
    }
    assert!(english.is_empty(), "{english:#?}");
}

/// Goal: on a Korean sheet measurements and parts have the names people use. Method: a run that fails by its relay; no
/// identifier of a measurement is left in the sheet, the conclusion names the part in Korean with its identifier.
#[test]
fn a_korean_sheet_names_measurements_and_the_part_in_korean() {
    let place = Place::new();
    let sheet = place.text_path("sheet.html");
    let run = ["run", "atp/overspeed", "--inject", "eb_relay.slow"];
    let korean = ["--lang", "ko", "--report", &sheet];
    place.ptu(&[&run[..], &korean].concat()).exits(1);
    let page = place.read("sheet.html");
    let report = place.json(&["runs", "show", "latest", "--json"]);
    let measured = list(&report["steps"])
        .iter()
        .flat_map(|step| list(&step["measurements"]));
    let names: BTreeSet<_> = measured.map(|measured| text(&measured["name"])).collect();
    assert!(
        names.contains("eb_reaction") && names.len() > 4,
        "{names:?}"
    );
    for name in names {
        let spoken = name.replace('_', " ").replace("eb ", "EB ");
        assert!(!page.contains(name) && !page.contains(&spoken), "{name}");
    }
    for word in [
        "EB 반응 시간",
        "교체 대상: 비상제동 계전기 (eb_relay, ",
        "점검 불합격",
    ] {
        assert!(page.contains(word), "{word}");
    }
}

/// Goal: a Korean reader finds signals, states and parts by the names people use. Method: no identifier of a signal that could
/// be no other word is left in a fault with its freeze frame.
#[test]
fn a_korean_freeze_frame_names_signals_states_and_parts() {
    let place = Place::new();
    let run = ["run", "atp/overspeed", "--inject", "eb_relay.slow"];
    place.ptu(&run).exits(1);
    place.ptu(&["diagnose", "latest"]).exits(0);
    let english = place.ptu(&["faults", "show", "latest"]).exits(0).out;
    let show = ["faults", "show", "latest", "--lang", "ko"];
    let said = place.ptu(&show).exits(0).out;
    let signals = place.json(&["catalog", "signals", "--json"]);
    let names = list(&signals).iter().map(|signal| text(&signal["name"]));
    let names: Vec<_> = names.filter(|name| name.contains('_')).collect();
    assert!(names.iter().all(|name| english.contains(name)), "{english}");
    let left: Vec<_> = names.iter().filter(|name| said.contains(**name)).collect();
    assert!(left.is_empty(), "{left:?}: {said}");
    for word in [
        "비상제동 계전기",
        "프리즈 프레임",
        "전두계전기(HCR)",
        "체결",
        "켜짐",
    ] {
        assert!(said.contains(word), "{word}: {said}");
    }
    let sentences: Vec<_> = said.lines().filter(|line| is_english(line)).collect();
    assert!(sentences.is_empty(), "{sentences:#?}");
}

/// Goal: who adds a step, a measurement, a reason for a limit or a symptom adds its Korean.
#[test]
fn every_step_measurement_symptom_and_reason_of_a_limit_has_korean() {
    let place = Place::new();
    let said = place.ptu(&["run", "--check"]).exits(0);
    let all = "each text has its Korean";
    assert!(said.out.contains(all), "{}", said.all());
    let words = Language::Korean.words();
    let symptoms = place.json(&["catalog", "symptoms", "--json"]);
    let names = list(&symptoms).iter().map(|symptom| text(&symptom["name"]));
    let missing: Vec<_> = names.filter(|name| words.content(name) == *name).collect();
    assert!(
        missing.is_empty(),
        "not in scripts/korean.toml: {missing:?}"
    );
}

#[test]
fn a_sheet_without_a_dictionary_says_why_it_has_no_diagnosis() {
    let place = Place::new();
    place.recorded_run();
    let store = Store::open_read_only(&place.path("history.db")).expect("the test's database");
    let run = store.resolve_run("latest").expect("the run");
    let sheet = Sheet::gather(&store, &place.no_scripts(), run).expect("a sheet");
    let page = html(&sheet, Language::English.words());
    assert!(page.contains("No diagnosis: cannot read "));
}
