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

/// Goal: who adds a step, a measurement, a reason for a limit or a symptom adds its Korean.
#[test]
fn every_step_measurement_symptom_and_reason_of_a_limit_has_korean() {
    let place = Place::new();
    let said = place.ptu("run --check").exits(0);
    let all = "each text has its Korean";
    assert!(said.out.contains(all), "{}", said.all());
    let words = Language::Korean.words();
    let symptoms = place.json("catalog symptoms --json");
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
    let page = html(&sheet, Language::Korean.words());
    assert!(page.contains("진단 불가: 읽을 수 없습니다: "));
}
