//! Recordings of stimuli: kept beside their traces, merged, pruned and checked with them.

use crate::common::{
    Deeds, T0_US, Traces, end, fault, ids, kinds, new_history, problems, realistic_trace, refused,
    run_record,
};
use fault_db::{
    FaultState, Id, OpenOptions, PruneRule, RecordingRecord, RunWriter, Store, StoreError, Verdict,
};
use rusqlite::Connection;

const STIMULI: &str = r#"{"deeds":[{"at_us":10000,"act":"x"}],"lost":0}"#;

fn record(ordinal: u32) -> RecordingRecord {
    RecordingRecord {
        ordinal,
        procedure: format!("atp/number_{ordinal}"),
        t0_bench_us: i64::from(ordinal) * 1_000_000,
        bench_json: r#"{"seed":18446744073709551615}"#.to_owned(),
        stimuli_json: STIMULI.to_owned(),
    }
}

/// A run of two procedures that each cut a trace: the fault, and the two traces.
fn two_procedures(store: &Store) -> (Id, [Id; 2]) {
    let mut writer = RunWriter::begin(store, &run_record("ATC-7")).expect("begun");
    let stored = writer.fault(&fault(1, T0_US)).expect("stored");
    let mut cut = |ordinal: u32| {
        let trace = writer.put_trace(&[stored.occurrence], &realistic_trace(600, 3));
        writer.recording(&record(ordinal), &[trace]).expect("kept");
        trace
    };
    let traces = [cut(2), cut(5)];
    writer.finish(&end(Verdict::Failed)).expect("finished");
    (stored.fault, traces)
}

#[test]
fn a_trace_leads_to_the_recording_of_its_own_procedure() {
    let (_dir, _, store) = new_history();
    let (_, traces) = two_procedures(&store);
    for (trace, ordinal) in traces.into_iter().zip([2, 5]) {
        let found = store.recording(trace).expect("read").expect("kept");
        let given = record(ordinal);
        assert_eq!(found.procedure, given.procedure);
        assert_eq!(found.t0_bench_us, given.t0_bench_us);
        assert_eq!(
            (found.bench_json, found.stimuli_json),
            (given.bench_json, given.stimuli_json)
        );
    }
    let mut writer = RunWriter::begin(&store, &run_record("ATC-8")).expect("begun");
    let alone = writer.trace(&[], &realistic_trace(60, 3)).expect("stored");
    assert_eq!(store.recording(alone).expect("read"), None);
    assert_eq!(store.check().expect("checked").recordings, 2);
}

#[test]
fn merging_takes_recordings_along_once() {
    let (dir, _, store) = new_history();
    let (_, traces) = two_procedures(&store);
    let options = OpenOptions::new(ids(2));
    let other = Store::open(&dir.path().join("b.db"), options).expect("opens");
    // Their run gets another number here.
    two_procedures(&other);
    assert_eq!(other.merge_from(&store).expect("merged").recordings, 2);
    assert_eq!(other.merge_from(&store).expect("merged").recordings, 0);
    assert_eq!(
        other.recording(traces[1]).expect("read"),
        store.recording(traces[1]).expect("read")
    );
}

#[test]
fn a_recording_is_deleted_with_its_last_trace() {
    let (_dir, _, store) = new_history();
    let (closed, _) = two_procedures(&store);
    let rule = |dry_run| PruneRule {
        older_than_us: Some(T0_US + 1),
        dry_run,
        ..PruneRule::default()
    };
    assert_eq!(store.prune(&rule(false)).expect("pruned").recordings, 0);
    store.put_state(closed, FaultState::Closed, "kim", "", T0_US + 50);
    for dry_run in [true, false] {
        let counts = store.prune(&rule(dry_run)).expect("pruned");
        assert_eq!((counts.traces, counts.recordings), (2, 2), "{dry_run}");
    }
    assert_eq!(store.check().expect("checked").recordings, 0);
}

#[test]
fn a_damaged_recording_is_reported_and_never_returned() {
    let (_dir, path, store) = new_history();
    let (_, traces) = two_procedures(&store);
    let damage = |sql: &str| {
        let other = Connection::open(&path).expect("opens");
        other.execute_batch(sql).expect("damaged");
    };
    damage(
        "UPDATE recording SET stimuli = CAST(substr(stimuli, 1, 12) || x'00' ||
            substr(stimuli, 14) AS BLOB) WHERE ordinal = 2;
         UPDATE recording SET bench_json = '{' WHERE ordinal = 5",
    );
    refused!(store.recording(traces[0]), StoreError::Corrupt { .. });
    let found = problems(&store);
    assert_eq!(kinds(&found), ["recording", "recording", "seal", "seal"]);
}
