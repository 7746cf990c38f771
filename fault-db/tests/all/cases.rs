//! Cases: faults that one part explains are repaired, proven and counted as one.

use std::collections::BTreeSet;

use crate::common::{
    Deeds, T0_US, confirm_passed, end, fault, filter, open, open_as, problems, recorded, repair_of,
    rows, run_record, step, with,
};
use fault_db::{
    CauseRecord, FaultFilter, FaultRecord, FaultStat, FaultState, Id, RepairRecord, StatKey,
    StatQuery, StepRecord, Store, Verdict,
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

/// A run of one step that sees these faults, or passes.
fn run(store: &Store, faults: &[FaultRecord]) -> Vec<Id> {
    run_of("ATC-1", store, faults)
}

fn run_of(unit: &str, store: &Store, faults: &[FaultRecord]) -> Vec<Id> {
    let verdict = match faults {
        [] => Verdict::Passed,
        _ => Verdict::Failed,
    };
    let of_step = StepRecord { verdict, ..step(3) };
    let (run, seen) = recorded(store, &run_record(unit), &[of_step], faults, &end(verdict));
    confirm_passed(store, run, 1);
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
    let faults = [
        named(1, "eb_relay", Some(3), T0_US),
        named(2, "atp_cpu", Some(3), T0_US + 1),
        named(3, "io_board", None, T0_US + 2),
        named(4, "door_switch", Some(3), T0_US + 3),
    ];
    let seen = run(&store, &faults);
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

    let at_us = T0_US + DAY_US;
    let (first, rest) = store.put_case_repair(faults[1], &repair("eb_relay"), "kim", at_us);
    let settled: Vec<Id> = rest.iter().map(|fault| fault.id).collect();
    assert_eq!((first.id, settled), (faults[1], vec![faults[0], faults[2]]));
    let all = || states(&store, &faults);
    assert_eq!(all(), ["repaired", "repaired", "repaired", "open"]);

    run(&store, &[]);
    assert_eq!(all(), ["verified", "verified", "verified", "open"]);
    let events = store.fault(faults[2]).expect("there").events;
    let proof = events.iter().find(|event| event.kind == "confirmed");
    let proof = &proof.expect("confirmed").note;
    assert!(
        proof.contains("with fault"),
        "{proof}: no step of its own proves it"
    );

    // One comes back: it is open again, and what is closed with the others is not it.
    run(&store, &[named(3, "io_board", None, T0_US + 9 * DAY_US)]);
    assert_eq!(all(), ["verified", "verified", "open", "open"]);
    let closed = store.set_case_state(faults[0], FaultState::Closed, "kim", "", T0_US);
    assert_eq!(closed.expect("closed").1.len(), 1);
    assert_eq!(all(), ["closed", "closed", "open", "open"]);
    assert_eq!(problems(&store), []);
}

#[test]
fn a_fault_is_changed_alone_if_that_is_asked() {
    let folder = tempdir().expect("a folder");
    let (store, faults) = slow_relay(&folder);
    store.put_repair(faults[0], &repair("eb_relay"), "kim", T0_US + DAY_US);
    let all = || states(&store, &faults);
    assert_eq!(all(), ["repaired", "open", "open", "open"]);
    // The consequences were not repaired: the proof of the cause says nothing of them.
    run(&store, &[]);
    assert_eq!(all(), ["verified", "open", "open", "open"]);
}

/// While another fault that names the cause is left, what no step saw is not proven.
#[test]
fn a_consequence_is_proven_only_with_all_faults_that_name_its_cause() {
    let folder = tempdir().expect("a folder");
    let (store, faults) = slow_relay(&folder);
    let other = run(&store, &[named(5, "eb_relay", Some(7), T0_US + 5)]);
    store.put_diagnosed(&other, &from("eb_relay"), T0_US + 6);
    store.put_case_repair(faults[0], &repair("eb_relay"), "kim", T0_US + DAY_US);
    run(&store, &[]);
    let all = states(&store, &faults);
    assert_eq!(all, ["verified", "verified", "repaired", "open"]);
    assert_eq!(states(&store, &other), ["repaired"], "its step was not run");
}

/// Statements of people and diagnoses on two laptops about one fault, in the order in which it is said on each, and
/// what holds where they meet, in either order.
#[test]
fn a_person_s_word_stands_before_any_diagnosis_wherever_files_meet() {
    for [here, there, holds] in rows(include_str!("cases/who_says.txt")) {
        let folder = tempdir().expect("a folder");
        let laptop = |name: &str, seed| open_as(&folder.path().join(name), seed);
        let (a, b) = (laptop("a.db", 1), laptop("b.db", 2));
        // Each laptop saw it by itself and gave it an id of its own.
        for (store, said) in [(&a, here), (&b, there)] {
            let seen = run(store, &[named(3, "twc_cpu", Some(3), T0_US)]);
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
            let cause = holds.unwrap_or("TWC_cpu").to_owned();
            let asked = filter(|it| it.cause = Some(cause));
            assert_eq!(store.faults(&asked).expect("listed").len(), 1, "{asked:?}");
            assert_eq!(problems(store), []);
        }
    }
}

/// What is diagnosed again, closed, or said by a person already is not attributed anew.
#[test]
fn a_diagnosis_attributes_only_what_it_changes() {
    let folder = tempdir().expect("a folder");
    let (store, faults) = slow_relay(&folder);
    store.put_state(faults[3], FaultState::Closed, "kim", "", T0_US);
    let said = store.set_cause(faults[2], &from(""), "kim", T0_US);
    said.expect("said");
    let again = store.attribute_diagnosed(&faults, &from("eb_relay"), T0_US + 9);
    assert_eq!(again.expect("looked"), []);
    let detail = store.fault(faults[2]).expect("there");
    assert_eq!(detail.fault.cause(), "io_board");
}

/// A closed fault is settled: no case shows it, and no fault is shown with it. The same part of another unit is
/// another case.
#[test]
fn a_closed_fault_and_one_of_another_unit_are_in_no_case() {
    let folder = tempdir().expect("a folder");
    let (store, faults) = slow_relay(&folder);
    let other = [named(1, "eb_relay", Some(3), T0_US + 5)];
    let other = run_of("ATC-2", &store, &other);
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
    run(&store, &[]);
    let closed = store.set_case_state(faults[0], FaultState::Closed, "kim", "", T0_US + 2 * DAY_US);
    closed.expect("closed");
    // Later, again, and another with the same part that nobody has attributed.
    let later = T0_US + 50 * DAY_US;
    let faults = [
        named(2, "atp_cpu", Some(3), later),
        named(3, "io_board", None, later + 1),
        named(6, "eb_relay", None, later + 2),
    ];
    let again = run(&store, &faults);
    store.put_diagnosed(&again[..2], &from("eb_relay"), later + 3);
    let of_unit = with(|it: &mut FaultFilter| it.unit = Some("ATC-1".to_owned()));
    for filter in [FaultFilter::default(), of_unit] {
        let (stats, total) = by_cause(&store, filter);
        let told = |stat: &FaultStat| {
            let counts = [
                stat.faults,
                stat.not_closed,
                stat.closed,
                stat.no_fault_found,
            ];
            let repairs = [stat.repairs, stat.repairs_back];
            (stat.key.clone(), stat.occurrences, counts, repairs)
        };
        let of_relay = ("eb_relay".to_owned(), 6, [3, 2, 1, 0], [1, 0]);
        let of_door = ("door_switch".to_owned(), 1, [1, 1, 0, 0], [0, 0]);
        let of_parts: Vec<_> = stats.iter().map(told).collect();
        assert_eq!(of_parts, [of_relay, of_door]);
        let (_, _, counts, repairs) = told(&total);
        assert_eq!((counts, repairs), ([4, 3, 1, 0], [1, 0]));
        // Sorted by cases, counted from the opening: 1 day until the repair.
        assert_eq!(stats[0].mttr_hours.map(|hours| hours.round()), Some(24.0));
    }
    let in_span = filter(|it| {
        (it.since_us, it.cause) = (Some(later), Some("EB_RELAY".to_owned()));
    });
    let (stats, _) = by_cause(&store, in_span);
    let counts = (stats.len(), stats[0].faults, stats[0].occurrences);
    assert_eq!(counts, (1, 2, 3));
    // Packed and not packed.
    let before = by_cause(&store, FaultFilter::default());
    assert_eq!(store.rebuild(T0_US).expect("made anew"), [""; 0]);
    assert_eq!(by_cause(&store, FaultFilter::default()), before);
    let causes: BTreeSet<String> = store.known_causes().expect("listed").into_iter().collect();
    assert_eq!(causes.len(), 2, "{causes:?}");
}
