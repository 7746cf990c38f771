//! An event of a person is withdrawn: everything but the correction is as it was before.

use std::collections::BTreeSet;

use crate::common::{
    Deeds, Random, STAT_KEYS, T0_US, change, confirm_passed, end, fault, open, open_as, problems,
    recorded, refused, repair_of, run_record, state, step, with,
};
use fault_db::{
    CauseRecord, FaultFilter, FaultRecord, FaultState, Id, RepairRecord, RepairsOf, StatQuery,
    StepRecord, Store, ToWithdraw, Verdict, Withdrawn,
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
    let verdict = match faults {
        [] => Verdict::Passed,
        _ => Verdict::Failed,
    };
    let of_step = StepRecord { verdict, ..step(3) };
    let faults = faults.iter().map(|(code, part)| FaultRecord {
        lru: (*part).to_owned(),
        ..fault(*code, at_us)
    });
    let mut ended = end(verdict);
    ended.finished_at_us = at_us + 60_000_000;
    let faults: Vec<_> = faults.collect();
    let (run, seen) = recorded(store, &record, &[of_step], &faults, &ended);
    confirm_passed(store, run, 2);
    seen
}

fn repair(part: &str, serial: &str) -> RepairRecord {
    repair_of(part, "", serial, "교체")
}

fn undo(store: &Store, fault: Id, at_us: i64) -> Withdrawn {
    let done = store.withdraw(fault, ToWithdraw::default(), "lee", "by mistake", at_us);
    done.expect("withdrawn")
}

/// All that the history answers but the corrections: lists, details, counts, what is learnt, and derived tables.
fn said(store: &Store) -> Vec<String> {
    let mut said = Vec::new();
    for note in [None, Some("교체"), Some("relay"), Some("burnt")] {
        let filter = with(|it: &mut FaultFilter| it.note = note.map(str::to_owned));
        let listed = store.faults(&filter).expect("listed");
        said.push(format!("{note:?} {listed:?}"));
    }
    for serial in ["SN-1", "SN-2"] {
        let filter = with(|it: &mut FaultFilter| it.serial = Some(serial.to_owned()));
        let listed = store.faults(&filter).expect("listed");
        said.push(format!("{serial} {listed:?}"));
    }
    for fault in store.faults(&FaultFilter::default()).expect("listed") {
        let detail = store.fault(fault.id).expect("read");
        let told = (detail.fault, detail.case, detail.events);
        said.push(format!("{told:?}"));
    }
    for by in STAT_KEYS {
        for unit in [None, Some("ATC-1".to_owned())] {
            let query = StatQuery {
                by,
                filter: with(|it: &mut FaultFilter| it.unit = unit),
                now_us: T0_US + 1000 * HOUR_US,
                back_within_days: 30,
            };
            let counted = store.stats(&query).expect("counted");
            said.push(format!("{by:?} {counted:?}"));
        }
    }
    let of = RepairsOf {
        before_us: T0_US + 1000 * HOUR_US,
        unit_type: "default",
        practice: true,
    };
    let repairs = store.confirmed_repairs(of).expect("learnt");
    let cases = store.confirmed_cases(of, 9).expect("learnt");
    let parts = store.part_history("ATC-1", (0, of.before_us), None);
    let conflicts = store.conflicts().expect("read");
    let told = (repairs, cases, parts.expect("read"), conflicts);
    said.push(format!("{told:?}"));
    let conn = Connection::open(store.path()).expect("opens");
    for sql in [
        "SELECT quote(event) || fault || part || at_us || '/' || opened_at_us || '/' || ifnull(back_at_us, '-') FROM repair",
        "SELECT seq || state || ifnull(closed_at_us, '-') || repairs || disputed || ifnull(cause, '-') FROM fault",
    ] {
        let mut select = conn.prepare(sql).expect("a question");
        let rows = select.query_map([], |row| row.get::<_, String>(0));
        said.extend(rows.expect("asked").map(|row| row.expect("read")));
    }
    said
}

fn sound(store: &Store) {
    assert_eq!(problems(store), []);
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
        let parts = [(1, "eb_relay"), (2, "atp_cpu"), (3, "io_board")];
        let faults = run(&store, now_us, &parts);
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
                        .map(drop)
                };
                let done = match which {
                    0 => state(FaultState::Acknowledged),
                    1 => state(FaultState::Verified),
                    2 => state(FaultState::Closed),
                    3 => state(FaultState::Open),
                    4 => {
                        let repair = repair("eb_relay", "SN-1");
                        store.repair_case(fault, &repair, "kim", at_us).map(drop)
                    }
                    5 => {
                        let repair = repair("io_board", "SN-2");
                        store.record_repair(fault, &repair, "kim", at_us).map(drop)
                    }
                    6 => store.add_note(fault, "kim", "burnt contacts", at_us),
                    _ => {
                        let cause = with(|it: &mut CauseRecord| it.part = "io_board".to_owned());
                        store.set_cause(fault, &cause, "kim", at_us).map(drop)
                    }
                };
                done.is_ok()
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
    let rows = store.query_read_only("SELECT kind, who, withdrawn, text FROM events", 9);
    assert_eq!(rows.expect("asked").rows.len(), 4, "nothing is deleted");
    // One step after the other, the last first.
    assert_eq!(undo(&store, faults[0], T0_US + 4).kind, "acknowledged");
    let nothing = store.withdraw(faults[0], ToWithdraw::default(), "lee", "", T0_US + 5);
    refused!(nothing, _, "nobody has written anything");
}

/// What rests on a step keeps it.
#[test]
fn what_a_run_or_a_new_fault_rests_on_is_not_withdrawn() {
    let folder = tempdir().expect("a folder");
    let store = open(&folder.path().join("a.db"));
    let faults = run(&store, T0_US, &[(1, "eb_relay"), (2, "atp_cpu")]);
    let assert_kept = |fault: Id, says: &str| {
        let withdrawn = store.withdraw(fault, ToWithdraw::default(), "lee", "", T0_US + HOUR_US);
        refused!(withdrawn, _, says);
    };
    store.put_repair(faults[0], &repair("eb_relay", "SN-1"), "kim", T0_US + 9);
    run(&store, T0_US + 10, &[]);
    assert_kept(faults[0], "it was passed after it was repair");
    run(&store, T0_US + 20, &[]);
    assert_eq!(state(&store, faults[0]), FaultState::Verified);
    assert_kept(faults[0], "it was passed after it was repair");
    store.put_state(faults[1], FaultState::Closed, "kim", "", T0_US + 30);
    let other = with(|it: &mut ToWithdraw| it.written_at_us = Some(T0_US + 29));
    let of_another_time = store.withdraw(faults[1], other, "lee", "", T0_US + 31);
    refused!(of_another_time, _, "is another: closed by kim");
    run(&store, T0_US + 40, &[(2, "atp_cpu")]);
    assert_kept(faults[1], "a fault of its own since");
}

/// Goal: a withdrawal counts wherever it comes to, also before what it withdraws. Method: two laptops; one writes and
/// withdraws, the other imports it whole, or in the wrong order.
#[test]
fn a_withdrawal_is_imported_with_what_it_withdraws() {
    let folder = tempdir().expect("a folder");
    let (here, there) = (folder.path().join("a.db"), folder.path().join("b.db"));
    let store = open_as(&here, 1);
    let faults = run(&store, T0_US, &[(1, "eb_relay")]);
    let other = open_as(&there, 2);
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
    other.put_state(faults[0], FaultState::Verified, "lee", "", T0_US + 7);
    undo(&store, faults[0], T0_US + 8);
    other.import(&here).expect("imported");
    store.import(&there).expect("imported");
    for store in [&store, &other] {
        assert_eq!(state(store, faults[0]), FaultState::Acknowledged);
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
        let store = open_as(&here, 1);
        let faults = run(&store, T0_US, &[(1, "eb_relay")]);
        store.put_acknowledged(faults[0], "kim", "", T0_US + 1);
        undo(&store, faults[0], T0_US + 2);
        drop(store);
        let sql = format!("UPDATE fault_event SET {set} WHERE kind = 'withdrawn'");
        change(&here, &sql);
        let other = open_as(&there, 2);
        let named = other.import(&here).expect("imported").refused.named;
        let mut reasons = named.iter().map(|one| &one.reason);
        assert!(
            reasons.any(|reason| reason.contains("withdraws one event")),
            "{named:?}"
        );
    }
}
