//! Changes by hand are found and named, whatever was changed; derived rows are made anew.

use std::path::Path;

use crate::common::{
    Deeds, T0_US, Traces, change, end, failed_run, fault, ids, measured_step, new_history, open,
    problems, refused, repair_of, rows, run_record, step, tells, with,
};
use fault_db::{
    FaultFilter, FaultState, Id, OpenOptions, Problem, PruneRule, RunWriter, Store, StoreError,
    Verdict,
};
use rusqlite::Connection;
use tempfile::tempdir;

/// Three runs, each with a step, a measurement and a fault; one repair, one note.
pub fn three_runs(store: &Store) -> Vec<Id> {
    let mut runs = Vec::new();
    for n in 0..3 {
        let seen = [fault(n, T0_US)];
        let (run, seen) = failed_run(store, &run_record("ATC-7"), &[measured_step(0)], &seen);
        if n == 0 {
            let repair = repair_of("eb_relay", "SN-1", "SN-2", "replaced");
            let at_us = T0_US + 60;
            store.put_repair(seen[0], &repair, "kim", at_us);
        }
        runs.push(run);
    }
    runs
}

/// Goal: each way to make a run say something else than it did is found, and the run or seal is named.
/// Method: rows changed behind the program's back; `{1}` stands for the second run's id.
#[test]
fn every_change_to_a_run_is_detected() {
    for [sql, expected] in rows(include_str!("checking/changed_runs.txt")) {
        let (_dir, path, store) = new_history();
        let runs = three_runs(&store);
        assert_eq!(problems(&store), []);
        assert_eq!(store.check().expect("checked").runs, 3);
        change(&path, sql);
        let found: Vec<_> = problems(&store)
            .into_iter()
            .filter(|problem| problem.kind.as_str() == "seal")
            .collect();
        let expected = (0..3).fold(expected.to_owned(), |text, n| {
            text.replace(&format!("{{{n}}}"), &runs[n].to_string())
        });
        let expected: Vec<_> = expected.split("; ").collect();
        assert_eq!(found.len(), expected.len(), "{sql}: {found:?}");
        for (problem, expected) in found.iter().zip(&expected) {
            assert!(tells(problem, expected), "{sql}: {found:?}");
            assert!(!problem.advice.as_str().is_empty());
        }
    }
}

/// Goal: a count, a sum, a repair or a note's words that are not what the rows say are found without
/// anything being written, and derived from them again.
#[test]
fn derived_rows_are_checked_and_can_be_rebuilt() {
    for [sql, kind, expected] in rows(include_str!("checking/derived_rows.txt")) {
        let (_dir, path, store) = new_history();
        three_runs(&store);
        change(&path, sql);
        let reader = Store::open_read_only(&path).expect("opens");
        let found = problems(&reader);
        let [problem] = &found[..] else {
            panic!("{sql}: {found:?}");
        };
        let is_named = problem.kind.as_str() == kind && tells(problem, expected);
        assert!(is_named, "{sql}: {found:?}");
        let advice = problem.advice.as_str();
        assert!(advice.contains("db rebuild"), "{problem:?}");
        store.rebuild(T0_US).expect("made anew");
        let [left] = &problems(&store)[..] else {
            panic!("{sql}: what differed stays on record");
        };
        let told = left.detail.to_string();
        let when = "counted again at 2026-03-01 00:00:00 UTC; before, ";
        assert!(told.starts_with(when), "{sql}: {told}");
        assert!(kind == "count" || told.contains(expected), "{sql}: {told}");
        assert_eq!(store.rebuild(T0_US).expect("again"), [""; 0]);
    }
}

/// A file with the same error everywhere gives a limited number of findings.
#[test]
fn at_most_a_hundred_findings_of_a_kind_are_listed() {
    let (_dir, path, store) = new_history();
    store
        .transaction(|| {
            for _ in 0..120 {
                RunWriter::begin(&store, &run_record("ATC-7"))?.finish(&end(Verdict::Passed))?;
            }
            Ok(())
        })
        .expect("recorded");
    change(&path, "UPDATE run SET operator = 'lee'");
    let found = problems(&store);
    assert_eq!(found.len(), 101);
    assert_eq!(found[100].detail.to_string(), "and 20 more of this kind");
}

/// A file with a little of everything, with its path.
fn a_little_of_everything(dir: &Path) -> (std::path::PathBuf, Store, Vec<Id>) {
    let path = dir.join("a.db");
    let store = open(&path);
    let mut runs = three_runs(&store);
    let at_us = T0_US + 70;
    store.put_run_note(runs[1], "kim", "door 3 rattles", at_us);
    let mut writer = RunWriter::begin(&store, &run_record("ATC-8")).expect("begun");
    let stored = writer.fault(&fault(9, T0_US)).expect("stored");
    let samples = crate::common::realistic_trace(40, 3);
    let trace = writer.put_trace(&[stored.occurrence], &samples);
    let recording = fault_db::RecordingRecord {
        ordinal: 1,
        procedure: "atp.overspeed".to_owned(),
        t0_bench_us: 0,
        bench_json: "{}".to_owned(),
        stimuli_json: "[]".to_owned(),
    };
    writer.recording(&recording, &[trace]).expect("stored");
    writer.finish(&end(Verdict::Failed)).expect("finished");
    runs.push(writer.id());
    drop(writer);
    let acknowledged = store.acknowledge(stored.fault, "lee", "", T0_US + 80);
    acknowledged.expect("acknowledged");
    assert_eq!(problems(&store), []);
    (path, store, runs)
}

/// Goal: whatever a row says, a change of it is found, and no `rebuild` takes the finding away.
#[test]
fn every_row_that_says_something_is_covered() {
    for [sql, expected] in rows(include_str!("checking/covered_rows.txt")) {
        let dir = tempdir().expect("a directory");
        let (path, store, _) = a_little_of_everything(dir.path());
        change(&path, sql);
        let all = problems(&store);
        let named = |all: &[Problem]| all.iter().any(|found| tells(found, expected));
        assert!(named(&all), "{sql}: {all:#?}");
        store.rebuild(T0_US).expect("counted again");
        let stays = store.check().expect("checked");
        let told = (stays.problems.iter()).any(|found| tells(found, "counted again at"));
        assert!(named(&stays.problems) || told, "{sql}: {stays:#?}");
    }
}

/// Goal: a trigger that somebody planted is named and nothing is written to its file, which can still be read.
#[test]
fn a_planted_trigger_is_refused_by_name() {
    for (sql, what) in [
        (
            "CREATE TRIGGER better AFTER UPDATE OF verdict ON run WHEN NEW.verdict = 'failed'
             BEGIN UPDATE run SET verdict = 'passed' WHERE seq = NEW.seq; END",
            "the trigger \"better\" on run is not of this program",
        ),
        (
            "DROP TRIGGER event_said",
            "the trigger \"event_said\" is missing",
        ),
        (
            "DROP VIEW runs; CREATE VIEW runs AS SELECT 1 AS id",
            "the view \"runs\" is not as this program made it",
        ),
        (
            "CREATE INDEX mine ON run(operator)",
            "the index \"mine\" on run is not of this program",
        ),
    ] {
        let dir = tempdir().expect("a directory");
        let (path, store, runs) = a_little_of_everything(dir.path());
        store.close().expect("closed");
        let conn = Connection::open(&path).expect("opens");
        conn.execute_batch(sql).expect("planted");
        drop(conn);
        let options = OpenOptions::new(ids(2));
        refused!(
            Store::open(&path, options),
            StoreError::Altered { .. },
            what
        );
        let reader = Store::open_read_only(&path).expect("opens");
        let [foreign] = &reader.foreign_objects().expect("looked at")[..] else {
            panic!("one");
        };
        assert_eq!(foreign.to_string(), what);
        reader.run(runs[0]).expect("read");
        let found = problems(&reader);
        assert_eq!(found[0].kind.as_str(), "schema");
        assert_eq!(found[0].detail.to_string(), what);
    }
}

/// Goal: a trigger planted while a run is under way gets nothing sealed but what was recorded.
#[test]
fn the_seal_covers_the_recorded_values_not_those_changed_by_a_trigger() {
    let (_dir, path, store) = new_history();
    let mut writer = RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
    writer.step(step(0)).expect("kept");
    let planted = "CREATE TRIGGER better AFTER UPDATE OF verdict ON run WHEN NEW.verdict = 'failed'
        BEGIN UPDATE run SET verdict = 'passed' WHERE seq = NEW.seq; END;
        CREATE TRIGGER best AFTER INSERT ON step
        BEGIN UPDATE step SET message = 'fine' WHERE run = NEW.run; END";
    let conn = Connection::open(&path).expect("opens");
    conn.execute_batch(planted).expect("planted");
    writer.finish(&end(Verdict::Failed)).expect("finished");
    let run = writer.id();
    let told = store.run(run).expect("there").run.verdict;
    assert_eq!(told, Some(Verdict::Passed), "the trigger's work");
    let found = problems(&store);
    let changed = format!("run {run} was changed after it was sealed");
    assert!(
        found.iter().any(|found| tells(found, &changed)),
        "{found:#?}"
    );
    let dropped = conn.execute_batch("DROP TRIGGER better; DROP TRIGGER best");
    dropped.expect("gone");
    let found = problems(&store);
    assert_eq!(found.len(), 1, "{found:#?}");
    assert_eq!(found[0].detail.to_string(), changed);
}

/// Goal: removed seals never let a file begin a new chain, by any command.
#[test]
fn no_command_makes_seals_that_were_taken_out() {
    let dir = tempdir().expect("a directory");
    let (path, store, runs) = a_little_of_everything(dir.path());
    store.close().expect("closed");
    change(
        &path,
        "DELETE FROM seal; UPDATE run SET verdict = 'passed' WHERE seq = 1",
    );
    let store = open(&path);
    store.rebuild(T0_US).expect("counted again");
    store.close().expect("closed");
    let store = open(&path);
    let found = problems(&store);
    let named = |text: &str| found.iter().filter(|found| tells(found, text)).count();
    let unsealed = named("was finished and has no seal");
    assert_eq!(unsealed, runs.len(), "{found:#?}");
    let unbegun = named("the beginning of this file's own chain");
    assert_eq!(unbegun, 1, "{found:#?}");
    change(&path, "DELETE FROM about");
    drop(store);
    let options = OpenOptions::new(ids(2));
    refused!(Store::open(&path, options), _, "own name was taken out");
}

/// Goal: traces that were pruned are told as pruned, with what they were, and one that merely went is not.
#[test]
fn a_pruned_trace_leaves_a_seal_of_its_deletion() {
    let dir = tempdir().expect("a directory");
    let (path, store, runs) = a_little_of_everything(dir.path());
    for fault in store.faults(&FaultFilter::default()).expect("listed") {
        let _ = store.set_state(fault.id, FaultState::Closed, "kim", "", T0_US + 99);
    }
    let rule = with(|it: &mut PruneRule| it.at_us = T0_US + 100);
    let counts = store.prune(&rule).expect("pruned");
    assert_eq!((counts.traces, counts.recordings), (1, 1));
    assert_eq!(problems(&store), []);
    let conn = Connection::open(&path).expect("opens");
    let says = "SELECT says FROM seal WHERE what = 'pruned' ORDER BY ordinal";
    let mut select = conn.prepare(says).expect("a question");
    let says = select.query_map([], |row| row.get(0)).expect("asked");
    let says: Vec<String> = says.collect::<Result<_, _>>().expect("read");
    assert_eq!(says.len(), 2, "{says:?}");
    for said in says {
        assert!(said.contains(&runs[3].to_string()), "{said}");
        assert!(said.contains(&(T0_US + 100).to_string()), "{said}");
    }
    change(&path, "DELETE FROM seal WHERE what = 'pruned'");
    assert!(problems(&store).len() >= 2, "gaps, and two that are gone");
}
