//! The life of a fault: a repair is verified by a run that passed what saw the fault, by no other.

use crate::common::{
    Deeds, T0_US, confirm_passed, end, failed_run, fault, ids, open, recorded, repair_of,
    run_record, state, step,
};
use fault_db::{
    FaultState, Id, OpenOptions, RunEnd, RunFilter, RunRecord, RunWriter, StepRecord, Store,
    Verdict,
};
use tempfile::TempDir;

const DAY_US: i64 = 86_400_000_000;

struct Depot {
    store: Store,
    fault: Id,
    _folder: TempDir,
}

impl Depot {
    /// A fault seen in step 3 of a run on ATC-1.
    fn with_fault() -> Self {
        let folder = TempDir::new().expect("a folder");
        let store = open(&folder.path().join("a.db"));
        let failed = StepRecord {
            verdict: Verdict::Failed,
            ..step(3)
        };
        let seen = [fault(7, T0_US)];
        let (_, faults) = failed_run(&store, &run_record("ATC-1"), &[failed], &seen);
        let fault = faults[0];
        Self {
            store,
            fault,
            _folder: folder,
        }
    }

    fn repair(&self, at_us: i64) {
        let repair = repair_of("eb_relay", "A-1", "A-2", "");
        let state = self.store.record_repair(self.fault, &repair, "kim", at_us);
        assert_eq!(state.expect("repaired"), FaultState::Repaired);
    }

    /// A run of one step with these verdicts.
    fn run(&self, unit: &str, (of_step, verdict): (StepRecord, Verdict)) {
        let record = RunRecord {
            started_at_us: T0_US + 2 * DAY_US,
            ..run_record(unit)
        };
        let end = RunEnd {
            finished_at_us: T0_US + 3 * DAY_US,
            ..end(verdict)
        };
        recorded(&self.store, &record, &[of_step], &[], &end);
    }

    /// The last run proves what it may.
    fn confirm(&self) {
        confirm_passed(&self.store, self.last_run(), 1);
    }

    fn last_run(&self) -> Id {
        let runs = self.store.runs(&RunFilter::default());
        runs.expect("runs")[0].id
    }

    fn state(&self) -> FaultState {
        state(&self.store, self.fault)
    }
}

#[test]
fn a_run_that_passes_the_step_may_prove_the_repair() {
    let depot = Depot::with_fault();
    // The clock of the laptop that recorded the repair was a year ahead: what was known first counts.
    depot.repair(T0_US + 365 * DAY_US);
    depot.run("ATC-1", (step(3), Verdict::Passed));
    assert_eq!(depot.state(), FaultState::Repaired, "a claim so far");
    depot.confirm();
    assert_eq!(depot.state(), FaultState::Verified);
    let events = depot.store.fault(depot.fault).expect("known").events;
    for kind in ["passed", "confirmed"] {
        assert!(events.iter().any(|event| event.kind == kind), "{events:?}");
    }
    depot
        .store
        .put_state(depot.fault, FaultState::Closed, "lee", "", T0_US);
}

#[test]
fn a_run_without_the_step_does_not_verify_the_repair() {
    let another_step = StepRecord {
        name: "another".into(),
        ..step(3)
    };
    let failed_step = StepRecord {
        verdict: Verdict::Failed,
        ..step(3)
    };
    for (unit, run) in [
        ("ATC-2", (step(3), Verdict::Passed)),
        ("ATC-1", (another_step, Verdict::Passed)),
        ("ATC-1", (failed_step, Verdict::Failed)),
        ("ATC-1", (step(3), Verdict::Failed)),
        ("ATC-1", (step(3), Verdict::Aborted)),
    ] {
        let depot = Depot::with_fault();
        depot.repair(T0_US + DAY_US);
        depot.run(unit, run.clone());
        depot.confirm();
        assert_eq!(depot.state(), FaultState::Repaired, "{unit} {run:?}");
    }
}

/// Goal: what decides on a proof is told in which runs the fault was there, and in which it has not shown since.
#[test]
fn runs_before_and_since_a_repair_are_told_apart() {
    let depot = Depot::with_fault();
    let first = depot.last_run();
    depot.run("ATC-1", (step(3), Verdict::Passed));
    depot.run("ATC-2", (step(3), Verdict::Passed));
    depot.repair(T0_US + 3 * DAY_US);
    let mut passed = Vec::new();
    for _ in 0..2 {
        depot.run("ATC-1", (step(3), Verdict::Passed));
        passed.push(depot.last_run());
    }
    let to_prove = depot.store.repairs_to_prove(passed[1]).expect("read");
    let [repair] = &to_prove[..] else {
        panic!("one repair: {to_prove:?}");
    };
    assert_eq!((repair.fault, &repair.passed), (depot.fault, &passed));
    assert_eq!((repair.there.len(), repair.there[0]), (2, first));
}

/// Goal: where histories meet, the step that saw the fault last is the last one by time, not the one that was imported last.
#[test]
fn an_import_does_not_change_which_step_saw_the_fault_last() {
    let depot = Depot::with_fault();
    let older = depot._folder.path().join("older.db");
    let store = Store::open(&older, OpenOptions::new(ids(5))).expect("opens");
    let record = RunRecord {
        started_at_us: T0_US - DAY_US,
        ..run_record("ATC-1")
    };
    let another = |verdict| StepRecord {
        name: "another".into(),
        verdict,
        ..step(3)
    };
    let finished_at_us = end(Verdict::Failed).finished_at_us - DAY_US;
    let ended = RunEnd {
        finished_at_us,
        ..end(Verdict::Failed)
    };
    let seen = [fault(7, T0_US - DAY_US)];
    let steps = [another(Verdict::Failed)];
    let (first, _) = recorded(&store, &record, &steps, &seen, &ended);
    store.close().expect("closed");
    depot.store.import(&older).expect("merged");
    depot.repair(T0_US + DAY_US);
    depot.run("ATC-1", (another(Verdict::Passed), Verdict::Passed));
    let to_prove = depot.store.repairs_to_prove(depot.last_run());
    assert_eq!(to_prove.expect("read"), []);
    depot.run("ATC-1", (step(3), Verdict::Passed));
    let to_prove = depot.store.repairs_to_prove(depot.last_run());
    let there = to_prove.expect("read").remove(0).there;
    assert_eq!((there.len(), there[0]), (2, first));
}

#[test]
fn a_run_that_began_before_the_repair_proves_nothing() {
    let depot = Depot::with_fault();
    let mut writer = RunWriter::begin(&depot.store, &run_record("ATC-1")).expect("begun");
    writer.step(step(3)).expect("kept");
    depot.repair(T0_US + 1);
    writer.finish(&end(Verdict::Passed)).expect("finished");
    depot.confirm();
    assert_eq!(depot.state(), FaultState::Repaired);
}

#[test]
fn a_repaired_fault_that_occurs_again_is_reopened() {
    let depot = Depot::with_fault();
    depot.repair(T0_US + DAY_US);
    depot.run("ATC-1", (step(3), Verdict::Passed));
    depot.confirm();
    let mut writer = RunWriter::begin(&depot.store, &run_record("ATC-1")).expect("begun");
    let seen = writer.fault(&fault(7, T0_US + 5 * DAY_US)).expect("stored");
    assert!(seen.reopened && seen.fault == depot.fault);
    writer.finish(&end(Verdict::Failed)).expect("finished");
    assert_eq!(depot.state(), FaultState::Open);
}

/// The laptop that recorded the repair was a day ahead: what a run sees now still comes after it.
#[test]
fn a_repair_dated_tomorrow_does_not_hide_what_is_seen_today() {
    let depot = Depot::with_fault();
    depot.repair(T0_US + 2 * DAY_US);
    let mut writer = RunWriter::begin(&depot.store, &run_record("ATC-1")).expect("begun");
    let seen = writer.fault(&fault(7, T0_US + DAY_US)).expect("stored");
    assert!(seen.reopened && seen.fault == depot.fault);
    drop(writer);
    assert_eq!(depot.state(), FaultState::Open);
}
