//! Counts and lists that `counting_filters` does not hold against the rows.

use crate::common::{
    Deeds, Random, T0_US, failed_run, fault, new_history, open, repair_of, run_record,
};
use crate::counting_filters::{DAY_US, history};
use fault_db::{FaultFilter, RunFilter, RunRecord, RunWriter, StatKey, StatQuery, TrendQuery};
use tempfile::tempdir;

/// Goal: days of a measurement add up, whatever span is asked for: `counting_filters` counts faults. Method: all lines are those
/// of each line.
#[test]
fn days_of_a_measurement_on_all_lines_are_those_of_each() {
    let dir = tempdir().expect("a directory");
    for seed in 1..4 {
        let mut random = Random::new(seed);
        let store = open(&dir.path().join(format!("{seed}.db")));
        history(&store, &mut random);
        let mut within = || T0_US + (random.next() % (110 * DAY_US as u64)) as i64;
        let mut spans = vec![
            (None, None),
            (Some(T0_US), None),
            (None, Some(T0_US + 31 * DAY_US)),
        ];
        for _ in 0..25 {
            let (a, b) = (within(), within());
            spans.push((Some(a.min(b)), Some(a.max(b) + 1)));
        }
        for (since_us, until_us) in spans {
            let days = |line: Option<&str>| {
                let query = TrendQuery {
                    measurement: "eb_reaction".into(),
                    line: line.map(str::to_owned),
                    since_us,
                    until_us,
                    ..TrendQuery::default()
                };
                store.trend_by_day(&query).expect("read")
            };
            let (kept, one, other) = (days(None), days(Some("line-0")), days(Some("line-1")));
            let n = |days: &[fault_db::TrendDay]| days.iter().map(|day| day.n).sum::<u32>();
            assert_eq!(n(&kept), n(&one) + n(&other), "{since_us:?} {until_us:?}");
            let sum = |days: &[fault_db::TrendDay]| {
                days.iter()
                    .map(|day| f64::from(day.n) * day.mean)
                    .sum::<f64>()
            };
            assert!((sum(&kept) - sum(&one) - sum(&other)).abs() < 1e-9);
        }
    }
}

/// A repair that a laptop with a slow clock recorded took no less than no time.
#[test]
fn a_repair_dated_before_its_fault_took_no_time() {
    let (_dir, _, store) = new_history();
    let mut writer = RunWriter::begin(&store, &run_record("ATC-1")).expect("begun");
    let id = writer.fault(&fault(1, T0_US)).expect("stored").fault;
    let repair = repair_of("eb_relay", "", "", "");
    store.put_repair(id, &repair, "kim", T0_US - 30 * DAY_US);
    let query = StatQuery {
        by: StatKey::All,
        filter: FaultFilter::default(),
        now_us: T0_US + DAY_US,
        back_within_days: 30,
    };
    assert_eq!(
        store.stats(&query).expect("counted")[0].mttr_hours,
        Some(0.0)
    );
    assert!(store.check().expect("checked").problems.is_empty());
}

/// One occurrence has to meet all conditions of a list on occurrences.
#[test]
fn all_conditions_on_an_occurrence_apply_to_the_same_one() {
    let (_dir, _, store) = new_history();
    for (train, month) in [("T1", 0), ("T2", 2)] {
        let at_us = T0_US + month * 31 * DAY_US;
        let record = RunRecord {
            train: train.into(),
            started_at_us: at_us,
            ..run_record("ATC-1")
        };
        failed_run(&store, &record, &[], &[fault(1, at_us)]);
    }
    let found = |train: &str, month: i64| {
        let filter = FaultFilter {
            train: Some(train.into()),
            since_us: Some(T0_US + month * 31 * DAY_US),
            until_us: Some(T0_US + (month + 1) * 31 * DAY_US),
            ..FaultFilter::default()
        };
        store.faults(&filter).expect("listed").len()
    };
    assert_eq!((found("T1", 0), found("T2", 2)), (1, 1));
    assert_eq!((found("T1", 2), found("T2", 0), found("T1", 1)), (0, 0, 0));
}

/// Goal: a word that half of the notes have is found where it stands, as a rare one is. Method: a list without
/// a limit goes through all notes that have it, a short one through the faults.
#[test]
fn a_frequent_word_finds_the_same_faults_as_a_rare_one_would() {
    let (_dir, _, store) = new_history();
    history(&store, &mut Random::new(1));
    let everything = FaultFilter::default();
    let faults = store.faults(&everything).expect("listed");
    let runs = store.runs(&RunFilter::default()).expect("listed");
    let say = |n: usize, text: &str| {
        let fault = &faults[n * n % faults.len()];
        let at_us = fault.last_at_us + n as i64;
        store.put_note(fault.id, "lee", text, at_us);
    };
    for n in 0..3_100 {
        say(n, "EB 릴레이 부품교체함, relays replaced");
    }
    say(7, "Antenne geprüft");
    let lists = |search: &str, filter: &FaultFilter| {
        let list = |limit| {
            let filter = FaultFilter {
                note: Some(search.into()),
                limit,
                ..filter.clone()
            };
            store.faults(&filter).expect("listed")
        };
        (list(None), list(Some(20)))
    };
    let of_unit = FaultFilter {
        unit: Some(faults[0].unit_serial.clone()),
        until_us: Some(T0_US + 60 * DAY_US),
        ..FaultFilter::default()
    };
    let held_against_each_other = || {
        let searches =
            "EB|eb rel|relays-repl|relays-eb|교체|함교|EB 교체|repl 릴레이|lay|geprüft|brush";
        for search in searches.split('|') {
            for filter in [&everything, &of_unit] {
                let (all, few) = lists(search, filter);
                assert_eq!(few, all[..all.len().min(20)], "{search} {filter:?}");
            }
        }
    };
    held_against_each_other();
    assert!(!lists("EB", &of_unit).1.is_empty());
    assert_eq!(lists("EB 교체", &everything).1.len(), 20);
    assert!(lists("lay", &everything).0.is_empty());
    for n in 0..3_100 {
        let run = runs[n * n % runs.len()].id;
        store.put_run_note(run, "lee", "brushes worn", T0_US + n as i64);
    }
    held_against_each_other();
    assert!(lists("brush", &everything).1.len() > 10);
}
