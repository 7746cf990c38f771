//! Test sheets and tables of runs, as the program writes them.

use std::collections::BTreeSet;

use crate::common::{Place, is_english, list, text};
use fault_db::Store;
use ptu_report::run::{Sheet, html};
use ptu_report::words::Language;

/// A failed run in all formats at once, and the same from the store: sheets say what failed, and are
/// the same files again.
#[test]
fn a_failed_run_is_the_same_on_a_sheet_now_and_from_the_store() {
    let place = Place::new();
    let first = ["a.html", "a.pdf", "a.csv"].map(|name| place.text_path(name));
    let [html, pdf, csv] = first.each_ref().map(String::as_str);
    let run = [
        "run",
        "atp/overspeed",
        "--inject",
        "eb_relay.slow",
        "--who",
        "A. Tester",
    ];
    let reports = ["--report", html, "--report", pdf, "--report", csv];
    place.ptu(&[&run[..], &reports].concat()).exits(1);
    let page = place.read("a.html");
    for word in [
        "Failed",
        "SIM-0001",
        "A. Tester",
        "code 25: alarm, FSB, EB",
        "EB reaction",
        "472",
        "eb_relay.slow",
        "replace the EB relay (eb_relay, ",
        "Approver",
    ] {
        assert!(page.contains(word), "{word}");
    }
    assert!(page.matches("<figure").count() >= 2, "no trace is drawn");
    let again = ["b.html", "b.pdf", "b.csv"].map(|name| place.text_path(name));
    let [html, pdf, csv] = again.each_ref().map(String::as_str);
    let show = format!("runs show latest --report {html} --report {pdf} --report {csv}");
    place.ptu(&show).exits(0);
    for ending in ["html", "pdf", "csv"] {
        let bytes =
            |name: &str| std::fs::read(place.path(&format!("{name}.{ending}"))).expect("a report");
        assert_eq!(bytes("a"), bytes("b"), "{ending}");
    }
    assert!(std::fs::read(place.path("a.pdf")).is_ok_and(|pdf| pdf.starts_with(b"%PDF-")));
}

#[test]
fn a_passing_run_has_a_korean_sheet() {
    let place = Place::new();
    let (html, pdf) = (place.text_path("sheet.html"), place.text_path("sheet.pdf"));
    let run = format!("run tcms/link --lang ko --report {html} --report {pdf}");
    place.ptu(&run).exits(0);
    let page = place.read("sheet.html");
    for word in [
        "시험 성적서",
        "합격",
        "노선",
        "승인자",
        "발생한 고장이 없습니다",
    ] {
        assert!(page.contains(word), "{word}");
    }
    assert!(!page.contains("미합격 항목"), "nothing failed");
}

/// What the font of paper lacks is told by the command and stands on the HTML page; a run without it is told nothing.
#[test]
fn letters_that_a_pdf_has_as_codes_are_told() {
    let place = Place::new();
    let names = "procedure(title = \"門\", suspect = \"tcms\")\nstep(\"扉 가\", measure = value(\"v\", speed))\n";
    place.write("names.star", names);
    let run = "run names.star --report a.pdf --report a.html";
    place
        .ptu(run)
        .exits(0)
        .explains(&["a.pdf", "\"扉\"", "[U+4E2D]"]);
    assert!(place.read("a.html").contains("扉 가"));
    place.ptu("run tcms/link").exits(0);
    let said = place.ptu("report latest --out b.pdf").exits(0);
    assert!(!said.err.contains("U+"), "{}", said.all());
}

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
fn a_table_has_a_line_for_each_measurement_and_each_step_without() {
    let place = Place::new();
    let csv = place.text_path("run.csv");
    let (_, report) = place.run(&["atp/overspeed", "--report", &csv]);
    let table = place.read("run.csv");
    let mut lines = table.lines();
    let head = "\u{feff}run,unit_serial,started_at,procedure,step_index,step,kind,step_verdict,bench_time_s,message,\
                measurement,value,unit,low,high,measurement_verdict,limit_source,turn,turns";
    assert_eq!(lines.next(), Some(head));
    let steps = report["steps"].as_array().expect("steps");
    let of = |step: &serde_json::Value| step["measurements"].as_array().map_or(0, Vec::len).max(1);
    assert_eq!(lines.count(), steps.iter().map(of).sum::<usize>());
    assert!(
        table.contains(",\"code 25: alarm, FSB, EB\",step,passed,"),
        "{table}"
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
