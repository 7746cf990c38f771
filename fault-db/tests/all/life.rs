//! Lives by serial number: of a unit, of a train, of a part that went from unit to unit.

use fault_db::{
    FaultRecord, FaultState, Id, Life, LifeOf, LifeWhat, RunEnd, RunRecord, Store, ToWithdraw,
    Verdict,
};

use crate::common::{self, Deeds, T0_US, end, fault, open, recorded, repair_of};

const DAY_US: i64 = 86_400_000_000;

fn at(day: i64) -> i64 {
    T0_US + day * DAY_US
}

/// A run of that day on a unit in a train, which sees a fault of the relay.
fn run(store: &Store, (unit, train): (&str, &str), day: i64, codes: &[i64]) -> Vec<Id> {
    let record = RunRecord {
        started_at_us: at(day),
        train: train.to_owned(),
        ..common::run_record(unit)
    };
    let seen = codes.iter().map(|code| FaultRecord {
        lru: "eb_relay".to_owned(),
        ..fault(*code, at(day) + code)
    });
    let seen: Vec<_> = seen.collect();
    let end = RunEnd {
        finished_at_us: at(day) + 1_000_000,
        ..end(Verdict::Failed)
    };
    recorded(store, &record, &[], &seen, &end).1
}

fn repair(store: &Store, fault: Id, [old, new]: [&str; 2], day: i64) {
    let repair = repair_of("EB_Relay", old, new, "");
    store.put_case_repair(fault, &repair, "kim", at(day));
}

fn only(store: &Store, serial: &str) -> Life {
    let lives = store.lives(serial).expect("read");
    let [life] = &lives[..] else {
        panic!("{serial}: {lives:#?}");
    };
    life.clone()
}

/// Kinds of what happened, in order.
fn kinds(life: &Life) -> Vec<String> {
    let kind = |what: &'_ LifeWhat| match what {
        LifeWhat::Run(_) => "run".to_owned(),
        LifeWhat::Fault(fault) => fault.kind.clone(),
    };
    let events = life.events.iter();
    events.map(|event| kind(&event.what)).collect()
}

/// Unit, place, first and last day, runs.
type StayInDays<'a> = (&'a str, &'a str, Option<i64>, Option<i64>, u32);

fn stays(life: &Life) -> Vec<StayInDays<'_>> {
    let days = |at_us: Option<i64>| at_us.map(|at_us| (at_us - T0_US) / DAY_US);
    let stays = life.stays.iter();
    stays
        .map(|stay| {
            let (from, until) = (days(stay.from_us), days(stay.until_us));
            (&*stay.unit, &*stay.place, from, until, stay.runs)
        })
        .collect()
}

/// Goal: a part that was moved from unit to unit tells where it was, and which faults came while it was there. Method: SN-2
/// goes into A for SN-1, out of it for SN-3, and into B; faults before, between and after.
#[test]
fn a_part_tells_the_units_it_was_in_and_the_faults_of_that_time_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = open(&folder.path().join("history.db"));
    let first = run(&store, ("A", "T1"), 1, &[7, 8]);
    let cause = fault_db::CauseRecord {
        part: "eb_relay".to_owned(),
        run: Some("r".to_owned()),
        ..fault_db::CauseRecord::default()
    };
    store.put_diagnosed(&first, &cause, at(1) + 2_000_000);
    repair(&store, first[0], ["SN-1", "SN-2"], 2);
    let other = run(&store, ("A", "T1"), 3, &[7, 9]);
    repair(&store, other[0], ["SN-2", "SN-3"], 4);
    run(&store, ("A", "T1"), 5, &[9]);
    let elsewhere = run(&store, ("B", "T2"), 6, &[7]);
    repair(&store, elsewhere[0], ["", "SN-2"], 7);

    let life = only(&store, "SN-2");
    assert_eq!(life.of, LifeOf::Part);
    assert_eq!(
        stays(&life),
        [
            ("A", "eb_relay", Some(2), Some(4), 1),
            ("B", "eb_relay", Some(7), None, 0)
        ]
    );
    // The repair of a case is one entry, and names both of its faults.
    let LifeWhat::Fault(fitted) = &life.events[0].what else {
        panic!("{life:#?}");
    };
    assert_eq!(fitted.faults.len(), 2);
    assert_eq!(
        kinds(&life),
        ["repair", "recurred", "opened", "repair", "repair"]
    );
    let taken_out = only(&store, "SN-1");
    assert_eq!(stays(&taken_out)[0], ("A", "eb_relay", None, Some(2), 1));
    assert_eq!(
        kinds(&taken_out),
        ["opened", "opened", "diagnosed", "repair"]
    );

    // What was withdrawn counts for nothing.
    store
        .withdraw(
            elsewhere[0],
            ToWithdraw::default(),
            "kim",
            "wrong unit",
            at(8),
        )
        .expect("withdrawn");
    assert_eq!(only(&store, "SN-2").stays.len(), 1);
    assert!(store.lives("SN-9").expect("read").is_empty());
}

/// Goal: the life of a train ends where its unit goes to another train. Method: A in T1, then in T2; B in T2 all the time.
#[test]
fn a_train_tells_its_units_and_what_they_had_while_they_were_in_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = open(&folder.path().join("history.db"));
    let seen = run(&store, ("A", "T1"), 1, &[7]);
    run(&store, ("B", "T2"), 2, &[8]);
    run(&store, ("A", ""), 3, &[]);
    store.put_state(seen[0], FaultState::Closed, "kim", "no fault found", at(4));
    run(&store, ("A", "T2"), 5, &[7]);

    let life = only(&store, "T1");
    assert_eq!(life.of, LifeOf::Train);
    assert_eq!(stays(&life), [("A", "T1", Some(1), Some(5), 2)]);
    assert_eq!(kinds(&life), ["run", "opened", "run", "closed"]);
    let next = only(&store, "T2");
    assert_eq!(
        stays(&next),
        [("B", "T2", Some(2), None, 1), ("A", "T2", Some(5), None, 1)]
    );
    let unit = only(&store, "A");
    assert_eq!(unit.of, LifeOf::Unit);
    assert_eq!(
        stays(&unit),
        [
            ("A", "T1", Some(1), Some(5), 2),
            ("A", "T2", Some(5), None, 1)
        ]
    );
    assert_eq!(
        kinds(&unit),
        ["run", "opened", "run", "closed", "run", "opened"]
    );
    // One number may be that of several things.
    run(&store, ("T1", ""), 9, &[]);
    let both = store.lives("T1").expect("read");
    let both: Vec<_> = both.iter().map(|life| life.of).collect();
    assert_eq!(both, [LifeOf::Unit, LifeOf::Train]);
}
