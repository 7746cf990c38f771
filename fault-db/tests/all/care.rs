//! Looking after files: what is damaged is found, copies are whole, merges add nothing twice.

use std::path::Path;

use crate::common::{
    Deeds, T0_US, Traces, end, fault, ids, kinds, measured_step, new_history, open, problems,
    realistic_trace, refused, run_record, tells,
};
use fault_db::{
    FaultFilter, FaultState, FaultStored, Id, OpenOptions, PruneRule, RunState, RunWriter, Store,
    StoreError, Verdict,
};
use rusqlite::Connection;
use tempfile::tempdir;

/// A run of one step, one fault and its trace.
pub fn one_run(store: &Store, serial: &str, code: i64) -> (Id, FaultStored, Id) {
    let mut writer = RunWriter::begin(store, &run_record(serial)).expect("begun");
    writer.step(measured_step(0)).expect("kept");
    let stored = writer.fault(&fault(code, T0_US)).expect("stored");
    let trace = writer.put_trace(&[stored.occurrence], &realistic_trace(600, 3));
    writer.finish(&end(Verdict::Failed)).expect("finished");
    (writer.id(), stored, trace)
}

pub fn close_fault(store: &Store, fault: Id) {
    store.put_state(fault, FaultState::Closed, "kim", "", T0_US + 50);
}

#[test]
fn check_finds_a_flipped_bit_in_a_trace_and_a_lost_row() {
    let (_dir, path, store) = new_history();
    let (_, stored, trace) = one_run(&store, "ATC-7", 1);
    let report = store.check().expect("checked");
    assert_eq!((report.traces, report.problems), (1, vec![]));
    let other = Connection::open(&path).expect("opens");
    other
        .execute_batch(
            "PRAGMA foreign_keys = OFF;
             UPDATE trace SET data = CAST(substr(data, 1, 99) || x'00' || substr(data, 101) AS BLOB);
             DELETE FROM fault_event; DELETE FROM fault",
        )
        .expect("damaged");
    let found = problems(&store);
    assert_eq!(kinds(&found), ["foreign_key", "trace", "seal"]);
    assert!(tells(&found[1], &trace.to_string()), "{found:?}");
    assert!(matches!(store.trace(trace), Err(StoreError::Trace { .. })));
    assert!(matches!(
        store.fault(stored.fault),
        Err(StoreError::NotFound { .. })
    ));
}

/// Goal: of programs that copy to one place at once one does, and the others are told; none spoils its copy.
#[test]
fn of_two_backups_to_one_path_one_is_made() {
    let dir = tempdir().expect("a directory");
    let path = dir.path().join("a.db");
    let (_, _, trace) = one_run(&open(&path), "ATC-7", 1);
    for round in 0..10 {
        let to = dir.path().join(format!("{round}.db"));
        let both = std::thread::scope(|scope| {
            let backup = || Store::open_read_only(&path).expect("ours").backup(&to);
            let threads = [(); 3].map(|()| scope.spawn(backup));
            threads.map(|thread| thread.join().expect("no panic"))
        });
        let made = both.iter().filter(|made| made.is_ok()).count();
        assert_eq!(made, 1, "{both:?}");
        for refused in both.into_iter().filter_map(Result::err) {
            assert!(matches!(refused, StoreError::TargetExists(_)), "{refused}");
        }
        let copy = Store::open_read_only(&to).expect("one of ours");
        assert_eq!(problems(&copy), []);
        copy.trace(trace).expect("there");
    }
    assert_eq!(parts(dir.path()), [""; 0]);
}

/// Names of copies that are not whole.
fn parts(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("read");
    let names = entries.map(|entry| entry.expect("an entry").file_name());
    let names = names.map(|name| name.to_string_lossy().into_owned());
    let mut parts: Vec<_> = names.filter(|name| name.ends_with(".part")).collect();
    parts.sort();
    parts
}

/// Goal: a backup made while another program records is whole, and can be gone on with like the file
/// itself: its schema, its search words, its way of giving back room.
#[test]
fn a_backup_made_while_others_write_can_be_used_as_a_database() {
    let (dir, path, store) = new_history();
    let (_, stored, _) = one_run(&store, "ATC-7", 1);
    store.put_note(stored.fault, "kim", "커넥터 재체결", T0_US);
    let stop = std::sync::atomic::AtomicBool::new(false);
    let copies: Vec<_> = (0..5).map(|n| dir.path().join(format!("{n}.db"))).collect();
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let store = Store::open(&path, OpenOptions::new(ids(9))).expect("opens");
            for code in 0.. {
                if stop.load(std::sync::atomic::Ordering::Relaxed) {
                    break;
                }
                one_run(&store, "ATC-8", code);
            }
        });
        let reader = Store::open_read_only(&path).expect("opens");
        for copy in &copies {
            reader.backup(copy).expect("copied");
        }
        stop.store(true, std::sync::atomic::Ordering::Relaxed);
    });
    for path in &copies {
        let copy = Store::open(path, OpenOptions::new(ids(10))).expect("one of ours");
        one_run(&copy, "ATC-9", 3);
        assert_eq!(problems(&copy), []);
        let conn = Connection::open(path).expect("opens");
        let one = |sql: &str| {
            conn.query_row(sql, [], |row| row.get::<_, i64>(0))
                .expect(sql)
        };
        assert_eq!(
            one("PRAGMA user_version"),
            i64::from(fault_db::SCHEMA_VERSION)
        );
        assert_eq!(one("PRAGMA auto_vacuum"), 2, "incremental");
        let found = "SELECT count(*) FROM event_words WHERE event_words MATCH '\"체 결\"'";
        assert_eq!(one(found), 1);
    }
    assert_eq!(parts(dir.path()), [""; 0], "nothing half done is left");
}

#[test]
fn prune_takes_old_traces_of_closed_faults_only_and_shrinks_the_file() {
    let (_dir, _, store) = new_history();
    let (_, closed, gone) = one_run(&store, "ATC-7", 1);
    let (_, _, kept) = one_run(&store, "ATC-7", 2);
    let mut writer = RunWriter::begin(&store, &run_record("ATC-9")).expect("begun");
    for seed in 0..200 {
        writer.put_trace(&[], &realistic_trace(600, seed));
    }
    writer.finish(&end(Verdict::Passed)).expect("finished");
    close_fault(&store, closed.fault);
    let prune = |older_than_us, dry_run| {
        store
            .prune(&PruneRule {
                older_than_us: Some(older_than_us),
                dry_run,
                ..PruneRule::default()
            })
            .expect("pruned")
    };
    assert_eq!(prune(T0_US, false).traces, 0, "none is that old");
    let planned = prune(T0_US + 1, true);
    assert_eq!(
        (planned.traces, planned.kept_for_faults, planned.freed_bytes),
        (201, 1, 0)
    );
    let done = prune(T0_US + 1, false);
    assert_eq!((done.traces, done.trace_bytes), (201, planned.trace_bytes));
    assert!(
        done.freed_bytes > done.trace_bytes / 2,
        "{done:?}: stepped to the end"
    );
    assert!(matches!(
        store.trace(gone),
        Err(StoreError::NotFound { .. })
    ));
    store.trace(kept).expect("there");
    assert_eq!(
        store.faults(&FaultFilter::default()).expect("listed").len(),
        2,
        "faults stay"
    );
    assert_eq!(
        store.fault(closed.fault).expect("stays").fault.trace_id,
        None
    );
    assert_eq!(problems(&store), []);
}

#[test]
fn importing_twice_adds_nothing_twice() {
    let dir = tempdir().expect("a directory");
    let path = |name: &str| dir.path().join(name);
    let theirs = Store::open(&path("b.db"), OpenOptions::new(ids(2))).expect("opens");
    let (run, stored, trace) = one_run(&theirs, "ATC-8", 1);
    let ours = open(&path("a.db"));
    one_run(&ours, "ATC-7", 1);
    let first = ours.import(&path("b.db")).expect("merged");
    assert_eq!(
        (first.units, first.runs, first.steps, first.measurements),
        (1, 1, 1, 1)
    );
    assert_eq!(
        (first.faults, first.occurrences, first.events, first.traces),
        (1, 1, 1, 1)
    );
    let second = ours.import(&path("b.db")).expect("merged");
    assert_eq!(second, fault_db::MergeCounts::default());
    let detail = |store: &Store| store.run(run).expect("there");
    assert_eq!(detail(&ours), detail(&theirs));
    assert_eq!(
        ours.fault(stored.fault).expect("there"),
        theirs.fault(stored.fault).expect("there")
    );
    assert_eq!(
        ours.trace(trace).expect("there"),
        theirs.trace(trace).expect("there")
    );
    assert_eq!(problems(&ours), []);
    let exported = path("c.db");
    let counts = ours
        .export(&exported, OpenOptions::new(ids(3)))
        .expect("exported");
    assert_eq!((counts.runs, counts.faults, counts.traces), (2, 2, 2));
    refused!(ours.import(&path("a.db")), StoreError::SameFile(_));
}

/// Goal: a copy taken in mid-run is completed by a later one, and the state with the latest event
/// wins, whichever file is merged into which.
#[test]
fn later_copies_complete_earlier_ones() {
    let dir = tempdir().expect("a directory");
    let ours = open(&dir.path().join("a.db"));
    let theirs = Store::open(&dir.path().join("b.db"), OpenOptions::new(ids(2))).expect("opens");
    let mut writer = RunWriter::begin(&theirs, &run_record("ATC-7")).expect("begun");
    let stored = writer.fault(&fault(1, T0_US)).expect("stored");
    ours.merge_from(&theirs).expect("merged");
    let run = |store: &Store| store.run(writer.id()).expect("there").run;
    assert_eq!(run(&ours).state, RunState::Interrupted);

    ours.put_acknowledged(stored.fault, "lee", "", T0_US + 20);
    let id = writer.id();
    let trace = writer.put_trace(&[stored.occurrence], &realistic_trace(20, 1));
    writer.finish(&end(Verdict::Failed)).expect("finished");
    theirs.put_note(stored.fault, "kim", "seen before", T0_US + 10);
    ours.merge_from(&theirs).expect("merged");
    theirs.merge_from(&ours).expect("and back");
    for store in [&ours, &theirs] {
        assert_eq!(
            store.run(id).expect("there").run.verdict,
            Some(Verdict::Failed)
        );
        let detail = store.fault(stored.fault).expect("there");
        assert_eq!(detail.fault.state, FaultState::Acknowledged);
        assert_eq!(detail.fault.trace_id, Some(trace));
        assert_eq!(detail.events.len(), 3);
    }
}

/// Goal: who stops work on a file finds it as it was. Method: an import, a backup and a check are stopped at once, and done
/// again when nobody stops them.
#[test]
fn work_that_is_stopped_leaves_nothing_behind() {
    let dir = tempdir().expect("a directory");
    let ours = open(&dir.path().join("a.db"));
    let from = dir.path().join("b.db");
    let theirs = Store::open(&from, OpenOptions::new(ids(2))).expect("opens");
    one_run(&ours, "ATC-7", 1);
    one_run(&theirs, "ATC-8", 1);
    theirs.close().expect("closed");
    let to = dir.path().join("copy.db");
    ours.stop_when(|| true).expect("taken");
    assert!(matches!(ours.import(&from), Err(StoreError::Stopped)));
    assert!(matches!(ours.backup(&to), Err(StoreError::Stopped)));
    assert!(matches!(ours.check(), Err(StoreError::Stopped)));

    ours.stop_when(|| false).expect("taken");
    let left = std::fs::read_dir(dir.path()).expect("listed");
    let names = left.map(|file| file.expect("a file").file_name());
    let of_copy = names.filter(|name| name.to_string_lossy().contains("copy"));
    assert_eq!(of_copy.count(), 0, "no unfinished copy");
    let all = ours.faults(&FaultFilter::default()).expect("listed");
    assert_eq!(all.len(), 1, "nothing was imported");
    assert_eq!(ours.import(&from).expect("imported").runs, 1);
    ours.backup(&to).expect("copied");
    assert_eq!(problems(&ours), []);
}
