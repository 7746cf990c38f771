//! Repair sheets of cases with much, little and long content.

use fault_db::RepairRecord;

use super::super::tests::{Stored, stored, words_of};
use super::{CaseSheet, Standing};
use crate::run::page::pages;
use crate::words::Language;

/// Longer than any column.
const LONG: &str = "contacts burnt, wiring of the cabinet checked and cleaned, 접점 소손; ";

fn case(stored: &Stored, with_annex: bool) -> CaseSheet {
    let store = &stored.store;
    let fault = store.resolve_fault("latest").expect("a fault");
    CaseSheet::gather(store, &stored.no_scripts(), fault, "", with_annex).expect("a sheet")
}

fn repair(stored: &Stored) {
    let record = RepairRecord {
        part: "eb_relay".into(),
        serial_old: Some("OLD-1".into()),
        serial_new: Some("NEW-2".into()),
        note: LONG.repeat(20),
    };
    let fault = stored.store.resolve_fault("latest").expect("a fault");
    let repaired = stored
        .store
        .record_repair(fault, &record, "Kim", 90_000_000);
    repaired.expect("a repair");
}

/// Goal: page 1 stands alone and a case is never more than three pages. Method: 67 failed steps, each with a long hostile
/// message and a trace, and a note of more than a thousand letters.
#[test]
fn a_case_of_many_failures_has_its_signatures_on_page_one_of_three_at_most() {
    let (stored, _) = stored(200, true);
    repair(&stored);
    let sheet = case(&stored, false);
    assert_eq!(sheet.standing, Standing::Claimed);
    for (language, approver) in [
        (Language::English, "Approver"),
        (Language::Korean, "승인자"),
    ] {
        let pages = pages(&sheet, language.words()).expect("pages");
        assert!((2..=3).contains(&pages.len()), "{}", pages.len());
        let first = words_of(&pages[0]);
        for word in [
            "OLD-1",
            "NEW-2",
            "eb_relay",
            "640",
            "472",
            &sheet.number(),
            approver,
        ] {
            assert!(first.contains(word), "{language:?}: {word}: {first}");
        }
    }
    let annex = case(&stored, true);
    let words = Language::English.words();
    assert!(pages(&annex, words).expect("pages").len() > 3);
}

/// Goal: a signature is on the sheet that is written after it. Method: a note on the last run, as who checks it leaves one.
#[test]
fn a_repair_sheet_names_who_checked_its_last_run() {
    let (stored, run) = stored(1, true);
    repair(&stored);
    let who = "Ahn Sook-ja";
    let noted = stored.store.add_run_note(run, who, "Checked", 91_000_000);
    noted.expect("a note");
    let pages = pages(&case(&stored, false), Language::English.words()).expect("pages");
    let all: String = pages.iter().map(|page| words_of(page)).collect();
    assert!(all.contains(who), "{all}");
}

#[test]
fn a_fault_that_nobody_repaired_has_a_sheet_that_says_so() {
    let (stored, run) = stored(1, true);
    let sheet = case(&stored, false);
    assert_eq!(sheet.standing, Standing::NotRepaired);
    assert!(sheet.after.is_none() && sheet.before.run.run.id == run);
    let pages = pages(&sheet, Language::English.words()).expect("pages");
    assert!(words_of(&pages[0]).contains("Not repaired"));
}
