//! Records of a run are in the file, also when the program dies, the disk fills or another run
//! writes at the same time.

use crate::checking::three_runs;
use crate::common::{
    Deeds, T0_US, Traces, end, fault, ids, measurement, new_history, open, problems,
    realistic_trace, refused, repair_of, run_record, step,
};
use fault_db::limits::{MOST_NAME, MOST_TEXT};
use fault_db::{
    FaultFilter, FaultState, OpenOptions, RunFilter, RunRecord, RunState, RunWriter, StepRecord,
    Store, StoreError, Synchronous, Verdict,
};
use tempfile::tempdir;

/// Time a store waits for other writers: a busy machine may hold one up in the middle of a commit.
const PATIENCE_MS: u32 = 30_000;

#[test]
fn a_finished_run_reads_back_as_recorded() {
    let (_dir, _, store) = new_history();
    let mut record = run_record("ATC-7");
    record.injected = Some("atp.rx.dead".to_owned());
    let mut writer = RunWriter::begin(&store, &record).expect("begun");
    let mut measured = step(1);
    measured.verdict = Verdict::Failed;
    measured.measurements = vec![
        measurement("eb_reaction", 0.42),
        measurement("none", f64::NAN),
    ];
    writer.step(step(0)).expect("kept");
    writer.step(measured).expect("kept");
    writer.finish(&end(Verdict::Failed)).expect("finished");
    refused!(writer.step(step(2)), StoreError::RunFinished(_));

    let detail = store.run(writer.id()).expect("known");
    assert_eq!(detail.run.seed, u64::MAX - 3);
    assert_eq!(detail.run.verdict, Some(Verdict::Failed));
    assert_eq!(detail.run.state, RunState::Finished);
    let recorded = &detail.run.recorded;
    assert_eq!((recorded.planned, recorded.not_passed()), (2, 1));
    assert_eq!(detail.run.injected.as_deref(), Some("atp.rx.dead"));
    assert_eq!(detail.scripts, record.scripts);
    let measured = &detail.steps[1].measurements;
    assert_eq!(measured[0].value, Some(0.42));
    assert_eq!(measured[1].value, None, "NaN is no value");
}

/// Goal: a killed program leaves an interrupted run with its fault, and one that records is not told as killed by whoever
/// cannot see its process. Method: look from a second connection, and at a copy, as which a kill leaves the file.
#[test]
fn a_killed_run_is_interrupted_and_keeps_its_fault() {
    let (dir, path, store) = new_history();
    let mut writer = RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
    writer.step(step(0)).expect("kept");
    let stored = writer.fault(&fault(17, T0_US)).expect("committed");
    writer.step(step(1)).expect("kept in memory");

    let reader = Store::open_read_only(&path).expect("readable meanwhile");
    let runs = |of: &Store| of.runs(&RunFilter::default()).expect("listed");
    assert_eq!(runs(&reader)[0].state, RunState::Running);
    #[cfg(unix)]
    {
        let lock = format!("a.db.run-{}.lock", writer.id().short());
        let lock = dir.path().join(lock);
        let about = std::fs::metadata(lock).expect("locked");
        let mode = std::os::unix::fs::PermissionsExt::mode(&about.permissions());
        assert_eq!(mode & 0o444, 0o444, "all who share the history see it");
    }
    let killed = dir.path().join("killed.db");
    for end in ["", "-wal"] {
        let name = |of: &str| dir.path().join(format!("{of}{end}"));
        std::fs::copy(name("a.db"), name("killed.db")).expect("copied");
    }
    let killed = Store::open_read_only(&killed).expect("readable");
    let run = &runs(&killed)[0];
    assert_eq!((run.state, run.verdict), (RunState::Interrupted, None));
    let recorded = (run.recorded.planned, run.faults);
    assert_eq!(recorded, (1, 1), "the fault took the waiting step along");
    drop(writer);
    assert_eq!(runs(&reader)[0].state, RunState::Interrupted);
    let detail = reader.fault(stored.fault).expect("committed");
    assert_eq!(detail.occurrences[0].freeze, fault(17, T0_US).freeze);
}

/// Goal: an early return of the caller loses no step. Method: drop without finish.
#[test]
fn a_dropped_writer_writes_its_buffered_steps() {
    let (_dir, _, store) = new_history();
    let mut writer = RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
    writer.step(step(0)).expect("kept");
    drop(writer);
    let runs = store.runs(&RunFilter::default()).expect("listed");
    let left = (runs[0].recorded.planned, runs[0].state);
    assert_eq!(left, (1, RunState::Interrupted));
}

/// Goal: two programs that start together on a new file both get it. Method: many new files, since
/// the moment that matters is short.
#[test]
fn two_programs_create_one_file_at_the_same_time() {
    let dir = tempdir().expect("a directory");
    for round in 0..40 {
        let path = dir.path().join(format!("{round}.db"));
        std::thread::scope(|scope| {
            for seed in [11, 12, 13] {
                let path = &path;
                scope.spawn(move || {
                    let options = OpenOptions::new(ids(seed)).busy_timeout_ms(PATIENCE_MS);
                    let store = Store::open(path, options).expect("opens");
                    RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
                });
            }
        });
        let runs = open(&path).runs(&RunFilter::default()).expect("listed");
        assert_eq!(runs.len(), 3, "round {round}");
    }
}

#[test]
fn two_runs_write_one_file_at_the_same_time() {
    const STEPS: u32 = 1_000;
    let dir = tempdir().expect("a directory");
    let path = dir.path().join("a.db");
    std::thread::scope(|scope| {
        for seed in [11, 12] {
            let path = &path;
            // Both create the file, too.
            scope.spawn(move || {
                let options = OpenOptions::new(ids(seed)).synchronous(Synchronous::Normal);
                let options = options.busy_timeout_ms(PATIENCE_MS);
                let store = Store::open(path, options).expect("opens");
                let serial = format!("ATC-{seed}");
                let mut writer = RunWriter::begin(&store, &run_record(&serial)).expect("begun");
                for index in 0..STEPS {
                    writer.step(step(index)).expect("written in the end");
                    if index % 100 == 0 {
                        writer.fault(&fault(5, T0_US)).expect("committed");
                    }
                }
                writer.finish(&end(Verdict::Passed)).expect("finished");
            });
        }
    });
    let store = open(&path);
    let runs = store.runs(&RunFilter::default()).expect("listed");
    let steps: Vec<_> = runs.iter().map(|run| run.recorded.planned).collect();
    assert_eq!(steps, [STEPS, STEPS]);
    let faults = store.faults(&FaultFilter::default()).expect("listed");
    let seen: Vec<_> = faults.iter().map(|fault| fault.occurrences).collect();
    assert_eq!(seen, [10, 10]);
    assert_eq!(problems(&store), []);
}

/// Goal: a full disk costs nothing that was committed, and writing goes on when there is room.
#[test]
fn a_full_disk_is_an_error_and_loses_nothing() {
    let dir = tempdir().expect("a directory");
    let path = dir.path().join("a.db");
    open(&path).close().expect("closed");
    let small = OpenOptions::new(ids(2)).max_pages(60);
    let store = Store::open(&path, small).expect("opens");
    let mut writer = RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
    let stored = writer.fault(&fault(1, T0_US)).expect("room for one");
    let mut kept = 0;
    let error = loop {
        match writer.step(step(kept)) {
            Ok(()) => kept += 1,
            Err(error) => break error,
        }
    };
    refused!(Err::<(), _>(error), StoreError::Full(_), "a.db");
    refused!(writer.finish(&end(Verdict::Passed)), StoreError::Full(_));
    let waiting = writer.waiting_steps() as u32;
    assert!(waiting > 0);
    let id = writer.id();
    drop(writer);

    let reader = Store::open_read_only(&path).expect("readable");
    assert_eq!(problems(&reader), []);
    let run = reader.run(id).expect("kept").run;
    let known = run.recorded.planned + waiting;
    assert_eq!(known, kept + 1, "each step is written or waits");
    assert_eq!(run.state, RunState::Interrupted);
    let detail = reader.fault(stored.fault).expect("kept");
    assert_eq!(detail.occurrences.len(), 1);
}

#[test]
fn step_indexes_must_rise() {
    let (_dir, _, store) = new_history();
    let mut writer = RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
    writer.step(step(4)).expect("kept");
    let again = writer.step(step(4));
    refused!(
        again,
        _,
        "step 4 recorded after step 4: step indexes must rise"
    );
}

/// The rule of one fault per unit, code and part until it is closed.
#[test]
fn occurrences_join_reopen_or_begin_a_fault() {
    let (_dir, _, store) = new_history();
    let mut writer = RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
    let first = writer.fault(&fault(17, T0_US)).expect("stored");
    assert!(first.is_new && !first.reopened);
    let second = writer.fault(&fault(17, T0_US + 9)).expect("stored");
    assert_eq!((second.fault, second.is_new), (first.fault, false));
    let mut elsewhere = fault(17, T0_US);
    elsewhere.lru = "ATP-CPU".to_owned();
    let elsewhere = writer.fault(&elsewhere).expect("stored");
    assert_ne!(elsewhere.fault, first.fault, "another part");
    let mut other = RunWriter::begin(&store, &run_record("ATC-8")).expect("begun");
    let other = other.fault(&fault(17, T0_US)).expect("stored");
    assert_ne!(other.fault, first.fault, "another unit");

    let id = first.fault;
    let repair = repair_of("ATP-RX", "1", "2", "swapped");
    let told = store.acknowledge(id, "kim", "", T0_US + 10);
    assert_eq!(told.ok(), Some(FaultState::Acknowledged));
    let still = writer.fault(&fault(17, T0_US + 11)).expect("stored");
    assert!(!still.reopened, "nobody has repaired it yet");
    let told = store.record_repair(id, &repair, "kim", T0_US + 12);
    assert_eq!(told.ok(), Some(FaultState::Repaired));
    let again = writer.fault(&fault(17, T0_US + 13)).expect("stored");
    assert_eq!((again.fault, again.reopened), (id, true));
    let detail = store.fault(id).expect("known");
    let fault_now = &detail.fault;
    assert_eq!(
        (fault_now.state, fault_now.occurrences),
        (FaultState::Open, 4)
    );
    let seen = (fault_now.first_at_us, fault_now.last_at_us);
    assert_eq!(seen, (T0_US, T0_US + 13));
    let kinds: Vec<_> = detail.events.iter().map(|event| &event.kind[..]).collect();
    assert_eq!(kinds, ["opened", "acknowledged", "repair", "recurred"]);
    assert_eq!(detail.events[2].repair, Some(repair));

    store.put_state(id, FaultState::Closed, "kim", "no fault found", T0_US + 14);
    let late = store.acknowledge(id, "kim", "", T0_US + 15);
    refused!(late, StoreError::Transition { .. });
    let new = writer.fault(&fault(17, T0_US + 16)).expect("stored");
    assert!(new.is_new && new.fault != id, "a closed fault stays closed");
}

#[test]
fn a_trace_is_shared_by_occurrences_and_read_by_channel() {
    let (_dir, _, store) = new_history();
    let mut writer = RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
    let a = writer.fault(&fault(1, T0_US)).expect("stored");
    let b = writer.fault(&fault(2, T0_US)).expect("stored");
    let mut data = realistic_trace(600, 5);
    data.columns[0][3] = f64::NAN;
    let id = writer.put_trace(&[a.occurrence, b.occurrence], &data);
    for fault in [a.fault, b.fault] {
        assert_eq!(store.fault(fault).expect("known").fault.trace_id, Some(id));
    }
    let whole = store.trace(id).expect("readable");
    assert!(whole.gaps && whole.columns[0][3].is_nan());
    assert_eq!(whole.columns[1..], data.columns[1..]);
    let two = store.trace_channels(id, &["effort", "speed_limit"]);
    let two = two.expect("readable");
    assert_eq!(two.columns, [9, 7].map(|place| data.columns[place].clone()));
    assert_eq!(two.trigger_row, data.trigger_row);
    let misspelt = store.trace_channels(id, &["sped"]);
    refused!(misspelt, _, "no channel \"sped\"", "speed");
    assert_eq!(store.traces(writer.id()).expect("listed")[0].occurrences, 2);

    let of_a_run = writer.trace(&[writer.id()], &data);
    refused!(
        of_a_run,
        StoreError::NotFound {
            what: "fault occurrence",
            ..
        }
    );
    let traces = store.traces(writer.id()).expect("listed");
    assert_eq!(traces.len(), 1, "rolled back");

    // A second trace of an occurrence leaves the first as it was sealed.
    let c = writer.fault(&fault(3, T0_US)).expect("stored");
    let occurrences = [a.occurrence, c.occurrence];
    let second = writer.trace(&occurrences, &data).expect("stored");
    let of = |fault| store.fault(fault).expect("known").fault.trace_id;
    assert_eq!([of(a.fault), of(c.fault)], [Some(id), Some(second)]);
    writer.finish(&end(Verdict::Failed)).expect("finished");
    let verified = store.verify_run(writer.id()).expect("verified");
    assert!(verified.changes.is_empty(), "{:?}", verified.changes);
}

/// Goal: one door for every text that people and scripts bring. Method: each a letter too long, and what was
/// there is as it was.
#[test]
fn texts_longer_than_are_kept_are_refused_and_messages_are_cut() {
    let (_dir, _, store) = new_history();
    let (name, note) = ("이".repeat(MOST_NAME + 1), "이".repeat(MOST_TEXT + 1));
    let too_long = |result: Result<(), StoreError>, word: &str| match result {
        Err(StoreError::TextTooLong { what, length, most }) => {
            assert!(what.contains(word) && length == most + 1, "{what}");
        }
        other => panic!("{word}: {other:?}"),
    };
    for (word, change) in [
        (
            "operator",
            (|run, name| run.operator = name) as fn(&mut RunRecord, String),
        ),
        ("train", |run, name| run.train = name),
        ("serial", |run, name| run.unit.serial = name),
        ("line", |run, name| run.line = name),
    ] {
        let mut record = run_record("ATC-7");
        change(&mut record, name.clone());
        too_long(RunWriter::begin(&store, &record).map(drop), word);
    }
    let mut writer = RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
    let long = StepRecord {
        message: note.clone(),
        ..step(0)
    };
    writer.step(long).expect("kept");
    let fault = writer.fault(&fault(7, T0_US)).expect("stored").fault;
    writer.finish(&end(Verdict::Failed)).expect("finished");
    let run = writer.id();
    let kept = &store.run(run).expect("there").steps[0].message;
    assert!(kept.chars().count() == MOST_TEXT && kept.ends_with('…'));
    too_long(store.add_run_note(run, "kim", &note, 1), "note");
    too_long(store.add_run_note(run, &name, "short", 1), "who says it");
    too_long(store.add_note(fault, "kim", &note, 1), "note");
    let by_name = store.acknowledge(fault, &name, "", 1);
    too_long(by_name.map(drop), "who says it");
    too_long(store.acknowledge(fault, "kim", &note, 1).map(drop), "note");
    let repair = repair_of("relay", &name, "", "");
    let repaired = store.record_repair(fault, &repair, "kim", 1);
    too_long(repaired.map(drop), "serial number");
    let detail = store.fault(fault).expect("there");
    assert_eq!(detail.events.len(), 1, "opened, and nothing else");
}

/// Goal: writes that are committed together are all there or none is, and one that fails within is taken
/// back alone.
#[test]
fn a_transaction_commits_all_writes_or_none() {
    let (_dir, _, store) = new_history();
    let count = |store: &Store| {
        let runs = store.runs(&RunFilter::default());
        runs.expect("listed").len()
    };
    let failed = store.transaction(|| {
        three_runs(&store);
        assert_eq!(count(&store), 3, "seen within");
        store.resolve_run("nonsense")
    });
    failed.expect_err("nothing of it");
    assert_eq!(count(&store), 0);
    let rest = store.transaction(|| {
        three_runs(&store);
        let nobody = fault_db::Id::from_bytes([7; 16]);
        refused!(store.add_note(nobody, "kim", "", T0_US), _);
        Ok(())
    });
    rest.expect("the rest goes on");
    assert_eq!(count(&store), 3);
    assert_eq!(problems(&store), []);
}
