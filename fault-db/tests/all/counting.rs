//! Stored counts, compared with counting row by row.

use crate::common::{Random, T0_US, end, fault, measurement, open, run_record, step};
use fault_db::{
    FaultFilter, FaultState, RepairRecord, RunFilter, RunRecord, RunWriter, StatKey, StatQuery,
    Store, TrendQuery, Verdict,
};
use tempfile::tempdir;

const DAY_US: i64 = 86_400_000_000;
const DAYS: i64 = 120;

/// Four months of four units on two lines: faults, repairs that hold or do not, faults closed with and
/// without one.
fn history(store: &Store, random: &mut Random) {
    for day in 0..DAYS {
        let unit = format!("ATC-{}", random.next() % 4);
        let at_us = T0_US + day * DAY_US + (random.next() % DAY_US as u64) as i64;
        let record = RunRecord {
            started_at_us: at_us,
            line: format!("line-{}", random.next() % 2),
            ..run_record(&unit)
        };
        let mut writer = RunWriter::begin(store, &record).expect("begun");
        let mut measured = step(0);
        measured.measurements = vec![measurement("eb_reaction", 0.42 + random.noise() / 10.0)];
        writer.step(measured).expect("kept");
        let mut seen = Vec::new();
        for n in 0..random.next() % 4 {
            let code = 1 + (random.next() % 3) as i64;
            let mut record = fault(code, at_us + 1_000_000 * n as i64);
            record.lru = ["eb_relay", "tra"][(code % 2) as usize].to_owned();
            seen.push(writer.fault(&record).expect("stored").fault);
        }
        writer.finish(&end(Verdict::Failed)).expect("finished");
        for id in seen {
            let later_us = at_us + (random.next() % (9 * DAY_US as u64)) as i64;
            let state = store.fault(id).expect("known").fault.state;
            let done = match (random.next() % 4, state) {
                (0 | 1, FaultState::Open) => {
                    let repair = RepairRecord {
                        part: "EB_Relay ".into(),
                        serial_new: Some(format!("SN-{day}")),
                        ..RepairRecord::default()
                    };
                    store.record_repair(id, &repair, "kim", later_us)
                }
                (2, FaultState::Open) => {
                    store.set_state(id, FaultState::Closed, "kim", "", later_us)
                }
                (2, FaultState::Repaired) => {
                    store.set_state(id, FaultState::Verified, "kim", "", later_us)
                }
                (_, FaultState::Verified) => {
                    store.set_state(id, FaultState::Closed, "kim", "", later_us)
                }
                _ => Ok(state),
            };
            done.expect("people may");
        }
    }
}

/// Goal: whatever span is asked for, what triggers counted is what there is. Method: every fault of the
/// history is major, so that asking for those counts row by row what otherwise is added up.
#[test]
fn kept_counts_are_those_of_the_rows() {
    let dir = tempdir().expect("a directory");
    for seed in 1..4 {
        let mut random = Random::new(seed);
        let store = open(&dir.path().join(format!("{seed}.db")));
        history(&store, &mut random);
        let mut within = || T0_US + (random.next() % ((DAYS + 10) as u64 * DAY_US as u64)) as i64;
        let mut spans = vec![
            (None, None),
            (Some(T0_US), None),
            (None, Some(T0_US + 31 * DAY_US)),
        ];
        for _ in 0..25 {
            let (a, b) = (within(), within());
            spans.push((Some(a.min(b)), Some(a.max(b) + 1)));
        }
        let hour = 3_600_000_000;
        spans.push((Some(T0_US + 5 * hour), Some(T0_US + 7 * hour)));
        spans.push((
            Some(T0_US + 31 * DAY_US - hour),
            Some(T0_US + 61 * DAY_US + hour),
        ));
        for (since_us, until_us) in spans {
            for by in [
                StatKey::Code,
                StatKey::Lru,
                StatKey::Unit,
                StatKey::Line,
                StatKey::All,
            ] {
                for back_within_days in [30, 5] {
                    let query = StatQuery {
                        by,
                        filter: FaultFilter {
                            since_us,
                            until_us,
                            ..FaultFilter::default()
                        },
                        now_us: T0_US + DAYS * DAY_US,
                        back_within_days,
                    };
                    let mut by_row = query.clone();
                    by_row.filter.severity = Some("major".into());
                    let kept = store.stats(&query).expect("counted");
                    assert_eq!(
                        kept,
                        store.stats(&by_row).expect("counted"),
                        "seed {seed} {by:?} {since_us:?} {until_us:?}"
                    );
                    if let (StatKey::Unit, Some(first)) = (by, kept.first()) {
                        let mut alone = query.clone();
                        alone.filter.unit = Some(first.key.clone());
                        assert_eq!(
                            store.stats(&alone).expect("counted"),
                            std::slice::from_ref(first)
                        );
                    }
                }
            }
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
    let dir = tempdir().expect("a directory");
    let store = open(&dir.path().join("a.db"));
    let mut writer = RunWriter::begin(&store, &run_record("ATC-1")).expect("begun");
    let id = writer.fault(&fault(1, T0_US)).expect("stored").fault;
    let repair = RepairRecord {
        part: "eb_relay".into(),
        ..RepairRecord::default()
    };
    store
        .record_repair(id, &repair, "kim", T0_US - 30 * DAY_US)
        .expect("repaired");
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
    let dir = tempdir().expect("a directory");
    let store = open(&dir.path().join("a.db"));
    for (train, month) in [("T1", 0), ("T2", 2)] {
        let at_us = T0_US + month * 31 * DAY_US;
        let record = RunRecord {
            train: train.into(),
            started_at_us: at_us,
            ..run_record("ATC-1")
        };
        let mut writer = RunWriter::begin(&store, &record).expect("begun");
        writer.fault(&fault(1, at_us)).expect("stored");
        writer.finish(&end(Verdict::Failed)).expect("finished");
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
    let dir = tempdir().expect("a directory");
    let store = open(&dir.path().join("a.db"));
    history(&store, &mut Random::new(1));
    let everything = FaultFilter::default();
    let faults = store.faults(&everything).expect("listed");
    let runs = store.runs(&RunFilter::default()).expect("listed");
    let say = |n: usize, text: &str| {
        let fault = &faults[n * n % faults.len()];
        let at_us = fault.last_at_us + n as i64;
        store.add_note(fault.id, "lee", text, at_us).expect("noted");
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
        for search in [
            "EB",
            "eb rel",
            "relays-repl",
            "relays-eb",
            "교체",
            "함교",
            "EB 교체",
            "repl 릴레이",
            "lay",
            "geprüft",
            "brush",
        ] {
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
        store
            .add_run_note(run, "lee", "brushes worn", T0_US + n as i64)
            .expect("noted");
    }
    held_against_each_other();
    assert!(lists("brush", &everything).1.len() > 10);
}
