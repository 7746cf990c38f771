//! An event of a person is withdrawn: everything but the correction is as it was before.

use std::collections::BTreeSet;
use std::path::Path;

use crate::common::{
    Deeds, Random, T0_US, change, end, fault, ids, open, repair_of, run_record, step, with,
};
use fault_db::{
    CauseRecord, FaultFilter, FaultRecord, FaultState, Id, OpenOptions, RepairRecord, RepairsOf,
    RunWriter, StatKey, StatQuery, Store, ToWithdraw, Verdict, Withdrawn,
};
use fuzzing::draw;
use rusqlite::Connection;
use tempfile::tempdir;

const HOUR_US: i64 = 3_600_000_000;

/// A run of one step, dated `at_us`, that sees these faults (code and part) or passes; its proofs count.
fn run(store: &Store, at_us: i64, faults: &[(i64, &str)]) -> Vec<Id> {
    let mut record = run_record("ATC-1");
    record.started_at_us = at_us;
    record.source = "serial:/dev/ttyUSB0".to_owned();
    let mut writer = RunWriter::begin(store, &record).expect("begun");
    let verdict = match faults {
        [] => Verdict::Passed,
        _ => Verdict::Failed,
    };
    let mut of_run = step(3);
    of_run.verdict = verdict;
    writer.step(of_run).expect("kept");
    let seen = faults.iter().map(|(code, part)| {
        let seen = FaultRecord {
            lru: (*part).to_owned(),
            step_index: Some(3),
            ..fault(*code, at_us)
        };
        writer.fault(&seen).expect("stored").fault
    });
    let seen: Vec<Id> = seen.collect();
    let mut ended = end(verdict);
    ended.finished_at_us = at_us + 60_000_000;
    writer.finish(&ended).expect("finished");
    let to_prove = store.repairs_to_prove(writer.id()).expect("read");
    let proven: Vec<_> = to_prove
        .iter()
        .filter(|repair| repair.passed.len() > 1)
        .map(|repair| (repair.fault, "by the test".to_owned()))
        .collect();
    store.confirm_repairs(writer.id(), &proven).expect("stored");
    seen
}

fn repair(part: &str, serial: &str) -> RepairRecord {
    repair_of(part, "", serial, "교체")
}

fn undo(store: &Store, fault: Id, at_us: i64) -> Withdrawn {
    store
        .withdraw(fault, ToWithdraw::default(), "lee", "by mistake", at_us)
        .expect("withdrawn")
}

/// All that the history answers but the corrections: lists, details, counts, what is learnt, and derived tables.
fn said(store: &Store) -> Vec<String> {
    let mut said = Vec::new();
    for note in [None, Some("교체"), Some("relay"), Some("burnt")] {
        let filter = with(|it: &mut FaultFilter| it.note = note.map(str::to_owned));
        said.push(format!(
            "{note:?} {:?}",
            store.faults(&filter).expect("listed")
        ));
    }
    for serial in ["SN-1", "SN-2"] {
        let filter = with(|it: &mut FaultFilter| it.serial = Some(serial.to_owned()));
        said.push(format!(
            "{serial} {:?}",
            store.faults(&filter).expect("listed")
        ));
    }
    for fault in store.faults(&FaultFilter::default()).expect("listed") {
        let detail = store.fault(fault.id).expect("read");
        said.push(format!(
            "{:?} {:?} {:?}",
            detail.fault, detail.case, detail.events
        ));
    }
    for by in [
        StatKey::Cause,
        StatKey::Lru,
        StatKey::Unit,
        StatKey::Code,
        StatKey::All,
    ] {
        for unit in [None, Some("ATC-1".to_owned())] {
            let query = StatQuery {
                by,
                filter: with(|it: &mut FaultFilter| it.unit = unit),
                now_us: T0_US + 1000 * HOUR_US,
                back_within_days: 30,
            };
            said.push(format!(
                "{by:?} {:?}",
                store.stats(&query).expect("counted")
            ));
        }
    }
    let of = RepairsOf {
        before_us: T0_US + 1000 * HOUR_US,
        unit_type: "default",
        practice: true,
    };
    said.push(format!(
        "{:?}",
        store.confirmed_repairs(of).expect("learnt")
    ));
    said.push(format!(
        "{:?}",
        store.confirmed_cases(of, 9).expect("learnt")
    ));
    let span = (0, T0_US + 1000 * HOUR_US);
    said.push(format!(
        "{:?}",
        store.part_history("ATC-1", span, None).expect("read")
    ));
    said.push(format!("{:?}", store.conflicts().expect("read")));
    let conn = Connection::open(store.path()).expect("opens");
    for sql in [
        "SELECT quote(event) || fault || part || at_us || '/' || opened_at_us || '/' || ifnull(back_at_us, '-') FROM repair",
        "SELECT seq || state || ifnull(closed_at_us, '-') || repairs || disputed || ifnull(cause, '-') FROM fault",
    ] {
        let mut select = conn.prepare(sql).expect("a question");
        let rows = select
            .query_map([], |row| row.get::<_, String>(0))
            .expect("asked");
        said.extend(rows.map(|row| row.expect("read")));
    }
    said
}

fn sound(store: &Store) {
    assert_eq!(store.check().expect("checked").problems, []);
}

/// Goal: after an undo everything is as before. Method: random histories of two laptops' worth of steps on three faults of a
/// case; before each step of a person all that can be asked is written down, then the step is done, undone, asked again,
/// and half of the time done once more to stay.
#[test]
fn all_that_can_be_asked_is_after_an_undo_what_it_was_before_the_step() {
    for seed in draw::drawn(1..=12, 3) {
        let folder = tempdir().expect("a folder");
        let store = open(&folder.path().join("a.db"));
        let mut random = Random::new(seed);
        let mut now_us = T0_US;
        let faults = run(
            &store,
            now_us,
            &[(1, "eb_relay"), (2, "atp_cpu"), (3, "io_board")],
        );
        let cause = CauseRecord {
            part: "eb_relay".to_owned(),
            probability: Some(0.97),
            ..CauseRecord::default()
        };
        store.put_diagnosed(&faults[..2], &cause, now_us + 1);
        let mut undone = BTreeSet::new();
        for _ in 0..40 {
            now_us += HOUR_US * (1 + (random.next() % 50) as i64);
            if random.one_in(4) {
                run(&store, now_us, &[]);
                continue;
            }
            if random.one_in(9) {
                run(&store, now_us, &[(1, "eb_relay"), (3, "io_board")]);
                continue;
            }
            let all = store.faults(&FaultFilter::default()).expect("listed");
            let fault = all[random.next() as usize % all.len()].id;
            let which = random.next() % 8;
            let act = |at_us: i64| {
                let state = |to| {
                    store
                        .set_case_state(fault, to, "kim", "relay", at_us)
                        .is_ok()
                };
                match which {
                    0 => state(FaultState::Acknowledged),
                    1 => state(FaultState::Verified),
                    2 => state(FaultState::Closed),
                    3 => state(FaultState::Open),
                    4 => store
                        .repair_case(fault, &repair("eb_relay", "SN-1"), "kim", at_us)
                        .is_ok(),
                    5 => store
                        .record_repair(fault, &repair("io_board", "SN-2"), "kim", at_us)
                        .is_ok(),
                    6 => store
                        .add_note(fault, "kim", "burnt contacts", at_us)
                        .is_ok(),
                    _ => {
                        let cause = with(|it: &mut CauseRecord| it.part = "io_board".to_owned());
                        store.set_cause(fault, &cause, "kim", at_us).is_ok()
                    }
                }
            };
            let before = said(&store);
            if !act(now_us) {
                continue;
            }
            let withdrawn = undo(&store, fault, now_us + 1);
            assert_eq!((withdrawn.at_us, &*withdrawn.who), (now_us, "kim"));
            undone.insert(withdrawn.kind);
            assert_eq!(said(&store), before, "seed {seed}, step {which}");
            sound(&store);
            if random.one_in(2) {
                assert!(act(now_us + 2), "it is allowed as before");
            }
        }
        sound(&store);
        store.rebuild(now_us).expect("counted again");
        sound(&store);
        assert!(undone.len() >= 4, "{undone:?}");
    }
}

#[test]
fn the_correction_is_told_with_what_it_withdraws() {
    let folder = tempdir().expect("a folder");
    let store = open(&folder.path().join("a.db"));
    let faults = run(&store, T0_US, &[(1, "eb_relay")]);
    store.put_acknowledged(faults[0], "kim", "", T0_US + 1);
    store.put_repair(faults[0], &repair("eb_relay", "SN-1"), "kim", T0_US + 2);
    let withdrawn = undo(&store, faults[0], T0_US + 3);
    assert_eq!((&*withdrawn.kind, withdrawn.faults.len()), ("repair", 1));
    assert_eq!(withdrawn.faults[0].state, FaultState::Acknowledged);
    let detail = store.fault(faults[0]).expect("read");
    let [event] = &detail.withdrawn[..] else {
        panic!("{:?}", detail.withdrawn);
    };
    assert_eq!(event.repair, Some(repair("eb_relay", "SN-1")));
    let correction = event.correction.as_ref().expect("who did it");
    assert_eq!((&*correction.who, &*correction.note), ("lee", "by mistake"));
    let rows = store
        .query_read_only(
            "SELECT kind, who, withdrawn, text FROM events ORDER BY turn",
            9,
        )
        .expect("asked");
    assert_eq!(rows.rows.len(), 4, "nothing is deleted: {:?}", rows.rows);
    // One step after the other, the last first.
    assert_eq!(undo(&store, faults[0], T0_US + 4).kind, "acknowledged");
    let nothing = store.withdraw(faults[0], ToWithdraw::default(), "lee", "", T0_US + 5);
    let said = nothing.expect_err("nothing is left").to_string();
    assert!(said.contains("nobody has written anything"), "{said}");
}

/// What rests on a step keeps it.
#[test]
fn what_a_run_or_a_new_fault_rests_on_is_not_withdrawn() {
    let folder = tempdir().expect("a folder");
    let store = open(&folder.path().join("a.db"));
    let faults = run(&store, T0_US, &[(1, "eb_relay"), (2, "atp_cpu")]);
    let refused = |fault: Id, says: &str| {
        let refused = store.withdraw(fault, ToWithdraw::default(), "lee", "", T0_US + HOUR_US);
        let said = refused.expect_err("refused").to_string();
        assert!(said.contains(says), "{said}");
    };
    store.put_repair(faults[0], &repair("eb_relay", "SN-1"), "kim", T0_US + 9);
    run(&store, T0_US + 10, &[]);
    refused(faults[0], "it was passed after it was repair");
    run(&store, T0_US + 20, &[]);
    assert_eq!(
        store.fault(faults[0]).expect("read").fault.state,
        FaultState::Verified
    );
    refused(faults[0], "it was passed after it was repair");
    store.put_state(
        faults[1],
        FaultState::Closed,
        "kim",
        "not found",
        T0_US + 30,
    );
    let other = ToWithdraw {
        written_at_us: Some(T0_US + 29),
        ..ToWithdraw::default()
    };
    let said = store.withdraw(faults[1], other, "lee", "", T0_US + 31);
    let said = said.expect_err("of another time").to_string();
    assert!(said.contains("is another: closed by kim"), "{said}");
    run(&store, T0_US + 40, &[(2, "atp_cpu")]);
    refused(faults[1], "a fault of its own since");
}

fn laptop(path: &Path, seed: u64) -> Store {
    Store::open(path, OpenOptions::new(ids(seed))).expect("opens")
}

/// Goal: a withdrawal counts wherever it comes to, also before what it withdraws. Method: two laptops; one writes and
/// withdraws, the other imports it whole, or in the wrong order.
#[test]
fn a_withdrawal_is_imported_with_what_it_withdraws() {
    let folder = tempdir().expect("a folder");
    let (here, there) = (folder.path().join("a.db"), folder.path().join("b.db"));
    let store = laptop(&here, 1);
    let faults = run(&store, T0_US, &[(1, "eb_relay")]);
    let other = laptop(&there, 2);
    other.import(&here).expect("imported");
    let before = said(&other);
    store.put_repair(faults[0], &repair("eb_relay", "SN-1"), "kim", T0_US + 2);
    undo(&store, faults[0], T0_US + 3);
    other.import(&here).expect("imported");
    assert_eq!(said(&other), before);
    assert_eq!(other.fault(faults[0]).expect("read").withdrawn.len(), 1);
    sound(&other);
    // The other laptop wrote something in knowledge of the step: with what was decided before, that is a conflict.
    store.put_acknowledged(faults[0], "kim", "", T0_US + 4);
    store.put_repair(faults[0], &repair("eb_relay", "SN-2"), "kim", T0_US + 5);
    other.import(&here).expect("imported");
    other.put_state(
        faults[0],
        FaultState::Verified,
        "lee",
        "seen by eye",
        T0_US + 7,
    );
    undo(&store, faults[0], T0_US + 8);
    other.import(&here).expect("imported");
    store.import(&there).expect("imported");
    for store in [&store, &other] {
        assert_eq!(
            store.fault(faults[0]).expect("read").fault.state,
            FaultState::Acknowledged
        );
        assert_eq!(store.conflicts().expect("read").len(), 1);
        sound(store);
    }
}

/// A row from outside that withdraws nothing in particular, or says a state, is refused.
#[test]
fn a_withdrawal_of_no_event_is_refused() {
    for set in ["follows = x''", "state = 'closed'"] {
        let folder = tempdir().expect("a folder");
        let (here, there) = (folder.path().join("a.db"), folder.path().join("b.db"));
        let store = laptop(&here, 1);
        let faults = run(&store, T0_US, &[(1, "eb_relay")]);
        store.put_acknowledged(faults[0], "kim", "", T0_US + 1);
        undo(&store, faults[0], T0_US + 2);
        drop(store);
        change(
            &here,
            &format!("UPDATE fault_event SET {set} WHERE kind = 'withdrawn'"),
        );
        let other = laptop(&there, 2);
        let counts = other.import(&here).expect("imported");
        let refused = &counts.refused.named;
        assert!(
            refused
                .iter()
                .any(|one| one.reason.contains("withdraws one event")),
            "{refused:?}"
        );
    }
}
