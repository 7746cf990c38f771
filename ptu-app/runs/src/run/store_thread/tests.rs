//! A run while another process holds the database.

use std::collections::BTreeMap;

use fault_db::{
    Channel, ChannelKind, FaultRecord, OpenOptions, StepRecord, TraceData, UnitRecord, Verdict,
};
use rusqlite::Connection;

use super::records::MOST_STEPS;
use super::*;
use crate::clock;

fn record() -> RunRecord {
    RunRecord {
        unit: UnitRecord {
            serial: "ATC-7".into(),
            kind: "ATC".into(),
            config_name: "sg100".into(),
            sw_versions: BTreeMap::new(),
        },
        line: "line8".into(),
        seed: 1,
        source: "sim".into(),
        started_at_us: 0,
        ..RunRecord::default()
    }
}

fn step(index: u32) -> StepRecord {
    StepRecord::passed(index, "atp/overspeed", format!("step {index}"))
}

fn fault() -> FaultRecord {
    FaultRecord {
        code: 231,
        code_name: "eb_relay_open".into(),
        lru: "eb_relay".into(),
        severity: "major".into(),
        at_us: 1,
        bench_us: 1,
        step_index: Some(1),
        findings: None,
        message: "late".into(),
        freeze: Vec::new(),
    }
}

fn trace() -> TraceData {
    TraceData {
        period_us: 50_000,
        trigger_row: Some(1),
        channels: vec![Channel {
            name: "speed".into(),
            unit: "km/h".into(),
            kind: ChannelKind::Number { lsb: 0.1 },
        }],
        columns: vec![vec![0.0, 0.1]],
        ..TraceData::default()
    }
}

fn end(verdict: Verdict) -> RunEnd {
    RunEnd {
        verdict,
        finished_at_us: 1,
        bench_time_us: 1,
        wall_time_us: 1,
    }
}

/// A run that begins and waits so long for its file, and another program that holds the file from then on.
fn held(folder: &std::path::Path, busy_timeout: BusyTimeout) -> (RunStore, Stop, Connection) {
    let file = folder.join("history.db");
    let options = OpenOptions::new(clock::ids()).busy_timeout_ms(1);
    let store = Store::open(&file, options).expect("a database");
    let stop = Stop::default();
    let run = RunStore::begin_with(busy_timeout, store, record(), None, &stop).expect("begun");
    let other = Connection::open(&file).expect("the database");
    let wait = other.busy_timeout(Duration::from_secs(60));
    wait.expect("it waits for the writer");
    other.execute_batch("BEGIN EXCLUSIVE").expect("a lock");
    (run, stop, other)
}

/// The run has its two steps and its fault with its trace, and the file is whole.
fn has_all_of_it(store: &Store, run: fault_db::Id) {
    let found = store.run(run).expect("there");
    assert_eq!((found.steps.len(), found.faults.len()), (2, 1));
    assert_eq!(found.run.verdict, Some(Verdict::Error));
    assert!(found.faults[0].trace_id.is_some());
    assert_eq!(store.check().expect("checked").problems, []);
}

/// Goal: another program that holds the file for longer than it may when it is opened costs a run nothing.
#[test]
fn a_run_under_way_waits_for_another_writer() {
    let folder = tempfile::tempdir().expect("a folder");
    let (run, stop, other) = held(folder.path(), BUSY_TIMEOUT);
    let id = run.id;
    let ends = std::thread::spawn(move || run.finish(end(Verdict::Passed)));
    std::thread::sleep(Duration::from_millis(300));
    other.execute_batch("ROLLBACK").expect("released");
    let (store, _) = ends.join().expect("no panic").expect("recorded");
    let found = store.run(id).expect("there").run.verdict;
    assert_eq!((found, stop.presses()), (Some(Verdict::Passed), 0));
}

/// Goal: a file that is held for long ends the run, says why, and takes all of it when it is free.
#[test]
fn a_database_busy_for_long_ends_a_run_and_takes_all_of_it_in_the_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let busy_timeout = BusyTimeout {
        stops_ms: 20,
        gives_up: Duration::from_secs(600),
    };
    let (run, stop, other) = held(folder.path(), busy_timeout);
    let id = run.id;
    run.record(Entry::Step(step(0)));
    run.record(Entry::Fault(fault()));
    while stop.presses() == 0 {
        std::thread::sleep(Duration::from_millis(5));
    }
    let reason = stop.reason().expect("a reason").to_string();
    assert!(
        reason.starts_with("database busy: ") && reason.contains("history.db is locked"),
        "{reason}"
    );
    run.record(Entry::Trace(vec![0], trace()));
    run.record(Entry::Step(step(1)));
    other.execute_batch("ROLLBACK").expect("released");
    let (store, lost) = run.finish(end(Verdict::Error)).expect("recorded");
    assert!(lost.is_none(), "{lost:?}");
    has_all_of_it(&store, id);
}

/// Goal: what a file that stays busy did not take is kept beside it, and an import brings the run together.
#[test]
fn records_that_a_busy_database_refuses_can_be_imported_later() {
    let folder = tempfile::tempdir().expect("a folder");
    let busy_timeout = BusyTimeout {
        stops_ms: 10,
        gives_up: Duration::from_millis(40),
    };
    let (run, stop, other) = held(folder.path(), busy_timeout);
    let id = run.id;
    run.record(Entry::Step(step(0)));
    run.record(Entry::Fault(fault()));
    run.record(Entry::Trace(vec![0], trace()));
    run.record(Entry::Step(step(1)));
    let failure = run.finish(end(Verdict::Error)).expect_err("busy");
    assert_eq!(stop.presses(), 1);
    let rest = folder
        .path()
        .join(format!("history.db.run-{}.db", id.short()));
    for said in [
        "database busy",
        "ptu db import",
        &rest.display().to_string(),
    ] {
        assert!(failure.to_string().contains(said), "{failure}");
    }
    other.execute_batch("ROLLBACK").expect("released");
    drop(other);
    let file = folder.path().join("history.db");
    let store = Store::open(&file, clock::open_options()).expect("free");
    store.import(&rest).expect("the rest");
    has_all_of_it(&store, id);
}

/// Goal: what a killed program leaves is all that was finished a moment ago. Method: a run that goes on, as another
/// program sees its file.
#[test]
fn a_finished_step_is_in_the_file_while_its_procedure_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("history.db");
    let store = Store::open(&file, clock::open_options()).expect("a database");
    let run = RunStore::begin(store, record(), None, &Stop::default()).expect("begun");
    run.record(Entry::Step(step(0)));
    // As long as it may take, and what a busy machine adds.
    std::thread::sleep(2 * FLUSH);
    let other = Connection::open(&file).expect("the database");
    let steps = other.query_row("SELECT count(*) FROM step", [], |row| row.get::<_, u32>(0));
    assert_eq!(steps.expect("counted"), 1);
    run.finish(end(Verdict::Passed)).expect("kept");
}

/// Goal: a run without end takes no memory without end. Method: one step more than are held.
#[test]
fn of_a_run_that_is_too_long_nothing_is_held() {
    let mut kept = RecordedIds::default();
    for index in 0..MOST_STEPS as u32 {
        kept.hold(Entry::Step(step(index)));
    }
    assert_eq!(
        (kept.is_too_long(), kept.records.len()),
        (false, MOST_STEPS)
    );
    kept.hold(Entry::Step(step(MOST_STEPS as u32)));
    kept.hold(Entry::Step(step(MOST_STEPS as u32 + 1)));
    assert_eq!((kept.is_too_long(), kept.records.len()), (true, 0));
}
