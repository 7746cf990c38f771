//! Test sheets and tables of runs, as the program writes them.

use crate::common::Place;
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
        "--operator",
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
        "eb_reaction",
        "472",
        "eb_relay.slow",
        "replace eb_relay",
        "Approver",
    ] {
        assert!(page.contains(word), "{word}");
    }
    assert!(page.matches("<figure").count() >= 2, "no trace is drawn");
    let again = ["b.html", "b.pdf", "b.csv"].map(|name| place.text_path(name));
    let [html, pdf, csv] = again.each_ref().map(String::as_str);
    let show = [
        "runs", "show", "latest", "--report", html, "--report", pdf, "--report", csv,
    ];
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
    let run = [
        "run",
        "tcms/link",
        "--lang",
        "ko",
        "--report",
        &html,
        "--report",
        &pdf,
    ];
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

#[test]
fn a_table_has_a_line_for_each_measurement_and_each_step_without() {
    let place = Place::new();
    let csv = place.text_path("run.csv");
    let (_, report) = place.run(&["atp/overspeed", "--report", &csv]);
    let table = place.read("run.csv");
    let mut lines = table.lines();
    let head = "run,unit_serial,started_at,procedure,step_index,step,kind,step_verdict,bench_time_s,message,\
                measurement,value,unit,low,high,measurement_verdict,limit_source";
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
fn what_cannot_be_written_or_found_is_named() {
    let place = Place::new();
    place.recorded_run();
    for (arguments, code, said) in [
        (
            &["--report", "nowhere/x.pdf"][..],
            2,
            "cannot write nowhere/x.pdf",
        ),
        (&["--report", "x.docx"], 2, "a report ends in .html, .pdf"),
        (&["--lang", "fr"], 2, "a language is en or ko"),
        (
            &["--report", "x.html", "--scripts", "gone"],
            2,
            "gone is not a directory",
        ),
    ] {
        let all = [&["runs", "show", "latest"], arguments].concat();
        let told = place.ptu(&all).exits(code);
        assert!(told.err.contains(said), "{}", told.all());
    }
}

#[test]
fn a_sheet_without_scripts_says_why_it_has_no_diagnosis() {
    let place = Place::new();
    place.recorded_run();
    let store = Store::open_read_only(&place.path("history.db")).expect("the test's database");
    let run = store.resolve_run("latest").expect("the run");
    let sheet = Sheet::gather(&store, None, run).expect("a sheet");
    let page = html(&sheet, Language::English.words());
    assert!(page.contains("No diagnosis: no scripts directory"));
}

/// Goal: the verdict of a part of the suite says first what it stands for, the same in every report. Method: a laptop
/// that passes what it can reach.
#[test]
fn a_part_of_the_suite_says_so_first_in_every_report() {
    let place = Place::new();
    let names = ["a.html", "a.junit.xml"].map(|name| place.text_path(name));
    let [html, junit] = names.each_ref().map(String::as_str);
    let run = ["ptu/markers", "atp/power_up", "--harness", "none"];
    let reports = ["--report", html, "--report", junit];
    let (said, report) = place.run(&[&run[..], &reports].concat());
    let said = said.exits(0);
    let coverage = &report["coverage"];
    let [run, of, left] = ["run", "steps", "need_bench"].map(|key| coverage[key].to_string());
    let part = format!(
        "{run} of {of} steps run, all passed; {left} skipped; {left} need the bench harness: atp"
    );
    assert_eq!(said.out.lines().next(), Some(&*format!("passed: {part}")));
    assert!(place.read("a.html").contains(&part));
    let junit = place.read("a.junit.xml");
    let first = junit.lines().find(|line| line.contains("<testsuites"));
    assert!(first.is_some_and(|line| line.contains(&part)), "{junit}");
}
