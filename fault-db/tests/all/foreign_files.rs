//! Files of somebody else, as data: what holds what no history holds, or does not fit its seal, is named and
//! left out, and the rest comes.

use crate::common::{
    Deeds, T0_US, Traces, change, end, fault, measured_step, open_as, realistic_trace, refused,
    repair_of, rows, run_record, tells,
};
use fault_db::{Id, MergeCounts, RecordingRecord, RunWriter, Store, StoreError, Verdict};
use tempfile::tempdir;

/// A run of all there is: steps, values, a fault with a trace and its recording, events and a note.
fn whole_run(store: &Store, serial: &str) -> Id {
    let mut writer = RunWriter::begin(store, &run_record(serial)).expect("begun");
    writer.step(measured_step(0)).expect("kept");
    let stored = writer.fault(&fault(101, T0_US)).expect("stored");
    let trace = writer.put_trace(&[stored.occurrence], &realistic_trace(60, 1));
    let recording = RecordingRecord {
        ordinal: 0,
        procedure: "atp.overspeed".to_owned(),
        t0_bench_us: 0,
        bench_json: "{}".to_owned(),
        stimuli_json: "[]".to_owned(),
    };
    writer.recording(&recording, &[trace]).expect("a recording");
    writer.finish(&end(Verdict::Failed)).expect("finished");
    let repair = repair_of("relay", "", "", "");
    store.put_repair(stored.fault, &repair, "kim", T0_US + 1);
    let run = store.resolve_run("latest").expect("the run");
    store.put_run_note(run, "kim", "noted", T0_US + 2);
    run
}

/// The rows of the bad unit.
const BAD: &str = "(SELECT seq FROM run WHERE unit = (SELECT seq FROM unit WHERE serial = 'BAD'))";
const BAD_FAULT: &str =
    "(SELECT seq FROM fault WHERE unit = (SELECT seq FROM unit WHERE serial = 'BAD'))";

/// Goal: each kind of invalid row is reported and left out with the rows that depend on it, and no others are.
#[test]
fn an_invalid_row_is_reported_and_all_others_are_merged() {
    let dir = tempdir().expect("a directory");
    let source = dir.path().join("source.db");
    let theirs = open_as(&source, 1);
    whole_run(&theirs, "GOOD");
    whole_run(&theirs, "BAD");
    theirs.close().expect("closed");
    let poisoned = rows(include_str!("foreign_files.txt"));
    for (number, [expected, words, sql]) in poisoned.enumerate() {
        let foreign = dir.path().join(format!("{number}.db"));
        std::fs::copy(&source, &foreign).expect("copied");
        change(
            &foreign,
            &sql.replace("{run}", BAD).replace("{fault}", BAD_FAULT),
        );
        let ours = open_as(
            &dir.path().join(format!("ours{number}.db")),
            100 + number as u64,
        );
        let counts = ours
            .import(&foreign)
            .unwrap_or_else(|error| panic!("{sql}: {error}"));
        let named: Vec<_> = (counts.refused.named.iter())
            .map(|one| format!("{}: {}", one.what, one.reason))
            .collect();
        assert!(
            named.iter().any(|one| one.contains(words)),
            "{sql}: {named:?}"
        );
        let came = [counts.runs, counts.traces, counts.events, counts.notes];
        let came = came.map(|count| count.to_string()).join(" ");
        assert_eq!(came, expected, "{sql}: {named:?}");
        // A trace that its run's seal names and that did not come is missing.
        let problems = || ours.check().expect("a check").problems.into_iter();
        let missing = "no seal says that it was pruned";
        let other: Vec<_> = problems()
            .filter(|one| !one.detail.to_string().contains(missing))
            .collect();
        assert_eq!(other, [], "{sql}");
        // Again it is the same, and nothing is added.
        let again = ours
            .import(&foreign)
            .unwrap_or_else(|error| panic!("{sql}: {error}"));
        assert_eq!((again.runs, again.events), (0, 0), "{sql}");
        // The good file brings what is missing.
        let rest = ours.import(&source).expect("the good file");
        assert_eq!(rest.refused, fault_db::Refusals::default(), "{sql}");
        assert_eq!(counts.runs + rest.runs, 2, "{sql}");
        assert_eq!(problems().collect::<Vec<_>>(), [], "{sql}");
    }
}

/// Goal: a person is told why a trace of a run that came is not there, and what brings it. Method: a damaged trace, then
/// the good file.
#[test]
fn a_trace_that_an_import_refused_is_told_until_a_good_file_brings_it() {
    let dir = tempdir().expect("a directory");
    let (source, damaged) = (dir.path().join("source.db"), dir.path().join("damaged.db"));
    let theirs = open_as(&source, 1);
    let run = whole_run(&theirs, "BAD");
    let trace = theirs.resolve_trace("latest").expect("its trace");
    theirs.close().expect("closed");
    std::fs::copy(&source, &damaged).expect("copied");
    change(&damaged, "UPDATE trace SET t0_us = t0_us + 1");
    let ours = open_as(&dir.path().join("ours.db"), 2);
    assert_eq!(ours.import(&damaged).expect("imported").refused.count, 1);
    let problems = ours.check().expect("a check").problems;
    let [problem] = &problems[..] else {
        panic!("{problems:?}")
    };
    let name = trace.to_string();
    for words in [&name[..], "refused", "import a whole copy"] {
        assert!(tells(problem, words), "{}", problem.detail);
    }
    for asked in [&name, &trace.short(), &name[..13]] {
        refused!(ours.resolve_trace(asked), _, "refused", &run.to_string());
    }
    refused!(ours.resolve_trace("ffffffff"), StoreError::NotFound { .. });
    assert_eq!(ours.import(&source).expect("the good file").traces, 1);
    assert_eq!(ours.resolve_trace(&trace.short()).expect("here"), trace);
    assert_eq!(ours.check().expect("a check").problems, []);
}

/// Goal: nothing is sealed here that was not sealed there.
#[test]
fn runs_without_seals_are_not_merged() {
    let dir = tempdir().expect("a directory");
    let source = dir.path().join("source.db");
    let theirs = open_as(&source, 1);
    let run = whole_run(&theirs, "GOOD");
    theirs.close().expect("closed");
    change(&source, "DELETE FROM seal");
    let ours = open_as(&dir.path().join("ours.db"), 2);
    let counts = ours.import(&source).expect("merged");
    assert_eq!((counts.runs, counts.faults, counts.events), (0, 0, 0));
    let named: Vec<_> = counts
        .refused
        .named
        .iter()
        .map(|one| one.what.clone())
        .collect();
    assert_eq!(named, [format!("run {run}")]);
}

/// Goal: what is read of a foreign file are its rows, whatever else it holds.
/// Method: a view that never ends stands in the place of a table; a trigger waits in it.
#[test]
fn a_view_in_the_place_of_a_table_is_refused_at_once() {
    let dir = tempdir().expect("a directory");
    for (number, sql) in [
        "DROP TABLE run_note; CREATE VIEW run_note AS WITH RECURSIVE n(id, run, at_us, who, text) AS
            (SELECT 1, 1, 1, '', '' UNION ALL SELECT id + 1, 1, 1, '', '' FROM n) SELECT * FROM n",
        "CREATE TRIGGER planted AFTER INSERT ON run BEGIN UPDATE run SET verdict = 'passed'; END",
        "CREATE TABLE mine(a)",
    ]
    .into_iter()
    .enumerate()
    {
        let source = dir.path().join(format!("{number}.db"));
        let theirs = open_as(&source, 1);
        whole_run(&theirs, "GOOD");
        theirs.close().expect("closed");
        change(&source, sql);
        let ours = open_as(&dir.path().join(format!("ours{number}.db")), 2);
        let begun = std::time::Instant::now();
        refused!(ours.import(&source), _, &format!("{number}.db"));
        assert!(begun.elapsed().as_secs() < 10, "{sql}");
        assert_eq!(ours.merge_from(&open_as(&dir.path().join("empty.db"), 3)).expect("merged"), MergeCounts::default());
    }
}
