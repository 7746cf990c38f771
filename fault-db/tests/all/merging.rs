//! Laptops that meet in any order: the same faults, states and counts everywhere, and nothing hidden of
//! what people did without knowing of each other.

use std::path::PathBuf;

use crate::common::{
    Deeds, Random, STAT_KEYS, T0_US, change, end, failed_run, fault, ids, measured_step,
    measurement, open_as, problems, refused, repair_of, rows, run_record, state, step, with,
};
use fault_db::{
    CauseRecord, FaultFilter, FaultState, Id, MergeCounts, OpenOptions, RunWriter, StatQuery,
    Store, StoreError, Verdict,
};
use rusqlite::Connection;
use tempfile::{TempDir, tempdir};

const HOUR_US: i64 = 3_600_000_000;

fn laptop(dir: &TempDir, name: &str, seed: u64) -> Store {
    open_as(&dir.path().join(name), seed)
}

/// Content of a file, without row numbers and the id by which a fault goes, which differ between files.
fn said(store: &Store) -> Vec<String> {
    let conn = Connection::open(store.path()).expect("opens");
    let questions = [
        "SELECT u.serial || ' ' || f.code || f.lru || ' ' || f.state || ' ' || f.first_at_us || ' '
            || f.last_at_us || ' ' || f.occurrences || ' ' || f.repairs || ' ' || f.line || ' '
            || ifnull(f.closed_at_us, '-') || ' from ' || ifnull(f.cause, '-') || ' seen '
            || (SELECT group_concat(hex(id)) FROM (SELECT id FROM fault_occurrence o
                WHERE o.fault = f.seq ORDER BY id)) || ' done '
            || (SELECT group_concat(hex(id) || turn) FROM (SELECT id, turn FROM fault_event e
                WHERE e.fault = f.seq ORDER BY id))
            || ' ids ' || (SELECT group_concat(hex(id)) FROM (SELECT id FROM fault WHERE seq = f.seq
                UNION SELECT id FROM fault_alias a WHERE a.fault = f.seq ORDER BY id))
         FROM fault f JOIN unit u ON u.seq = f.unit",
        "SELECT hex(e.id) || ' ' || r.part || ' ' || r.line || ' ' || r.opened_at_us || ' '
            || ifnull(r.back_at_us, '-') FROM repair r JOIN fault_event e ON e.seq = r.event",
        "SELECT DISTINCT what || hex(id) FROM seal WHERE what <> 'begun'",
        "SELECT hex(id) || ifnull(verdict, '-') || train FROM run",
        "SELECT name || procedure || day || ' ' || n || ' ' || least || ' ' || most FROM measured_day",
    ];
    let mut said = Vec::new();
    for question in questions {
        let mut select = conn.prepare(question).expect("a question");
        let lines = select.query_map([], |row| row.get::<_, String>(0));
        let mut lines: Vec<_> = lines
            .expect("asked")
            .collect::<Result<_, _>>()
            .expect("answers");
        lines.sort();
        said.extend(lines);
    }
    for by in STAT_KEYS {
        let query = StatQuery {
            by,
            filter: FaultFilter::default(),
            now_us: T0_US + 10_000 * HOUR_US,
            back_within_days: 30,
        };
        said.push(format!("{:?}", store.stats(&query).expect("counted")));
    }
    said
}

fn whole(store: &Store, what: &str) {
    assert_eq!(problems(store), [], "{what}");
}

/// Runs, faults out of order, and people who do what they may, with a clock of their own.
fn live(store: &Store, random: &mut Random, clock_us: i64) {
    let mut at_us = clock_us;
    let mut known: Vec<Id> = faults(store);
    for _ in 0..8 {
        at_us += (random.next() % 50) as i64 * HOUR_US;
        let mut record = run_record(["ATC-1", "ATC-2"][(random.next() % 2) as usize]);
        record.line = format!("line-{}", random.next() % 2);
        record.train = format!("T{}", random.next() % 3);
        record.started_at_us = at_us;
        let mut writer = RunWriter::begin(store, &record).expect("begun");
        let mut measured = step(0);
        measured.measurements = vec![measurement("eb_reaction", 0.42 + random.noise() / 10.0)];
        writer.step(measured).expect("kept");
        for _ in 0..random.next() % 4 {
            let code = (random.next() % 2) as i64;
            // Out of the unit's log: some are older than what is known.
            let back_us = (random.next() % 2_000_000_000) as i64 * 100;
            let stored = writer.fault(&fault(code, at_us - back_us)).expect("stored");
            known.push(stored.fault);
        }
        if !random.one_in(6) {
            writer.finish(&end(Verdict::Failed)).expect("finished");
        }
        for _ in 0..6 {
            if known.is_empty() {
                break;
            }
            let fault = known[(random.next() % known.len() as u64) as usize];
            let when_us = at_us + (random.next() % 1_000) as i64 * 60_000_000;
            match act(store, fault, random.next() % 8, when_us) {
                Ok(()) | Err(StoreError::Transition { .. }) => {}
                Err(error) => panic!("{error}"),
            }
        }
    }
}

fn act(store: &Store, fault: Id, act: u64, at_us: i64) -> Result<(), StoreError> {
    let repair = repair_of("EB_relay", "", "SN-7", "교체함");
    match act {
        0 => store.acknowledge(fault, "kim", "", at_us).map(drop),
        1 => store.repair_case(fault, &repair, "lee", at_us).map(drop),
        2 => store
            .set_state(fault, FaultState::Verified, "kim", "", at_us)
            .map(drop),
        3 => store
            .set_state(fault, FaultState::Open, "kim", "again", at_us)
            .map(drop),
        4 => store.add_note(fault, "park", "seen before", at_us),
        6 => store.set_cause(fault, &from("psm"), "park", at_us),
        7 => store
            .attribute_diagnosed(&faults(store), &from("EB_relay"), at_us)
            .map(drop),
        _ => store
            .set_case_state(fault, FaultState::Closed, "lee", "이상 없음", at_us)
            .map(drop),
    }
}

fn from(part: &str) -> CauseRecord {
    with(|it: &mut CauseRecord| it.part = part.to_owned())
}

fn faults(store: &Store) -> Vec<Id> {
    let all = store.faults(&fault_db::FaultFilter::default());
    all.expect("listed")
        .into_iter()
        .map(|fault| fault.id)
        .collect()
}

/// Goal: whatever laptops did, knowing of each other's work in part, all files that have seen both say the
/// same, in whichever order that was, and their counts are those of their rows.
/// Method: lives drawn from a seed; two laptops share a beginning, one has met the other half-way, and
/// their clocks are days apart.
#[test]
fn files_merged_in_any_order_have_the_same_content() {
    for seed in 1..=12 {
        let dir = tempdir().expect("a directory");
        let mut random = Random::new(seed);
        let a = laptop(&dir, "a.db", 1000 + seed);
        let b = laptop(&dir, "b.db", 2000 + seed);
        let done = a.transaction(|| {
            live(&a, &mut random, T0_US);
            Ok(())
        });
        done.expect("lived");
        if seed % 3 != 0 {
            b.merge_from(&a).expect("a shared beginning");
        }
        live(&b, &mut random, T0_US - 200 * HOUR_US);
        if seed % 2 == 0 {
            a.merge_from(&b).expect("met half-way");
            live(&b, &mut random, T0_US + 100 * HOUR_US);
        }
        live(&a, &mut random, T0_US + 300 * HOUR_US);
        for (store, name) in [(&a, "a"), (&b, "b")] {
            whole(store, &format!("seed {seed}: {name} before"));
        }

        let (ab, ba) = (laptop(&dir, "ab.db", 3), laptop(&dir, "ba.db", 4));
        for (store, order) in [(&ab, [&a, &b]), (&ba, [&b, &a])] {
            for from in order {
                store.merge_from(from).expect("merged");
            }
            whole(store, &format!("seed {seed}: merged"));
            for from in order {
                let again = store.merge_from(from).expect("merged again");
                assert_eq!(again, MergeCounts::default(), "seed {seed}: nothing is new");
            }
        }
        let expected = said(&ab);
        assert_eq!(said(&ba), expected, "seed {seed}: in the other order");
        a.merge_from(&b).expect("merged");
        b.merge_from(&a).expect("and back");
        for store in [&a, &b] {
            whole(store, &format!("seed {seed}: into each other"));
            assert_eq!(said(store), expected, "seed {seed}: into each other");
        }
        assert_eq!(
            ab.conflicts().expect("looked").len(),
            b.conflicts().expect("looked").len()
        );
    }
}

/// A file with one fault, and a copy of it on another laptop.
fn shared_fault(dir: &TempDir) -> (Store, Store, Id) {
    let (a, b) = (laptop(dir, "a.db", 1), laptop(dir, "b.db", 2));
    let stored = one_fault(&a, T0_US);
    b.merge_from(&a).expect("merged");
    (a, b, stored)
}

fn one_fault(store: &Store, at_us: i64) -> Id {
    failed_run(store, &run_record("ATC-7"), &[], &[fault(1, at_us)]).1[0]
}

/// Goal: what two people did to a fault without knowing of each other is shown, with the state that leaves
/// the most to do standing, whatever their clocks say, until one of them has looked again.
#[test]
fn conflicting_events_are_kept_and_listed_until_resolved() {
    let dir = tempdir().expect("a directory");
    let (a, b, fault) = shared_fault(&dir);
    a.put_acknowledged(fault, "kim", "mine", T0_US + 10);
    b.put_state(fault, FaultState::Closed, "lee", "not a fault", T0_US + 900);
    assert_eq!(a.conflicts().expect("looked"), [], "nobody knows yet");
    a.merge_from(&b).expect("merged");
    b.merge_from(&a).expect("merged");
    for store in [&a, &b] {
        let [conflict] = &store.conflicts().expect("looked")[..] else {
            panic!("one conflict");
        };
        assert_eq!((conflict.fault, &conflict.unit[..]), (fault, "ATC-7"));
        assert_eq!(conflict.stands, FaultState::Acknowledged);
        let rivals: Vec<_> = conflict
            .rivals
            .iter()
            .map(|rival| (&rival.who[..], rival.state, rival.at_us))
            .collect();
        let expected = [
            ("kim", FaultState::Acknowledged, T0_US + 10),
            ("lee", FaultState::Closed, T0_US + 900),
        ];
        assert_eq!(rivals, expected);
        assert_eq!(state(store, fault), FaultState::Acknowledged);
        whole(store, "with a conflict");
    }
    // Later by turn, whatever the clock says.
    b.set_state(
        fault,
        FaultState::Closed,
        "lee",
        "we have talked",
        T0_US + 5,
    )
    .expect("acknowledged may be closed");
    a.merge_from(&b).expect("merged");
    for store in [&a, &b] {
        assert_eq!(store.conflicts().expect("looked"), []);
        assert_eq!(state(store, fault), FaultState::Closed);
    }
}

/// Goal: who did more does not win over who knew nothing of it. Method: on one laptop a fault is repaired; on
/// another it is taken and closed, and both meet in either order.
#[test]
fn the_number_of_events_does_not_decide_a_conflict() {
    let dir = tempdir().expect("a directory");
    let (a, b, fault) = shared_fault(&dir);
    act(&b, fault, 1, T0_US + 10).expect("repaired");
    a.put_acknowledged(fault, "kim", "", T0_US + 20);
    a.put_state(fault, FaultState::Closed, "kim", "not found", T0_US + 30);
    a.merge_from(&b).expect("merged");
    b.merge_from(&a).expect("merged");
    for store in [&a, &b] {
        let [conflict] = &store.conflicts().expect("looked")[..] else {
            panic!("one conflict");
        };
        assert_eq!(conflict.stands, FaultState::Repaired);
        let rivals: Vec<_> = conflict.rivals.iter().map(|rival| rival.state).collect();
        assert_eq!(rivals, [FaultState::Repaired, FaultState::Closed]);
        assert_eq!(state(store, fault), FaultState::Repaired);
        whole(store, "with a conflict");
    }
}

/// An acknowledgement is not in conflict with a later occurrence.
#[test]
fn an_occurrence_conflicts_only_with_a_resolution() {
    let dir = tempdir().expect("a directory");
    let (a, b, fault) = shared_fault(&dir);
    act(&a, fault, 1, T0_US + 10).expect("repaired");
    b.merge_from(&a).expect("merged");
    for store in [&a, &b] {
        assert_eq!(one_fault(store, T0_US + HOUR_US), fault, "it is open again");
    }
    a.put_acknowledged(fault, "kim", "mine", T0_US + 2 * HOUR_US);
    a.merge_from(&b).expect("merged");
    assert_eq!(a.conflicts().expect("looked"), []);
    assert_eq!(state(&a, fault), FaultState::Acknowledged);
    whole(&a, "taken");
}

/// Goal: a repair that did not hold is found out in whatever order three laptops meet, although another one has
/// closed the fault since, without knowing of either. Method: repaired on the first day, seen on the third, closed
/// on the fifth; all orders.
#[test]
fn a_recurrence_between_two_resolutions_is_found_in_any_order() {
    const DAY_US: i64 = 24 * HOUR_US;
    let dir = tempdir().expect("a directory");
    let (a, b, fault) = shared_fault(&dir);
    let c = laptop(&dir, "c.db", 3);
    c.merge_from(&a).expect("merged");
    act(&a, fault, 1, T0_US + DAY_US).expect("repaired");
    act(&b, fault, 5, T0_US + 5 * DAY_US).expect("closed");
    one_fault(&c, T0_US + 3 * DAY_US);
    let orders = [
        [&a, &b, &c],
        [&a, &c, &b],
        [&b, &a, &c],
        [&b, &c, &a],
        [&c, &a, &b],
        [&c, &b, &a],
    ];
    let mut expected = None;
    for (n, order) in (0..).zip(orders) {
        let met = laptop(&dir, &format!("met-{n}.db"), 10 + n);
        for from in order {
            met.merge_from(from).expect("merged");
        }
        assert_eq!(state(&met, fault), FaultState::Open, "order {n}");
        assert_eq!(met.conflicts().expect("looked").len(), 1, "order {n}");
        whole(&met, "met");
        let said = said(&met);
        assert_eq!(
            expected.get_or_insert_with(|| said.clone()),
            &said,
            "order {n}"
        );
    }
}

/// Goal: a fault that was seen after somebody was done with it is open, also when the two did not know of each
/// other, and whether or not they knew that it was the same fault. Method: two laptops, with and without a
/// shared beginning; one is done on the fifth day, the other sees it before or after that; either takes in the
/// other first.
#[test]
fn a_fault_that_occurred_after_its_resolution_is_open_after_a_merge() {
    const DAY_US: i64 = 24 * HOUR_US;
    for (shared, done, seen_on, expected) in [
        (true, FaultState::Repaired, 4, FaultState::Repaired),
        (true, FaultState::Repaired, 6, FaultState::Open),
        (true, FaultState::Closed, 4, FaultState::Closed),
        (true, FaultState::Closed, 6, FaultState::Open),
        (false, FaultState::Repaired, 4, FaultState::Repaired),
        (false, FaultState::Repaired, 6, FaultState::Open),
    ] {
        let case = format!("shared: {shared}, {done} on day 5, seen on day {seen_on}");
        let dir = tempdir().expect("a directory");
        let (a, b) = (laptop(&dir, "a.db", 1), laptop(&dir, "b.db", 2));
        let fault = one_fault(&a, T0_US);
        if shared {
            b.merge_from(&a).expect("merged");
        }
        let how = if done == FaultState::Repaired { 1 } else { 5 };
        act(&a, fault, how, T0_US + 5 * DAY_US).expect("done");
        one_fault(&b, T0_US + seen_on * DAY_US);
        a.merge_from(&b).expect("merged");
        b.merge_from(&a).expect("merged");
        assert_eq!(said(&a), said(&b), "{case}");
        for store in [&a, &b] {
            let [fault] = faults(store)[..] else {
                panic!("{case}: one fault");
            };
            assert_eq!(state(store, fault), expected, "{case}");
            assert_eq!(store.conflicts().expect("looked"), [], "{case}");
            whole(store, &case);
        }
    }
}

/// Two concurrent events that lead to the same state are no conflict.
#[test]
fn two_concurrent_events_with_the_same_state_are_no_conflict() {
    let dir = tempdir().expect("a directory");
    let (a, b, fault) = shared_fault(&dir);
    for store in [&a, &b] {
        store.put_acknowledged(fault, "kim", "", T0_US + 10);
    }
    a.merge_from(&b).expect("merged");
    assert_eq!(a.conflicts().expect("looked"), []);
    assert_eq!(state(&a, fault), FaultState::Acknowledged);
}

/// Goal: a fault two laptops saw has one history here, and both its names lead to it: what the other
/// laptop does later under its name is done to it, and a person finds it by either.
#[test]
fn a_merged_fault_is_found_by_either_id() {
    let dir = tempdir().expect("a directory");
    let (a, b) = (laptop(&dir, "a.db", 1), laptop(&dir, "b.db", 2));
    let (ours, theirs) = (one_fault(&a, T0_US), one_fault(&b, T0_US + 5));
    a.merge_from(&b).expect("merged");
    for asked in [
        theirs.to_string(),
        theirs.short(),
        theirs.to_string()[..25].to_owned(),
    ] {
        assert_eq!(a.resolve_fault(&asked).ok(), Some(ours), "{asked}");
    }
    a.put_note(theirs, "kim", "by its other name", T0_US + 20);
    // The other file does not know of the merge; the fault is closed there.
    b.put_state(theirs, FaultState::Closed, "lee", "", T0_US + 30);
    a.merge_from(&b).expect("merged");
    assert_eq!(faults(&a), [ours]);
    assert_eq!(state(&a, ours), FaultState::Closed);
    whole(&a, "joined");
}

/// Goal: a laptop that does not know that a fault was closed does not merge the next one into it.
#[test]
fn an_older_copy_does_not_absorb_the_next_fault() {
    let dir = tempdir().expect("a directory");
    let (a, b, first) = shared_fault(&dir);
    b.put_state(first, FaultState::Closed, "lee", "", T0_US + 10);
    let next = one_fault(&b, T0_US + HOUR_US);
    assert_ne!(first, next);
    a.merge_from(&b).expect("merged");
    assert_eq!(
        (state(&a, first), state(&a, next)),
        (FaultState::Closed, FaultState::Open)
    );
    whole(&a, "two faults");
}

/// Goal: a copy that went on by itself, under the same name, has runs in the same places of the chain; all
/// of them are kept, and each is sealed.
#[test]
fn a_forked_copy_is_merged_with_all_its_runs() {
    let dir = tempdir().expect("a directory");
    let a = laptop(&dir, "a.db", 1);
    one_fault(&a, T0_US);
    let copy: PathBuf = dir.path().join("copy.db");
    a.backup(&copy).expect("copied");
    let b = open_as(&copy, 2);
    one_fault(&a, T0_US + 1);
    one_fault(&b, T0_US + 2);
    one_fault(&b, T0_US + 3);
    let home = a.merge_from(&b).expect("merged");
    let copy = home.copy.clone().expect("it is named");
    assert_eq!((home.runs, copy.went_on, copy.after), (2, true, 3));
    whole(&a, "with the copy's runs");
    let again = MergeCounts {
        copy: home.copy,
        ..MergeCounts::default()
    };
    assert_eq!(a.merge_from(&b).expect("merged"), again);
}

/// Goal: a run that is over here stays as it was sealed, whatever another file says of it; it is named, and the
/// rest comes.
/// Method: a copy is changed by hand in each of several ways, and goes on with a run of its own.
#[test]
fn a_copy_that_was_changed_by_hand_changes_no_run_here() {
    for [what, sql] in rows(include_str!("merging/changed_copies.txt")) {
        let dir = tempdir().expect("a directory");
        let a = laptop(&dir, "a.db", 1);
        let altered = measured_run(&a);
        let copy = dir.path().join("copy.db");
        a.backup(&copy).expect("copied");
        change(&copy, sql);
        let b = open_as(&copy, 2);
        one_fault(&b, T0_US + 1);
        let before = a.run(altered).expect("there");
        let added = a.merge_from(&b).expect("merged");
        let named: Vec<_> = (added.different.iter().map(|run| (run.what, run.id))).collect();
        assert_eq!(named, [("run", altered)], "{what}");
        assert_eq!((added.runs, added.steps), (1, 0), "{what}");
        assert_eq!(a.run(altered).expect("there"), before, "{what}");
        assert_eq!(faults(&a).len(), 1, "{what}");
        whole(&a, what);
        // The other way round nothing is added to theirs either, but for a verdict that is missing there.
        let back = b.merge_from(&a).expect("and back");
        assert_eq!((back.runs, back.steps), (0, 0), "{what}");
        let named: Vec<_> = back.different.iter().map(|run| run.id).collect();
        if what == "a verdict taken away" {
            assert_eq!(named, [], "it has it again");
            let again = b.merge_from(&a).expect("again");
            assert_eq!(again, MergeCounts::default());
        } else {
            assert_eq!(named, [altered], "{what}");
        }
    }
}

/// Goal: a file that was changed and rid of its seals and its name is not gone on with, and its run is named.
#[test]
fn a_changed_file_without_seals_and_id_gets_no_new_chain() {
    let dir = tempdir().expect("a directory");
    let a = laptop(&dir, "a.db", 1);
    let altered = measured_run(&a);
    let copy = dir.path().join("copy.db");
    a.backup(&copy).expect("copied");
    change(
        &copy,
        "UPDATE run SET verdict = 'passed'; DELETE FROM seal; DELETE FROM about WHERE key = 'file_id'",
    );
    let nameless = Store::open(&copy, OpenOptions::new(ids(2)));
    refused!(nameless, StoreError::Altered { .. });
    let added = a.import(&copy).expect("merged");
    let named: Vec<_> = added.different.iter().map(|run| run.id).collect();
    assert_eq!((named, added.runs), (vec![altered], 0));
    whole(&a, "as it was");
}

/// Goal: what is less is not different: a run copied while it was under way, and its own file meeting that copy
/// again.
#[test]
fn an_earlier_copy_of_a_run_is_not_different() {
    let dir = tempdir().expect("a directory");
    let (a, b) = (laptop(&dir, "a.db", 1), laptop(&dir, "b.db", 2));
    let mut writer = RunWriter::begin(&a, &run_record("ATC-7")).expect("begun");
    writer.fault(&fault(1, T0_US)).expect("stored");
    b.merge_from(&a).expect("in the middle");
    writer.step(step(0)).expect("kept");
    writer.fault(&fault(1, T0_US + 1)).expect("stored");
    writer.finish(&end(Verdict::Failed)).expect("finished");
    let met = a.merge_from(&b).expect("the earlier copy");
    assert_eq!(met, MergeCounts::default());
    let rest = b.merge_from(&a).expect("the rest");
    assert_eq!((rest.steps, rest.occurrences), (1, 1));
    assert_eq!(b.merge_from(&a).expect("again"), MergeCounts::default());
    whole(&a, "where it was recorded");
    whole(&b, "in two parts");
}

/// Goal: the seal of a run never comes to a file that has another end of this run.
/// Method: a run is copied while it is under way, and ended by hand in the copy.
#[test]
fn the_seal_of_a_run_that_ended_otherwise_here_is_left_out() {
    let dir = tempdir().expect("a directory");
    let (a, b) = (laptop(&dir, "a.db", 1), laptop(&dir, "b.db", 2));
    let mut writer = RunWriter::begin(&a, &run_record("ATC-7")).expect("begun");
    writer.step(step(0)).expect("kept");
    b.merge_from(&a).expect("in the middle");
    change(b.path(), "UPDATE run SET verdict = 'passed'");
    writer.finish(&end(Verdict::Failed)).expect("finished");
    let met = b.merge_from(&a).expect("merged");
    let named: Vec<_> = met.different.iter().map(|run| run.id).collect();
    assert_eq!(named, [writer.id()]);
    let conn = Connection::open(b.path()).expect("opens");
    let of_other = "SELECT count(*) FROM seal WHERE what = 'run' AND says NOT LIKE '%found%'";
    let seals: i64 = conn
        .query_row(of_other, [], |row| row.get(0))
        .expect("a count");
    assert_eq!(seals, 0);
}

/// A run with a step, a measurement and a fault.
fn measured_run(store: &Store) -> Id {
    let seen = [fault(1, T0_US)];
    failed_run(store, &run_record("ATC-7"), &[measured_step(0)], &seen).0
}
