//! What was changed by hand is found and named, whatever was changed; and what only follows from other rows
//! is made anew.

mod common;

use std::path::Path;

use common::{T0_US, end, fault, measurement, open, run_record, step};
use fault_db::{Id, Problem, RepairRecord, RunWriter, Store, Verdict};
use rusqlite::Connection;
use tempfile::tempdir;

/// Three runs, each with a step, a measurement and a fault; one repair, one note.
fn three_runs(store: &Store) -> Vec<Id> {
    let mut runs = Vec::new();
    for n in 0..3 {
        let mut writer = RunWriter::begin(store, &run_record("ATC-7")).expect("begun");
        let mut measured = step(0);
        measured.measurements = vec![measurement("eb_reaction", 0.42)];
        writer.step(measured).expect("kept");
        let stored = writer.fault(&fault(n, T0_US)).expect("stored");
        writer.finish(&end(Verdict::Failed)).expect("finished");
        if n == 0 {
            let repair = RepairRecord {
                part: "eb_relay".to_owned(),
                serial_old: None,
                serial_new: None,
                note: "replaced".to_owned(),
            };
            let at_us = T0_US + 60;
            store
                .record_repair(stored.fault, &repair, "kim", at_us)
                .expect("repaired");
        }
        runs.push(writer.id());
    }
    runs
}

fn problems(store: &Store) -> Vec<Problem> {
    store.check().expect("checked").problems
}

fn by_hand(path: &Path, sql: &str) {
    let conn = Connection::open(path).expect("opens");
    conn.execute_batch(&format!("PRAGMA foreign_keys = OFF; {sql}"))
        .unwrap_or_else(|error| panic!("{sql}: {error}"));
}

/// Goal: each way to make a run say something else than it did is found, and the run or seal is named.
/// Method: rows changed behind the program's back; `{1}` stands for the second run's id.
#[test]
fn whatever_is_changed_about_a_run_is_found() {
    let no_trace_of_run_2 = "DELETE FROM measurement WHERE run = 2; DELETE FROM step WHERE run = 2;
        DELETE FROM run_script WHERE run = 2; DELETE FROM fault_occurrence WHERE run = 2;
        DELETE FROM run WHERE seq = 2";
    let no_run_2 = format!("{no_trace_of_run_2}; DELETE FROM seal WHERE run = 2");
    let no_last_run = no_run_2.replace("= 2", "= 3");
    let changed = "run {1} was changed";
    let cases: &[(&str, &[&str])] = &[
        (
            "UPDATE run SET verdict = 'passed' WHERE seq = 2",
            &[changed],
        ),
        ("UPDATE run SET operator = 'lee' WHERE seq = 2", &[changed]),
        ("UPDATE run SET train = '601' WHERE seq = 2", &[changed]),
        ("UPDATE step SET message = 'fine' WHERE run = 2", &[changed]),
        (
            "UPDATE step SET step_index = 4 WHERE run = 2; UPDATE measurement SET step_index = 4 WHERE run = 2",
            &[changed],
        ),
        ("UPDATE measurement SET high = 9 WHERE run = 2", &[changed]),
        (
            "UPDATE fault_occurrence SET message = '' WHERE run = 2",
            &[changed],
        ),
        (
            "UPDATE fault_occurrence SET freeze_json = '[]' WHERE run = 2",
            &[changed],
        ),
        (
            "UPDATE run_script SET sha256 = '' WHERE run = 2",
            &[changed],
        ),
        ("DELETE FROM run_script WHERE run = 2", &[changed]),
        (
            "UPDATE seal SET digest = (SELECT digest FROM seal WHERE ordinal = 1) WHERE ordinal = 2",
            &["seal 2 of file", changed],
        ),
        (
            "UPDATE seal SET hash = zeroblob(32) WHERE ordinal = 2",
            &["seal 2 of file", "seal 3 of file"],
        ),
        (
            "UPDATE seal SET run = 5 - run WHERE ordinal > 1",
            &["run {2} was changed", changed],
        ),
        (
            &no_run_2,
            &[
                "before it runs were taken out, number 2",
                "1 runs that were recorded here",
            ],
        ),
        (
            no_trace_of_run_2,
            &["seal 2 of file", "1 runs that were recorded here"],
        ),
        (&no_last_run, &["1 runs that were recorded here"]),
        (
            "DELETE FROM seal WHERE ordinal = 2",
            &["number 2", "run {1} was finished and has no seal"],
        ),
        (
            "DELETE FROM seal WHERE ordinal < 3",
            &["number 1 to 2", "{0} was finished", "{1} was finished"],
        ),
        (
            "UPDATE run SET verdict = NULL WHERE seq = 2",
            &[changed, "run {1} has a seal and no verdict"],
        ),
    ];
    for (sql, expected) in cases {
        let dir = tempdir().expect("a directory");
        let path = dir.path().join("a.db");
        let store = open(&path);
        let runs = three_runs(&store);
        assert_eq!(problems(&store), []);
        assert_eq!(store.check().expect("checked").runs, 3);
        by_hand(&path, sql);
        let found: Vec<_> = problems(&store)
            .into_iter()
            .filter(|problem| problem.kind == "seal")
            .collect();
        let expected: Vec<_> = expected
            .iter()
            .map(|text| {
                (0..3).fold((*text).to_owned(), |text, n| {
                    text.replace(&format!("{{{n}}}"), &runs[n].to_string())
                })
            })
            .collect();
        assert_eq!(found.len(), expected.len(), "{sql}: {found:?}");
        for (problem, expected) in found.iter().zip(&expected) {
            assert!(problem.detail.contains(expected), "{sql}: {found:?}");
            assert!(!problem.advice.is_empty());
        }
    }
}

/// Goal: a count, a sum, a repair or a note's words that are not what the rows say are found without
/// anything being written, and made anew from them.
#[test]
fn what_follows_from_other_rows_is_held_against_them_and_made_anew() {
    for (sql, kind, expected) in [
        (
            "UPDATE tally SET seen = seen + 1 WHERE dim = 1 AND grain = 1",
            "tally",
            "counts by day or month",
        ),
        (
            "UPDATE tally SET units = x'' WHERE dim = 0",
            "tally",
            "counts by day or month",
        ),
        ("DELETE FROM tally", "tally", "counts by day or month"),
        (
            "DROP TRIGGER repair_known_better; UPDATE repair SET opened_at_us = 5",
            "tally",
            "1 rows of the table of repairs",
        ),
        (
            "DROP TRIGGER repair_known_better; UPDATE repair SET back_at_us = 5",
            "tally",
            "rows of the table of repairs",
        ),
        (
            "UPDATE measured_day SET x = x * 1.0001",
            "tally",
            "sums of measured values by day",
        ),
        (
            "UPDATE measured_day SET most = 7",
            "tally",
            "sums of measured values by day",
        ),
        (
            "UPDATE measured_month SET tx = tx * 1.0001",
            "tally",
            "sums of measured values by month",
        ),
        (
            "DELETE FROM measured_month",
            "tally",
            "1 sums of measured values by month",
        ),
        (
            "INSERT INTO event_words(event_words) VALUES ('delete-all')",
            "tally",
            "1 notes on faults",
        ),
        (
            "UPDATE fault SET occurrences = 9 WHERE code = 1",
            "count",
            "says 9 occurrences, has 1",
        ),
    ] {
        let dir = tempdir().expect("a directory");
        let path = dir.path().join("a.db");
        let store = open(&path);
        three_runs(&store);
        by_hand(&path, sql);
        let reader = Store::open_read_only(&path).expect("opens");
        let found = problems(&reader);
        let [problem] = &found[..] else {
            panic!("{sql}: {found:?}");
        };
        assert!(
            problem.kind == kind && problem.detail.contains(expected),
            "{sql}: {found:?}"
        );
        assert!(problem.advice.contains("db rebuild"), "{problem:?}");
        store.rebuild().expect("made anew");
        assert_eq!(problems(&store), [], "{sql}");
    }
}

/// A file full of the same mistake is told of in as many lines as a person reads.
#[test]
fn a_hundred_findings_of_a_kind_are_enough() {
    let dir = tempdir().expect("a directory");
    let path = dir.path().join("a.db");
    let store = open(&path);
    store
        .together(|| {
            for _ in 0..120 {
                RunWriter::begin(&store, &run_record("ATC-7"))?.finish(&end(Verdict::Passed))?;
            }
            Ok(())
        })
        .expect("recorded");
    by_hand(&path, "UPDATE run SET operator = 'lee'");
    let found = problems(&store);
    assert_eq!(found.len(), 101);
    assert_eq!(found[100].detail, "and 20 more of this kind");
}

/// Goal: writes that are committed together are all there or none is, and one that fails within is taken
/// back alone.
#[test]
fn writes_together_are_all_or_nothing() {
    let dir = tempdir().expect("a directory");
    let store = open(&dir.path().join("a.db"));
    let count = |store: &Store| {
        let runs = store.runs(&fault_db::RunFilter::default(), &|_| false);
        runs.expect("listed").len()
    };
    let failed = store.together(|| {
        three_runs(&store);
        assert_eq!(count(&store), 3, "seen within");
        store.resolve_run("nonsense")
    });
    failed.expect_err("nothing of it");
    assert_eq!(count(&store), 0);
    store
        .together(|| {
            three_runs(&store);
            let nobody = Id::from_bytes([7; 16]);
            store
                .add_note(nobody, "kim", "", T0_US)
                .expect_err("no such fault");
            Ok(())
        })
        .expect("the rest goes on");
    assert_eq!(count(&store), 3);
    assert_eq!(problems(&store), []);
}
