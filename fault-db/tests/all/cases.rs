//! Cases: faults that one part explains are repaired, proven and counted as one.

use std::collections::BTreeSet;

use crate::common::{Deeds, T0_US, end, fault, ids, open, repair_of, rows, run_record, step, with};
use fault_db::{
    CauseRecord, FaultFilter, FaultRecord, FaultStat, FaultState, Id, OpenOptions, RepairRecord,
    RunWriter, StatKey, StatQuery, Store, Verdict,
};
use tempfile::{TempDir, tempdir};

const DAY_US: i64 = 86_400_000_000;

fn named(code: i64, lru: &str, step_index: Option<u32>, at_us: i64) -> FaultRecord {
    FaultRecord {
        lru: lru.to_owned(),
        step_index,
        ..fault(code, at_us)
    }
}

/// A run of one step that sees these faults.
fn run(store: &Store, faults: &[FaultRecord], verdict: Verdict) -> Vec<Id> {
    run_of("ATC-1", store, faults, verdict)
}

fn run_of(unit: &str, store: &Store, faults: &[FaultRecord], verdict: Verdict) -> Vec<Id> {
    let mut writer = RunWriter::begin(store, &run_record(unit)).expect("begun");
    let mut of_run = step(3);
    of_run.verdict = verdict;
    writer.step(of_run).expect("kept");
    let seen = faults
        .iter()
        .map(|fault| writer.fault(fault).expect("stored").fault);
    let seen = seen.collect();
    writer.finish(&end(verdict)).expect("finished");
    let to_prove = store.repairs_to_prove(writer.id()).expect("read");
    let proven: Vec<_> = to_prove
        .iter()
        .map(|repair| (repair.fault, "by the test".to_owned()))
        .collect();
    store.confirm_repairs(writer.id(), &proven).expect("stored");
    seen
}

fn from(part: &str) -> CauseRecord {
    CauseRecord {
        part: part.to_owned(),
        probability: Some(0.97),
        ..CauseRecord::default()
    }
}

fn repair(part: &str) -> RepairRecord {
    repair_of(part, "", "SN-77", "")
}

fn states(store: &Store, faults: &[Id]) -> Vec<&'static str> {
    let state = |fault: &Id| store.fault(*fault).expect("there").fault.state.as_str();
    faults.iter().map(state).collect()
}

/// A slow relay in a run: its own fault, one that names the CPU in the same step, one that no step saw, and a door
/// that has nothing to do with it.
fn slow_relay(folder: &TempDir) -> (Store, Vec<Id>) {
    let store = open(&folder.path().join("a.db"));
    let seen = run(
        &store,
        &[
            named(1, "eb_relay", Some(3), T0_US),
            named(2, "atp_cpu", Some(3), T0_US + 1),
            named(3, "io_board", None, T0_US + 2),
            named(4, "door_switch", Some(3), T0_US + 3),
        ],
        Verdict::Failed,
    );
    let attributed = store.attribute_diagnosed(&seen[..3], &from("eb_relay"), T0_US + 4);
    assert_eq!(attributed.expect("attributed"), seen[..3]);
    (store, seen)
}

#[test]
fn a_repair_and_its_proof_settle_the_consequences_and_nothing_else() {
    let folder = tempdir().expect("a folder");
    let (store, faults) = slow_relay(&folder);
    let detail = store.fault(faults[1]).expect("there");
    assert_eq!(detail.fault.cause(), "eb_relay");
    let case: Vec<Id> = detail.case.iter().map(|other| other.id).collect();
    assert_eq!(case, [faults[0], faults[2]]);

    let (first, rest) =
        store.put_case_repair(faults[1], &repair("eb_relay"), "kim", T0_US + DAY_US);
    let settled: Vec<Id> = rest.iter().map(|fault| fault.id).collect();
    assert_eq!((first.id, settled), (faults[1], vec![faults[0], faults[2]]));
    assert_eq!(
        states(&store, &faults),
        ["repaired", "repaired", "repaired", "open"]
    );

    run(&store, &[], Verdict::Passed);
    assert_eq!(
        states(&store, &faults),
        ["verified", "verified", "verified", "open"]
    );
    let events = store.fault(faults[2]).expect("there").events;
    let proof = events.iter().find(|event| event.kind == "confirmed");
    let proof = &proof.expect("confirmed").note;
    assert!(
        proof.contains("with fault"),
        "{proof}: no step of its own proves it"
    );

    // One comes back: it is open again, and what is closed with the others is not it.
    run(
        &store,
        &[named(3, "io_board", None, T0_US + 9 * DAY_US)],
        Verdict::Failed,
    );
    assert_eq!(
        states(&store, &faults),
        ["verified", "verified", "open", "open"]
    );
    let closed = store.set_case_state(faults[0], FaultState::Closed, "kim", "", T0_US);
    assert_eq!(closed.expect("closed").1.len(), 1);
    assert_eq!(
        states(&store, &faults),
        ["closed", "closed", "open", "open"]
    );
    assert_eq!(store.check().expect("checked").problems, []);
}

#[test]
fn a_fault_is_changed_alone_if_that_is_asked() {
    let folder = tempdir().expect("a folder");
    let (store, faults) = slow_relay(&folder);
    store.put_repair(faults[0], &repair("eb_relay"), "kim", T0_US + DAY_US);
    assert_eq!(
        states(&store, &faults),
        ["repaired", "open", "open", "open"]
    );
    // The consequences were not repaired: the proof of the cause says nothing of them.
    run(&store, &[], Verdict::Passed);
    assert_eq!(
        states(&store, &faults),
        ["verified", "open", "open", "open"]
    );
}

/// While another fault that names the cause is left, what no step saw is not proven.
#[test]
fn a_consequence_is_proven_only_with_all_faults_that_name_its_cause() {
    let folder = tempdir().expect("a folder");
    let (store, faults) = slow_relay(&folder);
    let other = run(
        &store,
        &[named(5, "eb_relay", Some(7), T0_US + 5)],
        Verdict::Failed,
    );
    store.put_diagnosed(&other, &from("eb_relay"), T0_US + 6);
    store.put_case_repair(faults[0], &repair("eb_relay"), "kim", T0_US + DAY_US);
    run(&store, &[], Verdict::Passed);
    assert_eq!(
        states(&store, &faults),
        ["verified", "verified", "repaired", "open"]
    );
    assert_eq!(states(&store, &other), ["repaired"], "its step was not run");
}

/// Statements of people and diagnoses on two laptops about one fault, in the order in which it is said on each, and
/// what holds where they meet, in either order.
#[test]
fn a_person_s_word_stands_before_any_diagnosis_wherever_files_meet() {
    for [here, there, holds] in rows(include_str!("cases/who_says.txt")) {
        let folder = tempdir().expect("a folder");
        let laptop = |name: &str, seed| {
            let options = OpenOptions::new(ids(seed));
            Store::open(&folder.path().join(name), options).expect("opens")
        };
        let (a, b) = (laptop("a.db", 1), laptop("b.db", 2));
        // Each laptop saw it by itself and gave it an id of its own.
        for (store, said) in [(&a, here), (&b, there)] {
            let seen = run(
                store,
                &[named(3, "twc_cpu", Some(3), T0_US)],
                Verdict::Failed,
            );
            for (turn, says) in (1..).zip(said.split(", ").filter(|says| *says != "-")) {
                let at_us = T0_US + turn;
                match says.split_once(' ').expect("who says which part") {
                    ("Run", part) => drop(store.put_diagnosed(&seen, &from(part), at_us)),
                    (_, part) => {
                        let part = part.trim_start_matches('-');
                        (store.set_cause(seen[0], &from(part), "kim", at_us)).expect("said");
                    }
                }
            }
        }
        let (ab, ba) = (laptop("ab.db", 3), laptop("ba.db", 4));
        for (store, order) in [(&ab, [&a, &b]), (&ba, [&b, &a])] {
            for other in order {
                store.merge_from(other).expect("merged");
            }
            let faults = store.faults(&FaultFilter::default()).expect("listed");
            let causes: Vec<_> = faults.iter().map(|fault| fault.cause.as_deref()).collect();
            let holds = Some(holds).filter(|part| *part != "-");
            assert_eq!(causes, [holds], "{here}; {there}");
            let asked = FaultFilter {
                cause: Some(holds.unwrap_or("TWC_cpu").to_owned()),
                ..FaultFilter::default()
            };
            assert_eq!(store.faults(&asked).expect("listed").len(), 1, "{asked:?}");
            assert_eq!(store.check().expect("checked").problems, []);
        }
    }
}

/// What is diagnosed again, closed, or said by a person already is not attributed anew.
#[test]
fn a_diagnosis_attributes_only_what_it_changes() {
    let folder = tempdir().expect("a folder");
    let (store, faults) = slow_relay(&folder);
    store.put_state(faults[3], FaultState::Closed, "kim", "", T0_US);
    store
        .set_cause(faults[2], &from(""), "kim", T0_US)
        .expect("said");
    let again = store.attribute_diagnosed(&faults, &from("eb_relay"), T0_US + 9);
    assert_eq!(again.expect("looked"), []);
    assert_eq!(
        store.fault(faults[2]).expect("there").fault.cause(),
        "io_board"
    );
}

/// A closed fault is settled: no case shows it, and no fault is shown with it. The same part of another unit is
/// another case.
#[test]
fn a_closed_fault_and_one_of_another_unit_are_in_no_case() {
    let folder = tempdir().expect("a folder");
    let (store, faults) = slow_relay(&folder);
    let other = [named(1, "eb_relay", Some(3), T0_US + 5)];
    let other = run_of("ATC-2", &store, &other, Verdict::Failed);
    store.put_diagnosed(&other, &from("eb_relay"), T0_US + 6);
    store.put_state(faults[2], FaultState::Closed, "kim", "", T0_US + DAY_US);
    let case = |fault: Id| {
        let case = store.fault(fault).expect("there").case;
        case.iter().map(|other| other.id).collect::<Vec<_>>()
    };
    assert_eq!(case(faults[0]), [faults[1]]);
    assert_eq!(case(faults[2]), [] as [Id; 0]);
    assert_eq!(case(faults[3]), [] as [Id; 0]);
}

fn by_cause(store: &Store, filter: FaultFilter) -> (Vec<FaultStat>, FaultStat) {
    let query = StatQuery {
        by: StatKey::Cause,
        filter,
        now_us: T0_US + 100 * DAY_US,
        back_within_days: 30,
    };
    store.stats_and_total(&query).expect("counted")
}

/// Goal: what one part explains is one case with one repair, and a case after it is another, whichever way counts:
/// packed, or row by row for one unit.
#[test]
fn causes_are_counted_by_cases() {
    let folder = tempdir().expect("a folder");
    let (store, faults) = slow_relay(&folder);
    store.put_case_repair(faults[0], &repair("eb_relay"), "kim", T0_US + DAY_US);
    run(&store, &[], Verdict::Passed);
    store
        .set_case_state(faults[0], FaultState::Closed, "kim", "", T0_US + 2 * DAY_US)
        .expect("closed");
    // Later, again, and another with the same part that nobody has attributed.
    let later = T0_US + 50 * DAY_US;
    let again = run(
        &store,
        &[
            named(2, "atp_cpu", Some(3), later),
            named(3, "io_board", None, later + 1),
            named(6, "eb_relay", None, later + 2),
        ],
        Verdict::Failed,
    );
    store.put_diagnosed(&again[..2], &from("eb_relay"), later + 3);
    let of_unit = with(|it: &mut FaultFilter| it.unit = Some("ATC-1".to_owned()));
    for filter in [FaultFilter::default(), of_unit] {
        let (stats, total) = by_cause(&store, filter);
        let told = |stat: &FaultStat| {
            let FaultStat {
                faults,
                not_closed,
                occurrences,
                closed,
                no_fault_found,
                repairs,
                repairs_back,
                ..
            } = stat;
            let counts = [
                faults,
                not_closed,
                closed,
                no_fault_found,
                repairs,
                repairs_back,
            ];
            (stat.key.clone(), *occurrences, counts.map(|count| *count))
        };
        assert_eq!(
            stats.iter().map(told).collect::<Vec<_>>(),
            [
                ("eb_relay".to_owned(), 6, [3, 2, 1, 0, 1, 0]),
                ("door_switch".to_owned(), 1, [1, 1, 0, 0, 0, 0]),
            ]
        );
        assert_eq!(told(&total).2, [4, 3, 1, 0, 1, 0]);
        // Sorted by cases, counted from the opening: 1 day until the repair.
        assert_eq!(stats[0].mttr_hours.map(|hours| hours.round()), Some(24.0));
    }
    let in_span = FaultFilter {
        since_us: Some(later),
        cause: Some("EB_RELAY".to_owned()),
        ..FaultFilter::default()
    };
    let (stats, _) = by_cause(&store, in_span);
    assert_eq!(
        (stats.len(), stats[0].faults, stats[0].occurrences),
        (1, 2, 3)
    );
    // Packed and not packed.
    let before = by_cause(&store, FaultFilter::default());
    assert_eq!(
        store.rebuild(T0_US).expect("made anew"),
        Vec::<String>::new()
    );
    assert_eq!(by_cause(&store, FaultFilter::default()), before);
    let causes: BTreeSet<String> = store.known_causes().expect("listed").into_iter().collect();
    assert_eq!(causes.len(), 2, "{causes:?}");
}
