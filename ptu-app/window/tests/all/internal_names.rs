//! What people read has the names that people use: no `self_test_failed`, and no English sentence on a Korean page.

use crate::common::is_english;
use crate::common::window::{Window, settings};
use crate::common::{Place, scripts};
use fuzzing::draw;
use protocol::signal::Signal;
use ptu_options::Page;
use ptu_report::words::Language;
use ptu_window::Settings;

/// Faults that show in the self-test, in the unit's log, in measured values and in signals without data.
const FAULTS: [&str; 6] = [
    "eb_relay.slow",
    "tra.dead",
    "atp_receiver.dead",
    "io_board.mode_input_dead",
    "twc_cpu.dead",
    "brake_unit.dead",
];

/// A name that only scripts and programs write, but for the identifier of a part behind its name, as
/// "비상제동 계전기 (eb_relay, 99.6 %)", and what a script calls its step, "no_code: released"; paths of scripts and fault
/// modes are names that people type.
fn internal_name(text: &str) -> Option<&str> {
    let mut words = text.split(|c: char| !(c.is_ascii_alphanumeric() || "_./".contains(c)));
    words.find(|word| {
        let is_name = word.contains('_') && !word.contains(['/', '.']);
        let behind = [format!(" ({word})"), format!(" ({word}, ")];
        let is_step = text.contains(&format!("{word}: "));
        is_name && !is_step && !behind.iter().any(|behind| text.contains(behind))
    })
}

fn is_wrong(text: &str, language: Language) -> bool {
    // Beside its trace a signal has the name that scripts and files of traces give it, but in Korean.
    if language == Language::English && Signal::from_name(text).is_some() {
        return false;
    }
    internal_name(text).is_some() || (language == Language::Korean && is_english(text))
}

/// The texts of an HTML page but those within pictures, where signals have the names that files of traces give them.
fn texts(page: &str) -> Vec<&str> {
    let body = page.split_once("</style>").map_or(page, |(_, body)| body);
    let pictures = body.split("<svg").map(|part| {
        let after = part.split_once("</svg>");
        after.map_or(part, |(_, after)| after)
    });
    let texts = pictures.flat_map(|part| part.split('<'));
    let texts = texts.filter_map(|part| Some(part.split_once('>')?.1.trim()));
    texts.filter(|text| !text.is_empty()).collect()
}

/// Goal: who reads a sheet needs no list of identifiers. Method: several faults, the whole suite on each; the sheet of each in
/// both languages, which has the reasons of its diagnosis, and each reason as other programs read it.
#[test]
fn sheets_and_reasons_have_no_internal_names() {
    let mut wrong = Vec::new();
    for fault in draw::drawn(FAULTS, 2) {
        let place = Place::new();
        place.ptu(&["run", "--inject", fault]).exits(1);
        let answer = place.json("diagnose latest --json");
        let candidates = answer["candidates"].as_array().expect("candidates");
        let reasons = candidates.iter().flat_map(|one| {
            let both = ["for", "against"].map(|key| one[key].as_array().expect("reasons"));
            both.into_iter().flatten()
        });
        let reasons: Vec<_> = reasons.filter_map(|reason| reason.as_str()).collect();
        assert!(!reasons.is_empty(), "{answer:#}");
        let english = |reason: &&&str| is_wrong(reason, Language::English);
        wrong.extend(
            reasons
                .iter()
                .filter(english)
                .map(|reason| format!("{fault}: {reason}")),
        );
        for language in Language::ALL {
            let code = language.code();
            place
                .ptu(&["report", "latest", "--lang", code, "--out", "sheet.html"])
                .exits(0);
            let sheet = place.read("sheet.html");
            let bad = texts(&sheet)
                .into_iter()
                .filter(|text| is_wrong(text, language));
            wrong.extend(bad.map(|text| format!("{fault}, sheet: {text}")));
        }
    }
    wrong.sort();
    wrong.dedup();
    assert!(wrong.is_empty(), "{}: {wrong:#?}", wrong.len());
}

/// Goal: a technician who reads no English is led to the part, and who does reads no identifiers. Method: two faults are found
/// in the window by the way of a case; every text of each page that tells of them is read.
#[test]
fn the_way_of_a_case_has_no_internal_names() {
    let mut wrong = Vec::new();
    for (fault, language) in [
        ("io_board.mode_input_dead", Language::Korean),
        ("atp_receiver.dead", Language::Korean),
        ("eb_relay.slow", Language::English),
    ] {
        let words = language.words();
        let mut settings = Settings {
            language,
            operator: "Kim".into(),
            ..settings(Page::Case)
        };
        settings.unit.faults = vec![fault.into()];
        let mut window = Window::with(Place::new(), scripts(), settings);
        let mut look = |window: &Window, what: &str| {
            let shown = window.shown().into_iter();
            let bad = shown.filter(|text| is_wrong(text, language));
            wrong.extend(bad.map(|text| format!("{fault}, {what}: {text}")));
        };
        window.connect_simulated();
        window.wait_for(words.case.unknown);
        look(&window, "symptom");
        window.click_last(words.case.unknown);
        window.click_last(words.case.find_part);
        window.wait_for(words.case.record_repair);
        window.wait_for(words.case.why);
        look(&window, "why");
        window.click_for(words.case.beside, words.case.beside_twin);
        look(&window, "beside a good unit");
        window.click(words.case.way);
        window.step();
        look(&window, "way of the signal");
        for (page, said) in [
            (Page::Faults, words.faults.find),
            (Page::Diagnosis, words.diagnosis.reasons),
            (Page::Report, words.report.write_pdf),
            (Page::Statistics, words.statistics.mtbf_is),
        ] {
            window.page(page);
            window.wait_for(said);
            look(&window, page.name(words));
        }
    }
    wrong.dedup();
    assert!(wrong.is_empty(), "{}: {wrong:#?}", wrong.len());
}
