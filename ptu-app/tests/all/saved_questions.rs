//! Questions that are saved under a name and asked again.

use crate::common::{Place, list};
use crate::questions::mended;

#[test]
fn a_question_is_saved_and_asked_again() {
    let place = mended();
    let said = place
        .ptu(&[
            "faults", "stats", "--by", "part", "--when", "30d", "--save", "worst",
        ])
        .exits(0);
    assert!(
        place
            .ptu(&["saved"])
            .exits(0)
            .out
            .contains("ptu faults stats --by part --when 30d")
    );
    assert_eq!(place.ptu(&["saved", "worst"]).exits(0).out, said.out);
    let csv = place.ptu(&["saved", "worst", "--csv"]).exits(0).out;
    assert!(csv.starts_with("key,"), "{csv}");
    let sql = "SELECT part, serial_new FROM repairs WHERE note <> ''";
    place.ptu(&["db", "query", sql, "--save", "parts"]).exits(0);
    assert!(
        place
            .ptu(&["saved", "parts"])
            .exits(0)
            .out
            .contains("R/99_b")
    );
    place.ptu(&["saved", "wort"]).exits(2).explains(&[
        "no question \"wort\"",
        "\"worst\"",
        "`ptu saved`",
    ]);
    let rows = |more: &[&str]| {
        let csv = place.ptu(&[&["saved", "one"], more].concat()).exits(0).out;
        csv.lines().count() - 1
    };
    let one = "faults list --limit 1 --csv --when 30d --save one";
    place.ptu(&one.split(' ').collect::<Vec<_>>()).exits(0);
    assert_eq!(rows(&[]), 1);
    assert!(rows(&["--limit", "3"]) > 1, "what is given now replaces it");
    assert_eq!(rows(&["--limit=9", "--when", "..2020"]), 0);
    let json = place.json(&["saved", "one", "--json"]);
    assert_eq!(list(&json).len(), 1);
    place
        .ptu(&["faults", "list", "--limit", "1", "--limit", "2"])
        .exits(2)
        .explains(&["--limit", "multiple times"]);
    place
        .ptu(&["saved", "worst", "--save", "worst"])
        .exits(2)
        .explains(&["is saved already"]);
    place.ptu(&["saved", "worst"]).exits(0);
    place.ptu(&["saved", "--forget", "worst"]).exits(0);
    place.ptu(&["saved", "worst"]).exits(2);
}

/// Who writes the file of questions may have one ask another, but not itself.
#[test]
fn a_saved_question_that_asks_itself_is_refused_with_its_circle() {
    let place = Place::new();
    place.recorded_run();
    place.ptu(&["faults", "list", "--save", "all"]).exits(0);
    let file = place.path(".config/ptu/questions.json");
    let questions = r#"{
        "all": ["faults", "list"], "once more": ["saved", "all"], "me": ["saved", "me"],
        "in": ["saved", "a"], "a": ["saved", "b"], "b": ["saved", "c", "--json"], "c": ["saved", "a"]
    }"#;
    std::fs::write(&file, questions).expect("the file of questions");
    let all = place.ptu(&["saved", "all"]).exits(0).out;
    assert_eq!(place.ptu(&["saved", "once more"]).exits(0).out, all);
    for (name, circle) in [
        ("me", "me → me"),
        ("a", "a → b → c → a"),
        ("in", "a → b → c → a"),
    ] {
        let said = place.ptu(&["saved", name]).exits(2);
        said.explains(&["asks itself: ", circle, "questions.json", "--forget"]);
    }
    place.ptu(&["saved", "--forget", "c"]).exits(0);
    place
        .ptu(&["saved", "a"])
        .exits(2)
        .explains(&["no question \"c\""]);
}
