//! Looking after files: what is damaged is found, copies are whole, merges add nothing twice.

use std::path::Path;

use crate::common::{T0_US, end, fault, ids, measurement, open, realistic_trace, run_record, step};
use fault_db::{
    FaultFilter, FaultState, FaultStored, Id, OpenOptions, PruneRule, QueryBounds, QueryLimit,
    RunFilter, RunState, RunWriter, SqlValue, StatKey, StatQuery, Store, StoreError, TrendQuery,
    Verdict,
};
use rusqlite::Connection;
use tempfile::tempdir;

const NOBODY_LIVES: &dyn Fn(&str) -> bool = &|_| false;

/// A run of one step, one fault and its trace.
fn one_run(store: &Store, serial: &str, code: i64) -> (Id, FaultStored, Id) {
    let mut writer = RunWriter::begin(store, &run_record(serial)).expect("begun");
    let mut measured = step(0);
    measured.measurements = vec![measurement("eb_reaction", 0.42)];
    writer.step(measured).expect("kept");
    let stored = writer.fault(&fault(code, T0_US)).expect("stored");
    let trace = writer
        .trace(&[stored.occurrence], &realistic_trace(600, 3))
        .expect("stored");
    writer.finish(&end(Verdict::Failed)).expect("finished");
    (writer.id(), stored, trace)
}

fn close_fault(store: &Store, fault: Id) {
    store
        .set_state(fault, FaultState::Closed, "kim", "", T0_US + 50)
        .expect("closed");
}

#[test]
fn check_finds_a_flipped_bit_in_a_trace_and_a_lost_row() {
    let dir = tempdir().expect("a directory");
    let path = dir.path().join("a.db");
    let store = open(&path);
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
    let problems = store.check().expect("checked").problems;
    let kinds: Vec<_> = problems.iter().map(|problem| problem.kind).collect();
    assert_eq!(
        kinds,
        ["foreign_key", "trace", "seal", "tally"],
        "{problems:?}"
    );
    assert!(
        problems[1].detail.contains(&trace.to_string()),
        "{problems:?}"
    );
    assert!(matches!(store.trace(trace), Err(StoreError::Trace { .. })));
    assert!(matches!(
        store.fault(stored.fault),
        Err(StoreError::NotFound { .. })
    ));
}

#[test]
fn a_backup_is_complete_and_overwrites_no_file() {
    let dir = tempdir().expect("a directory");
    let store = open(&dir.path().join("a.db"));
    let (_, _, trace) = one_run(&store, "ATC-7", 1);
    let to = dir.path().join("it's a copy.db");
    store.backup(&to).expect("copied");
    let copy = Store::open_read_only(&to).expect("one of ours");
    assert_eq!(copy.check().expect("checked").problems, []);
    assert_eq!(
        copy.trace(trace).expect("there"),
        store.trace(trace).expect("there")
    );
    let error = store.backup(&to).expect_err("exists");
    assert!(matches!(error, StoreError::TargetExists { .. }), "{error}");
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
            assert!(
                matches!(refused, StoreError::TargetExists { .. }),
                "{refused}"
            );
        }
        let copy = Store::open_read_only(&to).expect("one of ours");
        assert_eq!(copy.check().expect("checked").problems, []);
        copy.trace(trace).expect("there");
    }
    assert_eq!(parts(dir.path()), [""; 0]);
}

/// Goal: what nobody works at any more goes with the next copy to the same place; what another program is at,
/// also one of another computer, whose processes are not to be seen here, and what only looks like it, stays.
#[test]
fn the_leftover_of_an_interrupted_copy_is_removed_by_the_next() {
    let dir = tempdir().expect("a directory");
    let store = open(&dir.path().join("a.db"));
    let random = "0123456789abcdef";
    let alive = std::process::id();
    let old = format!("b.db.{alive}-fedcba9876543210.part");
    let stay = [
        format!("b.db.{alive}-{random}.part"),
        // No process here has a number of more than 22 bits.
        format!("b.db.{}-{random}.part", u32::MAX),
        format!("bb.db.{}-{random}.part", u32::MAX),
        "b.db.mine.part".to_owned(),
    ];
    for name in stay.iter().chain([&old]) {
        std::fs::write(dir.path().join(name), "half").expect("written");
    }
    let hours_ago = std::time::SystemTime::now() - std::time::Duration::from_secs(7_200);
    let file = std::fs::File::options()
        .write(true)
        .open(dir.path().join(&old));
    (file.expect("there").set_modified(hours_ago)).expect("its time is set");
    store.backup(&dir.path().join("b.db")).expect("copied");
    let mut expected = stay.to_vec();
    expected.sort();
    assert_eq!(parts(dir.path()), expected);
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
    let dir = tempdir().expect("a directory");
    let path = dir.path().join("a.db");
    let store = open(&path);
    let (_, stored, _) = one_run(&store, "ATC-7", 1);
    store
        .add_note(stored.fault, "kim", "커넥터 재체결", T0_US)
        .expect("noted");
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
        assert_eq!(copy.check().expect("checked").problems, []);
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
    let dir = tempdir().expect("a directory");
    let store = open(&dir.path().join("a.db"));
    let (_, closed, gone) = one_run(&store, "ATC-7", 1);
    let (_, _, kept) = one_run(&store, "ATC-7", 2);
    let mut writer = RunWriter::begin(&store, &run_record("ATC-9")).expect("begun");
    for seed in 0..200 {
        writer
            .trace(&[], &realistic_trace(600, seed))
            .expect("a trace of a good run");
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
    store.trace(kept).expect("its fault is open");
    assert_eq!(
        store.faults(&FaultFilter::default()).expect("listed").len(),
        2,
        "faults stay"
    );
    assert_eq!(
        store.fault(closed.fault).expect("stays").fault.trace_id,
        None
    );
    assert_eq!(store.check().expect("checked").problems, []);
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
    let detail = |store: &Store| store.run(run, NOBODY_LIVES).expect("there");
    assert_eq!(detail(&ours), detail(&theirs));
    assert_eq!(
        ours.fault(stored.fault).expect("there"),
        theirs.fault(stored.fault).expect("there")
    );
    assert_eq!(
        ours.trace(trace).expect("there"),
        theirs.trace(trace).expect("there")
    );
    assert_eq!(ours.check().expect("checked").problems, []);
    let exported = path("c.db");
    let counts = ours
        .export(&exported, OpenOptions::new(ids(3)))
        .expect("exported");
    assert_eq!((counts.runs, counts.faults, counts.traces), (2, 2, 2));
    let error = ours.import(&path("a.db")).expect_err("itself");
    assert!(matches!(error, StoreError::SameFile { .. }), "{error}");
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
    let run = |store: &Store| store.run(writer.id(), NOBODY_LIVES).expect("there").run;
    assert_eq!(run(&ours).state, RunState::Interrupted);

    ours.acknowledge(stored.fault, "lee", "", T0_US + 20)
        .expect("ours to say");
    let id = writer.id();
    let trace = writer
        .trace(&[stored.occurrence], &realistic_trace(20, 1))
        .expect("stored");
    writer.finish(&end(Verdict::Failed)).expect("finished");
    theirs
        .add_note(stored.fault, "kim", "seen before", T0_US + 10)
        .expect("noted");
    ours.merge_from(&theirs).expect("merged");
    theirs.merge_from(&ours).expect("and back");
    for store in [&ours, &theirs] {
        assert_eq!(
            store.run(id, NOBODY_LIVES).expect("there").run.verdict,
            Some(Verdict::Failed)
        );
        let detail = store.fault(stored.fault).expect("there");
        assert_eq!(detail.fault.state, FaultState::Acknowledged);
        assert_eq!(detail.fault.trace_id, Some(trace));
        assert_eq!(detail.events.len(), 3);
    }
}

#[test]
fn two_laptops_that_saw_one_fault_have_one_fault() {
    let dir = tempdir().expect("a directory");
    let ours = open(&dir.path().join("a.db"));
    let theirs = Store::open(&dir.path().join("b.db"), OpenOptions::new(ids(2))).expect("opens");
    let (_, stored, _) = one_run(&ours, "ATC-7", 1);
    one_run(&theirs, "ATC-7", 1);
    for expected in [1, 0] {
        let counts = ours.merge_from(&theirs).expect("merged");
        assert_eq!((counts.faults, counts.occurrences), (0, expected));
        assert_eq!(
            ours.fault(stored.fault).expect("there").fault.occurrences,
            2
        );
    }
}

fn opened(path: &Path) -> (Store, Vec<Id>) {
    let store = open(path);
    let runs = (0..3)
        .map(|n| one_run(&store, &format!("ATC-{n}"), n).0)
        .collect();
    (store, runs)
}

#[test]
fn ids_are_found_by_beginning_end_and_latest() {
    let dir = tempdir().expect("a directory");
    let (store, runs) = opened(&dir.path().join("a.db"));
    for run in &runs {
        let text = run.to_string();
        assert_eq!(store.resolve_run(&text).ok(), Some(*run));
        assert_eq!(store.resolve_run(&text.to_uppercase()).ok(), Some(*run));
        assert_eq!(store.resolve_run(&run.short()).ok(), Some(*run));
        assert_eq!(store.resolve_run(&text[..25]).ok(), Some(*run));
    }
    assert_eq!(store.resolve_run("latest").ok(), Some(runs[2]));
    let asked = &runs[0].to_string()[..8];
    match store.resolve_run(asked) {
        Err(StoreError::Ambiguous { matches, .. }) => assert_eq!(matches, runs),
        other => panic!("{other:?}: all began in the same minute"),
    }
    assert!(matches!(
        store.resolve_run("ffffffff"),
        Err(StoreError::NotFound { .. })
    ));
    for bad in ["abc", "", "newest", "0123456789-0123456789-0123456789-abc"] {
        assert!(
            matches!(store.resolve_run(bad), Err(StoreError::BadId { .. })),
            "{bad}"
        );
    }
    let empty = open(&dir.path().join("b.db"));
    assert!(matches!(
        empty.resolve_fault("latest"),
        Err(StoreError::NotFound { .. })
    ));
}

#[test]
fn filters_stats_and_trends_answer() {
    let dir = tempdir().expect("a directory");
    let (store, runs) = opened(&dir.path().join("a.db"));
    let count = |filter: FaultFilter| store.faults(&filter).expect("listed").len();
    let some = |text: &str| Some(text.to_owned());
    assert_eq!(count(FaultFilter::default()), 3);
    assert_eq!(
        count(FaultFilter {
            unit: some("ATC-1"),
            ..Default::default()
        }),
        1
    );
    assert_eq!(
        count(FaultFilter {
            code: some("0x2"),
            ..Default::default()
        }),
        1
    );
    assert_eq!(
        count(FaultFilter {
            code: some("fault_2"),
            ..Default::default()
        }),
        1
    );
    assert_eq!(
        count(FaultFilter {
            code: some("nothing"),
            ..Default::default()
        }),
        0
    );
    assert_eq!(
        count(FaultFilter {
            lru: some("atp-rx"),
            ..Default::default()
        }),
        3
    );
    assert_eq!(
        count(FaultFilter {
            run: Some(runs[1]),
            ..Default::default()
        }),
        1
    );
    assert_eq!(
        count(FaultFilter {
            since_us: Some(T0_US + 1),
            ..Default::default()
        }),
        0
    );
    assert_eq!(
        count(FaultFilter {
            until_us: Some(T0_US + 1),
            ..Default::default()
        }),
        3
    );
    assert_eq!(
        count(FaultFilter {
            limit: Some(2),
            ..Default::default()
        }),
        2
    );
    let closed = store.faults(&FaultFilter::default()).expect("listed")[0].id;
    close_fault(&store, closed);
    assert_eq!(
        count(FaultFilter {
            states: vec![FaultState::Closed],
            ..Default::default()
        }),
        1
    );

    let stats = |by| {
        let query = StatQuery {
            by,
            filter: FaultFilter::default(),
            now_us: T0_US + 1_000,
            back_within_days: 30,
        };
        store.stats(&query).expect("counted")
    };
    let by_lru = stats(StatKey::Lru);
    assert_eq!(
        (by_lru[0].faults, by_lru[0].not_closed, by_lru[0].units),
        (3, 2, 3)
    );
    assert_eq!(stats(StatKey::Code).len(), 3);
    let filter = RunFilter {
        unit: some("ATC-2"),
        ..Default::default()
    };
    assert_eq!(
        store.runs(&filter, NOBODY_LIVES).expect("listed")[0].id,
        runs[2]
    );

    let of = |measurement: &str, unit: Option<&str>| TrendQuery {
        measurement: measurement.to_owned(),
        unit: unit.map(str::to_owned),
        ..TrendQuery::default()
    };
    let points = store.trend(&of("eb_reaction", None)).expect("known");
    assert_eq!(points.len(), 3);
    let points = store.trend(&of("eb_reaction", Some("ATC-1")));
    let points = points.expect("known");
    assert_eq!(
        (points[0].value, points[0].high, points[0].run_id),
        (Some(0.42), Some(0.5), runs[1])
    );
    let error = store.trend(&of("eb_reacton", None)).expect_err("misspelt");
    assert!(
        error.to_string().contains("no measurement \"eb_reacton\""),
        "{error}"
    );
}

#[test]
fn a_free_query_runs_within_its_limits() {
    let dir = tempdir().expect("a directory");
    let (store, _) = opened(&dir.path().join("a.db"));
    let bounds = QueryBounds {
        rows: 10,
        ..QueryBounds::default()
    };
    let endless =
        "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT count(*) FROM n";
    let mut looks = 0;
    let goes_on = move || {
        looks += 1;
        looks < 5
    };
    let limit = |error| match error {
        StoreError::QueryExceeds { limit } => limit,
        other => panic!("{other}"),
    };
    let stopped = store
        .query_within(endless, bounds, goes_on)
        .expect_err("stopped");
    assert_eq!(limit(stopped), QueryLimit::Stopped);
    let long = "SELECT zeroblob(10000000)";
    let refused = store.query_read_only(long, 10).expect_err("too long");
    assert_eq!(limit(refused), QueryLimit::Row);
    let answer = store.query_read_only(&format!("SELECT 1 UNION ALL {long}"), 10);
    let answer = answer.expect("the first row");
    assert!(answer.truncated && answer.rows == [[SqlValue::Integer(1)]]);
}

#[test]
fn free_questions_only_read() {
    let dir = tempdir().expect("a directory");
    let (store, runs) = opened(&dir.path().join("a.db"));
    let answer = store
        .query_read_only(
            "SELECT id, verdict, 1.5, NULL, seq FROM run ORDER BY seq; ",
            2,
        )
        .expect("answered");
    assert_eq!(answer.columns, ["id", "verdict", "1.5", "NULL", "seq"]);
    assert!(answer.truncated && answer.rows.len() == 2);
    let text = |text: &str| SqlValue::Text(text.to_owned());
    let first = [
        text(&runs[0].to_string()),
        text("failed"),
        SqlValue::Real(1.5),
        SqlValue::Null,
    ];
    assert_eq!(answer.rows[0][..4], first);
    let attached = dir.path().join("x.db");
    for sql in [
        "DELETE FROM run",
        "SELECT 1; DELETE FROM run",
        "SELECT 1; nonsense",
        "PRAGMA user_version = 9",
        "PRAGMA query_only = OFF",
        &format!("ATTACH '{}' AS x", attached.display()),
        "CREATE TEMP TABLE t(x)",
        "BEGIN IMMEDIATE",
        "VACUUM",
        "WITH x AS (SELECT 1) INSERT INTO unit SELECT 9, 'a', 'b', 'c', 'd'",
        "",
    ] {
        let error = store.query_read_only(sql, 10).expect_err(sql);
        assert!(
            matches!(error, StoreError::QueryRefused { .. }),
            "{sql}: {error}"
        );
    }
    assert!(!attached.exists());
    let error = store
        .query_read_only("SELECT verdct FROM run", 10)
        .expect_err("misspelt");
    assert!(
        error.to_string().contains("no such column: verdct"),
        "{error}"
    );
    assert_eq!(
        store
            .runs(&RunFilter::default(), NOBODY_LIVES)
            .expect("listed")
            .len(),
        3
    );
}
