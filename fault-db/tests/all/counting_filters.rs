//! Counts with any filter, compared with those of each unit, which are counted row by row.

use crate::common::{Random, T0_US, end, fault, ids, open, run_record, step};
use fault_db::{
    FaultFilter, FaultStat, FaultState, OpenOptions, RepairRecord, RunRecord, RunWriter, StatKey,
    StatQuery, Store, Verdict,
};
use tempfile::tempdir;

const DAY_US: i64 = 86_400_000_000;
const DAYS: i64 = 150;
const UNITS: u64 = 5;
const PROCEDURES: [&str; 3] = ["atp/overspeed", "twc/exchange", "door/interlocks"];

/// Five months of units on two lines: faults of three severities, seen in three procedures or in none,
/// repaired, noted, closed, and what happened to some after the last run.
fn history(store: &Store, random: &mut Random) {
    for day in 0..DAYS {
        let at_us = T0_US + day * DAY_US + (random.next() % DAY_US as u64) as i64;
        let record = RunRecord {
            started_at_us: at_us,
            line: format!("line-{}", random.next() % 2),
            ..run_record(&format!("ATC-{}", random.next() % UNITS))
        };
        let mut writer = RunWriter::begin(store, &record).expect("begun");
        let mut seen = Vec::new();
        for index in 0..3 {
            for n in 0..random.next() % 3 {
                let code = 1 + (random.next() % 4) as i64;
                let mut record = fault(code, at_us + 1_000_000 * n as i64);
                record.lru = ["eb_relay", "tra", "TRA"][(code % 3) as usize].to_owned();
                record.severity = ["minor", "major", "critical"][random.next() as usize % 3].into();
                record.step_index = (!random.one_in(4)).then_some(index);
                seen.push(writer.fault(&record).expect("stored").fault);
            }
            let mut done = step(index);
            done.procedure = PROCEDURES[random.next() as usize % 3].into();
            writer.step(done).expect("kept");
        }
        writer.finish(&end(Verdict::Failed)).expect("finished");
        for id in seen {
            handle(store, id, at_us, random);
        }
    }
}

fn handle(store: &Store, id: fault_db::Id, at_us: i64, random: &mut Random) {
    let later_us = at_us + (random.next() % (9 * DAY_US as u64)) as i64;
    let state = store.fault(id).expect("known").fault.state;
    let done = match (random.next() % 5, state) {
        (0 | 1, FaultState::Open) => {
            let repair = RepairRecord {
                part: "eb_relay".into(),
                serial_old: None,
                serial_new: Some(format!("SN-{}", random.next() % 9)),
                note: String::new(),
            };
            store.record_repair(id, &repair, "kim", later_us)
        }
        (2, FaultState::Open) => store.set_state(id, FaultState::Closed, "kim", "", later_us),
        (2 | 3, FaultState::Repaired) => {
            store.set_state(id, FaultState::Verified, "kim", "", later_us)
        }
        (_, FaultState::Verified) => store.set_state(id, FaultState::Closed, "kim", "", later_us),
        (4, _) => {
            store
                .add_note(id, "lee", "relay replaced", later_us)
                .expect("noted");
            Ok(state)
        }
        _ => Ok(state),
    };
    done.expect("people may");
}

fn filters() -> Vec<FaultFilter> {
    let any = FaultFilter::default;
    let text = |text: &str| Some(text.to_owned());
    vec![
        FaultFilter {
            severity: text("CRITICAL"),
            ..any()
        },
        FaultFilter {
            states: vec![FaultState::Open],
            ..any()
        },
        FaultFilter {
            states: vec![FaultState::Closed, FaultState::Repaired],
            ..any()
        },
        FaultFilter {
            procedure: text("atp/overspeed"),
            ..any()
        },
        FaultFilter {
            procedure: text("atp/none"),
            ..any()
        },
        FaultFilter {
            procedure: text("twc/exchange"),
            line: text("line-1"),
            ..any()
        },
        FaultFilter {
            code: text("1,3"),
            ..any()
        },
        FaultFilter {
            code: text("2"),
            severity: text("major"),
            ..any()
        },
        FaultFilter {
            lru: text("tra"),
            ..any()
        },
        FaultFilter {
            lru: text("eb_relay"),
            line: text("line-0"),
            ..any()
        },
        FaultFilter {
            note: text("relay"),
            ..any()
        },
        FaultFilter {
            serial: text("SN-3"),
            ..any()
        },
        FaultFilter {
            note: text("replaced"),
            states: vec![FaultState::Open],
            procedure: text("door/interlocks"),
            ..any()
        },
    ]
}

/// What is counted of one key, whatever the unit.
#[derive(Debug, Default, PartialEq)]
struct Sum {
    counts: [u64; 9],
    last_at_us: Option<i64>,
    course: Vec<u64>,
    repair_hours: i64,
}

impl Sum {
    fn add(&mut self, stat: &FaultStat) {
        let more = [
            stat.faults,
            stat.not_closed,
            stat.units,
            stat.closed,
            stat.no_fault_found,
            stat.repairs,
            stat.repairs_judged,
            stat.repairs_back,
        ];
        let more = more.into_iter().map(u64::from).chain([stat.occurrences]);
        self.counts
            .iter_mut()
            .zip(more)
            .for_each(|(sum, more)| *sum += more);
        self.last_at_us = self.last_at_us.max(stat.last_at_us);
        self.course.resize(stat.course.len(), 0);
        self.course
            .iter_mut()
            .zip(&stat.course)
            .for_each(|(sum, more)| *sum += more);
        let hours = stat.mttr_hours.unwrap_or_default() * f64::from(stat.repairs);
        self.repair_hours += (hours * 1e3).round() as i64;
    }
}

fn sums(stats: &[FaultStat]) -> std::collections::BTreeMap<String, Sum> {
    let mut sums = std::collections::BTreeMap::<String, Sum>::new();
    for stat in stats {
        sums.entry(stat.key.clone()).or_default().add(stat);
    }
    sums
}

fn compare(store: &Store, what: &str) {
    let spans = [
        (None, None),
        (Some(T0_US + 9 * DAY_US + 5), Some(T0_US + 100 * DAY_US + 7)),
        (Some(T0_US + 120 * DAY_US - 1), None),
        (None, Some(T0_US + 40 * DAY_US + 3)),
    ];
    for (filter, (since_us, until_us)) in filters()
        .into_iter()
        .flat_map(|filter| spans.map(|span| (filter.clone(), span)))
    {
        for by in [
            StatKey::Code,
            StatKey::Lru,
            StatKey::Unit,
            StatKey::Line,
            StatKey::All,
        ] {
            let query = StatQuery {
                by,
                filter: FaultFilter {
                    since_us,
                    until_us,
                    ..filter.clone()
                },
                now_us: T0_US + DAYS * DAY_US,
                back_within_days: 20,
            };
            let units = (0..UNITS).flat_map(|unit| {
                let mut of_unit = query.clone();
                of_unit.filter.unit = Some(format!("ATC-{unit}"));
                store.stats(&of_unit).expect("counted")
            });
            let units: Vec<_> = units.collect();
            let mut all = sums(&store.stats(&query).expect("counted"));
            let mut expected = sums(&units);
            // Each unit's times to repair were rounded by themselves.
            for (key, sum) in &mut all {
                let hours = expected.get(key).map_or(0, |sum| sum.repair_hours);
                assert!((sum.repair_hours - hours).abs() < 20, "{what} {query:?}");
                sum.repair_hours = hours;
            }
            assert_eq!(all, expected, "{what} {query:?}");
            expected.clear();
        }
    }
}

#[test]
fn counts_with_any_filter_are_those_of_the_rows() {
    let dir = tempdir().expect("a directory");
    for seed in 1..3 {
        let path = dir.path().join(format!("{seed}.db"));
        let store = open(&path);
        history(&store, &mut Random::new(seed));
        compare(&store, "recorded");
        assert_eq!(store.check().expect("checked").problems, []);
        let copy = dir.path().join(format!("{seed}-copy.db"));
        let copy = Store::open(&copy, OpenOptions::new(ids(7))).expect("opens");
        copy.merge_from(&store).expect("merged");
        compare(&copy, "merged");
        assert_eq!(copy.check().expect("checked").problems, []);
    }
}
