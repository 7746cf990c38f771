//! `ptu report`: from a fault over its repair to the sheet that proves it.

use fault_db::Store;
use ptu_report::run::CaseSheet;
use ptu_report::run::page::{Item, pages};
use ptu_report::words::Language;

use crate::common::is_english;
use crate::common::{Place, list, number, relay_fault, text};

/// A unit whose relay was slow and was replaced, and the id of the fault.
fn repaired() -> (Place, String) {
    let place = Place::with_bad_unit();
    let fault = text(&relay_fault(&place)["id"]).to_owned();
    let repair = format!(
        "faults repair {fault} --part eb_relay --who Kim --old SN-41 --new SN-77 --note 'contacts burnt'"
    );
    place.ptu(&repair).exits(0);
    (place, fault)
}

/// A repaired fault, with the run that proves the repair.
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
