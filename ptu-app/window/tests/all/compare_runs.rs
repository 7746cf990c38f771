//! Two runs of a unit beside each other, before and after a repair: `ptu runs compare`, and in the window.

use fault_db::Verdict;
use ptu_options::Page;
use ptu_report::words::Language;

use crate::common::is_english;
use crate::common::window::{Window, settings_in};
use crate::common::{Place, list, number, scripts, text};
use crate::layout::complaints;

/// A unit with a slow relay, and the same one after the repair.
fn before_and_after() -> (Place, [String; 2]) {
    let place = Place::with_bad_unit();
    let run = ["run", "atp/overspeed", "--serial-no", "BAD-1"];
    place.ptu(&run).exits(0);
    let [after, before] = <[String; 2]>::try_from(place.run_ids()).expect("two runs");
    (place, [before, after])
}

#[test]
fn what_a_repair_changed_is_told_by_step_and_value() {
    let (place, [before, after]) = before_and_after();
    let said = place
        .ptu(&["runs", "compare", &before, "latest"])
        .exits(0)
        .out;
    for word in [
        "That passed in A and do not in B: 0. That pass in neither: 0.",
        "atp/overspeed: code 25: alarm, FSB, EB",
        "640 ms",
        "at most 472 ms",
        "Further steps, passed in both runs",
    ] {
        assert!(said.contains(word), "{word}: {said}");
    }
    let file = place.text_path("compared.json");
    let compare = ["runs", "compare", &before, &after, "--json"];
    let data = place.json(&[&compare[..], &["--report", &file]].concat());
    assert_eq!(place.read_json("compared.json"), data);
    let failed = place.json(&["runs", "show", &before, "--json"]);
    let failed = list(&failed["steps"]).iter();
    let failed = failed.filter(|step| step["verdict"] == "failed").count();
    assert_eq!(number(&data["pass_now"]), failed as f64);
    assert!(list(&data["differs"]).is_empty(), "{}", data["differs"]);
    let steps = list(&data["steps"]).iter();
    let mut slow = steps.filter(|step| text(&step["name"]) == "code 25: alarm, FSB, EB");
    let slow = slow.next().expect("the step of the slow relay");
    assert_eq!(
        (text(&slow["verdict_a"]), text(&slow["verdict_b"])),
        ("failed", "passed")
    );
    let mut values = list(&slow["measurements"]).iter();
    let reaction = values.find(|one| one["name"] == "eb_reaction");
    let reaction = reaction.expect("the reaction");
    let [a, b] = ["a", "b"].map(|run| number(&reaction[run]["value"]));
    assert_eq!(a, 640.0);
    assert!(b <= number(&reaction["b"]["high"]), "{reaction}");
    assert_eq!(number(&reaction["change"]), b - a);

    // The other way round a bench is told that the unit is worse.
    let said = place
        .ptu(&["runs", "compare", &after, &before])
        .exits(1)
        .out;
    assert!(said.contains("Run A was made after run B."), "{said}");
    let all = place
        .ptu(&["runs", "compare", &before, &after, "--all"])
        .exits(0)
        .out;
    assert!(all.lines().count() > said.lines().count());
    assert!(!all.contains("Further steps"), "{all}");
}

#[test]
fn a_korean_comparison_has_no_english_sentence() {
    let (place, [before, after]) = before_and_after();
    let (html, pdf) = (place.text_path("ko.html"), place.text_path("ko.pdf"));
    let compare = ["runs", "compare", &before, &after, "--lang", "ko", "--all"];
    let files = ["--report", &html, "--report", &pdf];
    let said = place.ptu(&[&compare[..], &files].concat()).exits(0).out;
    let page = place.read("ko.html");
    let body = page.split_once("</style>").map_or(&*page, |(_, body)| body);
    let texts = body.split('<').filter_map(|part| part.split_once('>'));
    let texts = texts.map(|(_, text)| text.trim()).chain(said.lines());
    let english: Vec<_> = texts.filter(|text| is_english(text)).collect();
    assert!(english.is_empty(), "{english:#?}");
    for word in [
        "속도 코드 25",
        "EB 반응 시간",
        "불합격",
        "472 ms 이하",
        "미합격",
    ] {
        assert!(said.contains(word) && page.contains(word), "{word}: {said}");
    }
    assert!(std::fs::read(pdf).is_ok_and(|file| file.starts_with(b"%PDF-")));
}

#[test]
fn runs_that_are_hard_to_compare_are_compared_and_it_is_said() {
    let (place, [before, _]) = before_and_after();
    place.ptu("run tcms/link --line line6").exits(0);
    let said = place
        .ptu(&["runs", "compare", &before, "latest"])
        .exits(0)
        .out;
    for word in [
        "different units: BAD-1 and SIM-0001",
        "different lines",
        "Steps of A alone: ",
        "Steps of B alone: ",
    ] {
        assert!(said.contains(word), "{word}: {said}");
    }
    let same = ["runs", "compare", &before, &before];
    place.ptu(&same).exits(2).explains(&["with another one"]);
    let unknown = ["runs", "compare", &before, "ffffffff"];
    place.ptu(&unknown).exits(2);
}

/// Goal: the window shows the same as the command line, in both languages, and writes it. Method: the later run is shown by
/// itself, the earlier one is chosen beside it.
#[test]
fn a_second_run_of_the_unit_is_chosen_beside_the_sheet() {
    for language in Language::ALL {
        let words = language.words();
        let report = &words.report;
        let (place, [_, after]) = before_and_after();
        // A run of another unit is not offered.
        place.ptu("run tcms/link").exits(0);
        let settings = settings_in(language, Page::Report);
        let mut window = Window::with(place, scripts(), settings);
        window.wait_for_part("SIM-0001");
        window.click_part(" · BAD-1");
        let short = after.get(after.len() - 8..).expect("an id");
        window.wait_for_part(short);
        window.click_last(report.compare_with);
        let failed = words.common.stored_verdict(Verdict::Failed);
        window.click_part(&format!(" · {failed}"));
        window.wait_for(report.comparison);
        window.wait_for_part("472");
        window.wait_for("640 ms");
        assert!(
            complaints(&mut window).is_empty(),
            "{:?}",
            complaints(&mut window)
        );
        window.click(report.all_steps);
        let file = window.place.text_path("compared.html");
        window.name_file(report.file, &file);
        window.click_for(report.write_html, report.open_file);
        let page = window.place.read("compared.html");
        assert!(page.contains("640 ms") && page.contains(report.comparison));
        // With all steps nothing is left to count.
        let rest = report.passed_in_both.split(':').next().expect("a wording");
        assert!(!page.contains(rest), "{rest}");
        // Back to the sheet alone.
        window.click_last(report.compare_with);
        window.click_for(report.no_comparison, report.sheet);
    }
}
