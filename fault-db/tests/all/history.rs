//! A unit's own history: what counts for a part, and what does not.

use crate::common::{self, Deeds, T0_US, end, failed_run, fault, open, recorded, repair_of, state};
use std::collections::BTreeMap;

use fault_db::{
    CauseRecord, ConfirmedCase, ConfirmedRepairs, FaultRecord, FaultState, Id, LOG_SOURCE,
    PartHistory, RepairsOf, RunEnd, RunRecord, Store, Verdict,
};

const DAY_US: i64 = 86_400_000_000;
const RELAY: &str = "eb_relay";
const SENSOR: &str = "speed_sensor_1";

/// A run on a unit on a port.
fn run_record(serial: &str) -> RunRecord {
    RunRecord {
        source: "tcp:127.0.0.1:7000".into(),
        ..common::run_record(serial)
    }
}

/// A store with a run a day, the days counted from 1.
struct History {
    store: Store,
    _folder: tempfile::TempDir,
}

impl History {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder for the test");
        Self {
            store: open(&folder.path().join("history.db")),
            _folder: folder,
        }
    }

    /// A run on a unit that sees these faults.
    fn run(&self, day: i64, record: RunRecord, faults: &[FaultRecord]) -> (Id, Vec<Id>) {
        let record = RunRecord {
            started_at_us: T0_US + day * DAY_US,
            ..record
        };
        failed_run(&self.store, &record, &[], faults)
    }

    fn repair(&self, fault: Id, part: &str, day: i64) {
        let repair = repair_of(part, "", "N-2", "");
        let at_us = T0_US + day * DAY_US + DAY_US / 2;
        self.store.put_repair(fault, &repair, "kim", at_us);
    }

    /// A run of that day passes, and proves the repairs of these faults.
    fn confirm(&self, unit: &str, faults: &[Id], day: i64) {
        let end = RunEnd {
            finished_at_us: T0_US + day * DAY_US,
            ..end(Verdict::Passed)
        };
        let (run, _) = recorded(&self.store, &run_record(unit), &[], &[], &end);
        let proven: Vec<_> = faults.iter().map(|id| (*id, String::new())).collect();
        let confirmed = self.store.confirm_repairs(run, &proven);
        assert_eq!(confirmed.expect("confirmed"), faults);
    }

    /// Confirmed repairs of the relay before a day.
    fn relays(&self, day: i64) -> ConfirmedRepairs {
        let counted = self.store.confirmed_repairs(repairs_of("default", day));
        let counted = counted.expect("counts");
        counted.get(RELAY).copied().unwrap_or_default()
    }

    /// History of a part before the run of that day, over the 90 days before.
    fn part(&self, part: &str, day: i64) -> PartHistory {
        let before_us = T0_US + day * DAY_US;
        let span = (before_us - 90 * DAY_US, before_us);
        let parts = self.store.part_history("U-1", span, None).expect("history");
        parts.get(part).cloned().unwrap_or_default()
    }
}

fn naming(lru: &str, day: i64) -> FaultRecord {
    let at_us = T0_US + day * DAY_US + 60_000_000;
    FaultRecord {
        lru: lru.into(),
        message: format!("on day {day}"),
        ..fault(230, at_us)
    }
}

fn log_of_unit() -> RunRecord {
    RunRecord {
        source: format!("{LOG_SOURCE}tcp:127.0.0.1:7000"),
        ..run_record("U-1")
    }
}

#[test]
fn runs_count_once_each_and_only_those_of_the_unit_before_and_not_too_old() {
    let history = History::new();
    history.run(1, run_record("U-1"), &[naming(RELAY, 1)]);
    history.run(2, run_record("U-1"), &[naming(RELAY, 2), naming(RELAY, 2)]);
    history.run(3, run_record("U-1"), &[naming(SENSOR, 3)]);
    history.run(3, run_record("U-2"), &[naming(RELAY, 3)]);
    history.run(4, run_record("U-1"), &[]);
    history.run(9, run_record("U-1"), &[naming(RELAY, 9)]);
    assert_eq!(history.part(RELAY, 5).runs, 2);
    assert_eq!(history.part(SENSOR, 5).runs, 1);
    assert_eq!(history.part(RELAY, 10).runs, 3);
    assert_eq!(history.part(RELAY, 92).runs, 2, "day 1 is 91 days ago");
    assert_eq!(history.part(RELAY, 200).runs, 0);
}

#[test]
fn the_run_itself_does_not_count() {
    let history = History::new();
    let (run, _) = history.run(1, run_record("U-1"), &[naming(RELAY, 1)]);
    let span = (T0_US, T0_US + 2 * DAY_US);
    let parts = history.store.part_history("U-1", span, Some(run));
    let parts = parts.expect("history");
    assert!(parts.is_empty(), "{parts:?}");
}

#[test]
fn an_imported_entry_that_a_run_saw_too_does_not_count_again() {
    let history = History::new();
    history.run(1, run_record("U-1"), &[naming(RELAY, 1)]);
    history.run(2, log_of_unit(), &[naming(RELAY, 1)]);
    assert_eq!(history.part(RELAY, 5).runs, 1);
    // Two testers read the same log, and their files were merged.
    history.run(3, log_of_unit(), &[naming(SENSOR, 2)]);
    history.run(4, log_of_unit(), &[naming(SENSOR, 2)]);
    assert_eq!(history.part(SENSOR, 5).runs, 1);
    history.run(4, log_of_unit(), &[naming(SENSOR, 4)]);
    assert_eq!(history.part(SENSOR, 5).runs, 2);
}

#[test]
fn a_repair_restarts_the_count_and_a_fault_that_comes_back_shows_that_it_failed() {
    let history = History::new();
    let (_, faults) = history.run(1, run_record("U-1"), &[naming(RELAY, 1)]);
    history.repair(faults[0], "EB_relay ", 1);
    let part = history.part(RELAY, 3);
    let repair = part.repair.as_ref().expect("a repair");
    assert_eq!(part.runs, 0, "the part that failed is out");
    assert!(repair.replaced && !repair.came_back, "{repair:?}");
    assert!(repair.faults.contains(&(230, RELAY.to_owned())));

    // Another fault of the unit says nothing of that repair.
    history.run(4, run_record("U-1"), &[naming(SENSOR, 4)]);
    assert_eq!(history.part(RELAY, 5), part);
    history.run(6, run_record("U-1"), &[naming(RELAY, 6)]);
    let part = history.part(RELAY, 7);
    assert_eq!(part.runs, 1);
    assert!(part.repair.expect("a repair").came_back);
}

/// A part replaced for a fault that names another part.
#[test]
fn a_repair_counts_for_the_part_that_was_replaced() {
    let history = History::new();
    let (_, faults) = history.run(1, run_record("U-1"), &[naming("unknown", 1)]);
    history.repair(faults[0], SENSOR, 1);
    history.run(3, run_record("U-1"), &[naming("unknown", 3)]);
    let part = history.part(SENSOR, 4);
    assert_eq!(part.runs, 0);
    assert!(part.repair.expect("a repair").came_back);
}

/// A log is read late: an entry older than the repair does not undo it.
#[test]
fn an_old_entry_does_not_reopen_a_repaired_fault() {
    let history = History::new();
    let (_, faults) = history.run(1, run_record("U-1"), &[naming(RELAY, 1)]);
    history.repair(faults[0], RELAY, 5);
    history.run(6, log_of_unit(), &[naming(RELAY, 4)]);
    assert_eq!(state(&history.store, faults[0]), FaultState::Repaired);
    history.run(7, log_of_unit(), &[naming(RELAY, 6)]);
    assert_eq!(state(&history.store, faults[0]), FaultState::Open);
}

#[test]
fn occurrences_and_times_under_test_are_known() {
    let history = History::new();
    history.run(0, run_record("U-1"), &[naming(RELAY, 0)]);
    history.run(1, common::run_record("U-1"), &[]);
    history.run(2, log_of_unit(), &[]);
    let spans = history.store.tested_spans("U-1").expect("spans");
    assert_eq!(spans, [(T0_US, T0_US + 5_000_000)]);
    let at_us = naming(RELAY, 0).at_us;
    let known = |unit, code, message, at_us| {
        let known = history.store.knows_occurrence(unit, (code, message), at_us);
        known.expect("an answer")
    };
    assert!(known("U-1", 230, "on day 0", Some(at_us + 3_000_000)));
    let timeless = known("U-1", 230, "on day 0", None);
    assert!(timeless, "of a clock that tells nothing");
    assert!(!known("U-1", 230, "on day 0", Some(at_us + 30_000_000)));
    assert!(!known("U-1", 231, "on day 0", Some(at_us)));
    assert!(!known("U-1", 230, "on day 1", Some(at_us)));
    assert!(!known("U-2", 230, "on day 0", Some(at_us)));
}

/// Confirmed repairs of real units before a day.
fn repairs_of(unit_type: &str, day: i64) -> RepairsOf<'_> {
    RepairsOf {
        before_us: T0_US + day * DAY_US,
        unit_type,
        practice: false,
    }
}

/// Goal: one repair of one unit is counted once however many faults it was for and however often it was written down, and
/// only when a run has shown it to help.
#[test]
fn confirmed_repairs_are_counted_by_part_and_those_in_vain_are_not() {
    let history = History::new();
    let faults = |day| [naming(RELAY, day), naming(SENSOR, day)];
    let (run, opened) = history.run(1, run_record("U-1"), &faults(1));
    for fault in opened.iter().cycle().take(60) {
        history.repair(*fault, RELAY, 1);
    }
    assert_eq!(history.relays(2).repairs, 0, "nobody has verified it");
    history.confirm("U-1", &opened, 2);
    assert_eq!([2, 3].map(|day| history.relays(day).repairs), [0, 1]);
    let of_others = history
        .store
        .confirmed_repairs(repairs_of("another type", 3));
    assert!(of_others.expect("counts").is_empty());
    let cases = history.store.confirmed_cases(repairs_of("default", 3), 9);
    let case = ConfirmedCase {
        part: RELAY.to_owned(),
        run,
        unit: "U-1".to_owned(),
    };
    assert_eq!(cases.expect("cases"), [case]);
    history.run(4, run_record("U-1"), &faults(4));
    let then = history.relays(5);
    assert_eq!((then.repairs, then.in_vain), (0, 1), "it came back");
}

/// Goal: nothing is learnt from a claim: a state set by hand, a repair of two parts at once, practice.
#[test]
fn claims_are_not_learnt_from() {
    let repaired = |record: RunRecord, parts: &[&str]| {
        let history = History::new();
        let (_, opened) = history.run(1, record, &[naming(RELAY, 1)]);
        for part in parts {
            history.repair(opened[0], part, 1);
        }
        (history, opened)
    };
    let practised = |change: fn(&mut RunRecord)| {
        let mut record = run_record("U-1");
        change(&mut record);
        let (history, opened) = repaired(record, &[RELAY]);
        history.confirm("U-1", &opened, 2);
        let all = RepairsOf {
            practice: true,
            ..repairs_of("default", 3)
        };
        let all = history.store.confirmed_repairs(all).expect("counts");
        assert_eq!(all[RELAY].repairs, 1, "practice learns from practice");
        history.relays(3).repairs
    };
    assert_eq!(practised(|run| run.source = "sim".into()), 0);
    assert_eq!(practised(|run| run.source = "lockstep:unit".into()), 0);
    let injected = practised(|run| run.injected = Some("eb_relay.slow".into()));
    assert_eq!(injected, 0);

    let (history, opened) = repaired(run_record("U-1"), &[RELAY]);
    let at_us = T0_US + 2 * DAY_US;
    history
        .store
        .put_state(opened[0], FaultState::Verified, "kim", "", at_us);
    assert_eq!(history.relays(3).repairs, 0, "by hand");

    let (history, opened) = repaired(run_record("U-1"), &[SENSOR, RELAY]);
    history.confirm("U-1", &opened, 2);
    assert_eq!(history.relays(3).repairs, 0, "which of the two helped?");
}

/// Goal: it can be seen how often the part that a diagnosis found was the one whose repair helped.
/// Method: of three units whose faults were attributed to the relay, two have the relay repaired, one the sensor.
#[test]
fn parts_found_by_a_diagnosis_are_compared_with_those_repaired() {
    let history = History::new();
    for (unit, repaired) in [("U-1", RELAY), ("U-2", SENSOR), ("U-3", RELAY)] {
        let (run, opened) = history.run(1, run_record(unit), &[naming(SENSOR, 1)]);
        let cause = CauseRecord {
            part: RELAY.into(),
            run: Some(run.to_string()),
            probability: Some(0.97),
            note: String::new(),
        };
        let at_us = T0_US + DAY_US + 1;
        history.store.put_diagnosed(&opened, &cause, at_us);
        history.repair(opened[0], repaired, 1);
        history.confirm(unit, &opened, 2);
    }
    let counted = history.store.confirmed_repairs(repairs_of("default", 3));
    let of = |repairs, named, right| ConfirmedRepairs {
        repairs,
        named,
        right,
        in_vain: 0,
    };
    let relay = (RELAY.to_owned(), of(2, 3, 2));
    let sensor = (SENSOR.to_owned(), of(1, 0, 0));
    assert_eq!(counted.expect("counts"), BTreeMap::from([relay, sensor]));
}
