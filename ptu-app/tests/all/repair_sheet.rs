//! `ptu report`: from a fault over its repair to the sheet that proves it.

use fault_db::Store;
use ptu_report::run::CaseSheet;
use ptu_report::run::page::{Item, pages};
use ptu_report::words::Language;
use serde_json::Value;

use crate::common::is_english;
use crate::common::{Place, list, number, record_bad_unit, relay_fault, text};

/// A unit whose relay was slow and was replaced, and the id of the fault.
fn repaired() -> (Place, String) {
    let place = Place::new();
    record_bad_unit(&place);
    let fault = text(&relay_fault(&place)["id"]).to_owned();
    let repair = format!(
        "faults repair {fault} --part eb_relay --who Kim --old SN-41 --new SN-77 --note 'contacts burnt'"
    );
    place.ptu(&repair).exits(0);
    (place, fault)
}

/// The same, with the run that proves the repair.
fn proved() -> (Place, String) {
    let (place, fault) = repaired();
    let run = "run atp/overspeed --serial-no BAD-1 --who Lee";
    let said = place.ptu(run).exits(0).out;
    assert!(said.contains("the repair is verified"), "{said}");
    (place, fault)
}

/// The texts of an HTML page as they are read, one after the other.
fn read(page: &str) -> String {
    let body = page.split_once("</style>").map_or(page, |(_, body)| body);
    let texts = body.split('<').filter_map(|part| part.split_once('>'));
    let words = texts.flat_map(|(_, text)| text.split_whitespace());
    words.collect::<Vec<_>>().join(" ")
}

fn pages_of_pdf(place: &Place, name: &str) -> usize {
    let bytes = std::fs::read(place.path(name)).expect("a document");
    assert!(bytes.starts_with(b"%PDF-"));
    String::from_utf8_lossy(&bytes)
        .matches("/Type/Page/")
        .count()
}

/// Goal: the sheet of a case proves the repair to who has nothing but it. Method: a slow relay is found, replaced and
/// proved through the command line; the Korean sheet is read as text, the first page of the layout by itself.
#[test]
fn the_sheet_of_a_proved_case_has_part_values_runs_and_verdict_on_its_first_page() {
    let (place, fault) = proved();
    let files = ["case.html", "case.pdf", "case.json"].map(|name| place.text_path(name));
    let [html, pdf, json] = files.each_ref().map(String::as_str);
    let report = ["report", &fault, "--lang", "ko", "--depot", "군자차량기지"];
    let out = ["--out", html, "--out", pdf, "--out", json];
    place.ptu(&[&report[..], &out].concat()).exits(0);
    let said = read(&place.read("case.html"));
    let runs = place.run_ids();
    let words = [
        "수리 성적서",
        "모의 시험",
        "군자차량기지",
        "BAD-1",
        "eb_relay",
        "SN-41",
        "SN-77",
        "contacts burnt",
        "640 ms",
        "472 ms 이하",
        "수리 입증",
        "Kim (수리 전), Lee (수리 후)",
        "eb_relay.slow",
        "합격",
        "승인자",
        &runs[0],
        &runs[1],
    ];
    for word in words {
        assert!(said.contains(word), "{word}: {said}");
    }
    let count = pages_of_pdf(&place, "case.pdf");
    assert!((1..=3).contains(&count), "{count} pages");

    let store = Store::open_read_only(&place.path("history.db")).expect("the database");
    let id = store.resolve_fault(&fault).expect("the fault");
    let sheet =
        CaseSheet::gather(&store, &place.no_scripts(), id, "군자차량기지", false).expect("a sheet");
    let laid_out = pages(&sheet, Language::Korean.words()).expect("pages");
    assert_eq!(laid_out.len(), count);
    let first: String = laid_out[0].iter().map(words_of).collect();
    for word in words.iter().filter(|word| **word != "Approver") {
        assert!(first.contains(word), "not on page 1: {word}");
    }

    // The trace of the step that failed stands beside that of the same step that passed.
    let traced = runs.iter().map(|run| {
        let run = store.resolve_run(run).expect("the run");
        let traces = store.traces(run).expect("traces");
        let on_sheet = traces
            .iter()
            .filter(|trace| said.contains(&format!("(신호 기록 {})", trace.id.short())));
        on_sheet
            .map(|trace| trace.occurrences > 0)
            .collect::<Vec<_>>()
    });
    let mut traced: Vec<_> = traced.collect();
    traced.sort();
    assert_eq!(traced, [[false], [true]], "one of each run");

    let case = place.read_json("case.json");
    assert_eq!(text(&case["repair_is"]), "proved");
    let slow = list(&case["compared"]).iter().find(|one| {
        text(&one["step"]) == "code 25: alarm, FSB, EB"
            && text(&one["measurement"]) == "eb_reaction"
    });
    let slow = slow.expect("the slow reaction");
    assert_eq!(number(&slow["before"]["value"]), 640.0);
    let allowed = number(&slow["after"]["high"]);
    assert!(number(&slow["after"]["value"]) <= allowed, "{slow}");
    assert_eq!(text(&slow["verdict_after"]), "passed");
}

fn words_of(item: &Item) -> String {
    match item {
        Item::Text(text) => text
            .lines
            .iter()
            .map(|(_, line)| line.clone() + " ")
            .collect(),
        _ => String::new(),
    }
}

/// Goal: the sheet says what who brought the unit said, also when the run that failed last was asked for nothing. Method: a
/// run with a symptom and one without see the same fault.
#[test]
fn the_sheet_of_a_case_has_what_was_said_when_the_unit_was_brought() {
    let place = Place::new();
    let run = ["run", "atp/overspeed", "--inject", "eb_relay.slow"];
    let symptom = ["--symptom", "brakes_late"];
    place.ptu(&[&run[..], &symptom].concat()).exits(1);
    place.ptu(&run).exits(1);
    for (language, said, found) in [
        (
            "en",
            "Symptom Brakes late or not at all",
            "Found by atp/overspeed, code 25",
        ),
        (
            "ko",
            "증상 제동이 늦거나 걸리지 않음",
            "검출 단계 atp/overspeed, 속도 코드 25",
        ),
    ] {
        let files = ["html", "json"].map(|end| place.text_path(&format!("{language}.{end}")));
        let report = ["report", "latest", "--case", "--lang", language];
        let out = ["--out", &files[0], "--out", &files[1]];
        place.ptu(&[&report[..], &out].concat()).exits(0);
        let page = read(&place.read(&format!("{language}.html")));
        for word in [said, found] {
            assert!(page.contains(word), "{word}: {page}");
        }
        let case = place.read_json(&format!("{language}.json"));
        assert_eq!(text(&case["symptom"]), "brakes_late");
    }
}

/// Another fault of the same case is on the same sheet, with the same number.
#[test]
fn each_fault_of_a_case_has_the_same_sheet() {
    let (place, fault) = proved();
    let faults = place.json(&["faults", "list", "--cause", "eb_relay", "--json"]);
    let mut others = list(&faults).iter().map(|fault| text(&fault["id"]));
    let other = others.find(|id| *id != fault).expect("a consequence");
    let [one, two] = [(&*fault, "a.html"), (other, "b.html")].map(|(id, name)| {
        let file = place.text_path(name);
        place.ptu(&["report", id, "--out", &file]).exits(0);
        place.read(name)
    });
    assert!(one == two, "the sheets differ");
}

#[test]
fn a_repair_without_a_run_is_not_proved_on_its_sheet() {
    let (place, fault) = repaired();
    let files = ["case.html", "case.json"].map(|name| place.text_path(name));
    let [html, json] = files.each_ref().map(String::as_str);
    place
        .ptu(&["report", &fault, "--out", html, "--out", json])
        .exits(0);
    let said = read(&place.read("case.html"));
    for word in [
        "Repair not proved",
        "no run passed since",
        "SN-77",
        "not tested",
        "Symptom not stated",
        "Found by atp/overspeed, code 25: alarm, FSB, EB: EB reaction = 640",
    ] {
        assert!(said.contains(word), "{word}: {said}");
    }
    assert!(!said.contains("Repair proved"), "{said}");
    let case = place.read_json("case.json");
    assert_eq!(text(&case["repair_is"]), "claimed");
    assert_eq!(case["run_after"], Value::Null);
}

/// Goal: the run that proves a repair says so on its own sheet, and `ptu report` writes what `ptu runs show` does.
#[test]
fn the_sheet_of_the_proof_run_names_what_it_settles() {
    let (place, fault) = proved();
    let files = ["a.html", "a.json", "b.html"].map(|name| place.text_path(name));
    let [html, json, shown] = files.each_ref().map(String::as_str);
    place
        .ptu(&["report", "latest", "--out", html, "--out", json])
        .exits(0);
    place
        .ptu(&["runs", "show", "latest", "--report", shown])
        .exits(0);
    assert_eq!(place.read("a.html"), place.read("b.html"));
    let said = read(&place.read("a.html"));
    for word in ["Repairs this run proves", "SN-41", "SN-77", "SIMULATED"] {
        assert!(said.contains(word), "{word}: {said}");
    }
    let report = place.read_json("a.json");
    let settled: Vec<_> = list(&report["settles"])
        .iter()
        .map(|f| text(&f["id"]))
        .collect();
    assert!(settled.contains(&&*fault), "{report}");
    assert_eq!(text(&report["settles"][0]["repair"]["serial_new"]), "SN-77");
}

/// Goal: a proof holds until the fault is seen again, and a person's word is told as one. Method: the relay is slow again
/// after the proof; then it is repaired once more, and somebody says that it holds.
#[test]
fn a_fault_that_came_back_and_a_persons_word_are_no_proof() {
    let (place, fault) = proved();
    record_bad_unit(&place);
    let sheet = |name: &str| {
        let file = place.text_path(name);
        place.ptu(&["report", &fault, "--out", &file]).exits(0);
        place.read(name)
    };
    assert!(read(&sheet("again.html")).contains("Fault came back"));
    assert_eq!(sheet("again.json").matches("\"came_back\"").count(), 1);
    let again = ["--part", "eb_relay", "--new", "SN-78", "--who", "Kim"];
    place
        .ptu(&[&["faults", "repair", &fault], &again[..]].concat())
        .exits(0);
    let word = ["--who", "Park", "--note", "checked on the line"];
    place
        .ptu(&[&["faults", "state", &fault, "verified"], &word[..]].concat())
        .exits(0);
    let said = read(&sheet("word.html"));
    for word in [
        "Repair verified by a person",
        "no run proves it",
        "checked on the line",
        "SN-78",
    ] {
        assert!(said.contains(word), "{word}: {said}");
    }
    assert!(!said.contains("Repair proved"), "{said}");
}

/// Goal: a Korean sheet of a case is Korean, with the states of drawn signals and what a unit logged by itself.
#[test]
fn a_korean_sheet_of_a_case_has_no_english_sentence() {
    for (procedures, fault) in [
        ("atp/overspeed", "eb_relay.slow"),
        ("atp/power_up", "atp_receiver.dead"),
    ] {
        let place = Place::new();
        place.ptu(&["run", procedures, "--inject", fault]).exits(1);
        let file = place.text_path("case.html");
        let report = ["report", "latest", "--case", "--lang", "ko", "--out", &file];
        place.ptu(&report).exits(0);
        let page = place.read("case.html");
        let body = page.split_once("</style>").map_or(&*page, |(_, body)| body);
        let texts = body.split('<').filter_map(|part| part.split_once('>'));
        let english: Vec<_> = texts
            .map(|(_, text)| text.trim())
            .filter(|text| is_english(text))
            .collect();
        assert!(english.is_empty(), "{fault}: {english:#?}");
        assert!(
            body.contains("체결") && !body.contains(">applied<"),
            "{fault}"
        );
    }
}
