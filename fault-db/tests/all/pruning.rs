//! Pruning by age, rule and size: what is deleted, what is kept, and that the file remains consistent.

use std::path::Path;

use crate::common::{
    Deeds, Random, T0_US, Traces, end, fault, new_history, open, realistic_trace, run_record, with,
};
use fault_db::{FaultState, Id, PruneCounts, PruneRule, RunWriter, Store, StoreError, Verdict};
use rusqlite::Connection;

/// A trace that a day began with, of a run with this verdict; nothing compresses well in it.
fn trace(store: &Store, day: i64, verdict: Verdict) -> Id {
    let mut record = run_record("ATC-7");
    record.started_at_us = T0_US + day * 86_400_000_000;
    let mut writer = RunWriter::begin(store, &record).expect("begun");
    let mut data = realistic_trace(600, day as u64);
    let mut random = Random::new(day as u64 + 1);
    for sample in &mut data.columns[0] {
        *sample = (random.noise() * 1e6).round() / 10.0;
    }
    data.t0_us = record.started_at_us;
    let trace = writer.trace(&[], &data).expect("stored");
    writer.finish(&end(verdict)).expect("finished");
    trace
}

fn stays(store: &Store, trace: Id) -> bool {
    match store.trace(trace) {
        Ok(_) => true,
        Err(StoreError::NotFound { .. }) => false,
        Err(error) => panic!("{error}"),
    }
}

fn prune(store: &Store, rule: PruneRule) -> PruneCounts {
    let planned = store
        .prune(&PruneRule {
            dry_run: true,
            ..rule
        })
        .expect("planned");
    let done = store.prune(&rule).expect("pruned");
    let counts = |counts: &PruneCounts| {
        (
            counts.traces,
            counts.trace_bytes,
            counts.kept_for_faults,
            counts.kept_unsent,
        )
    };
    assert_eq!(counts(&planned), counts(&done), "as planned");
    assert_eq!(store.check().expect("checked").problems, [], "still whole");
    done
}

#[test]
fn traces_of_good_runs_go_alone_when_asked_for() {
    let (_dir, _, store) = new_history();
    let good = trace(&store, 0, Verdict::Passed);
    let bad = trace(&store, 1, Verdict::Failed);
    let young = trace(&store, 9, Verdict::Passed);
    let rule = PruneRule {
        older_than_us: Some(T0_US + 5 * 86_400_000_000),
        passed_only: true,
        ..PruneRule::default()
    };
    assert_eq!(prune(&store, rule).traces, 1);
    assert_eq!(
        [good, bad, young].map(|id| stays(&store, id)),
        [false, true, true]
    );
}

/// Goal: a file is brought under a size by the oldest traces, no more of them than it takes; and where the
/// rest alone is larger, that is said.
#[test]
fn the_oldest_go_until_the_file_fits() {
    let (_dir, path, store) = new_history();
    let traces: Vec<_> = (0..60)
        .rev()
        .map(|day| trace(&store, day, Verdict::Passed))
        .collect();
    prune(
        &store,
        with(|it: &mut PruneRule| it.older_than_us = Some(0)),
    );
    let size = |path: &Path| std::fs::metadata(path).expect("there").len();
    let before = size(&path);
    let max_file_bytes = before - 100_000;
    let rule = with(|it: &mut PruneRule| it.max_file_bytes = Some(max_file_bytes));
    let done = prune(&store, rule);
    assert!(
        size(&path) <= max_file_bytes && done.over_bytes == 0,
        "{done:?}"
    );
    assert!(
        size(&path) > max_file_bytes - 30_000,
        "no more than it takes: {done:?}"
    );
    assert_eq!(done.freed_bytes, before - size(&path));
    let gone = done.traces as usize;
    for (place, id) in traces.iter().rev().enumerate() {
        assert_eq!(stays(&store, *id), place >= gone, "the oldest first");
    }
    let again = prune(&store, rule);
    assert_eq!((again.traces, again.freed_bytes), (0, 0), "it fits");

    let rule = with(|it: &mut PruneRule| it.max_file_bytes = Some(50_000));
    let done = prune(&store, rule);
    assert_eq!(done.traces as usize, 60 - gone);
    assert_eq!(
        done.over_bytes,
        size(&path) - 50_000,
        "the rest is not for pruning"
    );
}

/// Goal: a trace that waits for a server stays, whatever its age, unless told otherwise; without a server
/// nothing waits. Traces of faults that are not closed stay in any case.
#[test]
fn traces_not_sent_yet_are_not_pruned() {
    let (dir, path, store) = new_history();
    let sent = trace(&store, 0, Verdict::Passed);
    let waiting = trace(&store, 1, Verdict::Passed);
    let mut writer = RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
    let seen = writer.fault(&fault(1, T0_US)).expect("stored");
    let needed = writer.put_trace(&[seen.occurrence], &realistic_trace(20, 1));
    writer.finish(&end(Verdict::Failed)).expect("finished");
    let conn = Connection::open(&path).expect("opens");
    conn.execute_batch(
        "INSERT INTO sync_server VALUES (x'01', 'depot', 9, 0, 0, 0);
         UPDATE sync_server SET sent_traces = (SELECT min(seq) FROM outbox WHERE what = 'trace')",
    )
    .expect("a server that has the first");
    let done = prune(&store, PruneRule::default());
    assert_eq!(
        (done.traces, done.kept_unsent, done.kept_for_faults),
        (1, 1, 1)
    );
    assert_eq!(
        [sent, waiting, needed].map(|id| stays(&store, id)),
        [false, true, true]
    );
    let anyway = with(|it: &mut PruneRule| it.keep_unsent = false);
    assert_eq!(prune(&store, anyway).traces, 1);
    assert!(stays(&store, needed));

    let alone = open(&dir.path().join("b.db"));
    trace(&alone, 0, Verdict::Passed);
    assert_eq!(prune(&alone, PruneRule::default()).traces, 1);
    store.put_state(seen.fault, FaultState::Closed, "kim", "", T0_US + 5);
    assert_eq!(prune(&store, anyway).traces, 1);
}
