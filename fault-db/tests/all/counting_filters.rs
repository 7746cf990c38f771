//! Counts with any filter, compared with plain SQL on the rows.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::common::{
    Deeds, Random, STAT_KEYS, T0_US, end, fault, filter, ids, measurement, new_history, problems,
    repair_of, run_record, step,
};
use fault_db::{
    FaultFilter, FaultStat, FaultState, OpenOptions, RunRecord, RunWriter, StatKey, StatQuery,
    Store, Verdict,
};
use rusqlite::Connection;

pub const DAY_US: i64 = 86_400_000_000;
const HOUR_US: i64 = 3_600_000_000;
const DAYS: i64 = 100;
const UNITS: u64 = 5;
const PROCEDURES: [&str; 3] = ["atp/overspeed", "twc/exchange", "door/interlocks"];

/// A hundred days of units on two lines: faults of three severities, seen in three procedures or in none,
/// repaired, noted, closed, and what happened to some after the last run.
pub fn history(store: &Store, random: &mut Random) {
    for day in 0..DAYS {
        let at_us = T0_US + day * DAY_US + (random.next() % DAY_US as u64) as i64;
        let record = RunRecord {
            started_at_us: at_us,
            line: format!("line-{}", random.next() % 2),
            train: format!("T{}", random.next() % 2),
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
            done.measurements = vec![measurement("eb_reaction", 0.42 + random.noise() / 10.0)];
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
            let repair = repair_of("eb_relay", "", &format!("SN-{}", random.next() % 9), "");
            store.record_repair(id, &repair, "kim", later_us)
        }
        (2, FaultState::Open) => store.set_state(id, FaultState::Closed, "kim", "", later_us),
        (2 | 3, FaultState::Repaired) => {
            store.set_state(id, FaultState::Verified, "kim", "", later_us)
        }
        (_, FaultState::Verified) => store.set_state(id, FaultState::Closed, "kim", "", later_us),
        (4, _) => {
            store.put_note(id, "lee", "relay replaced", later_us);
            Ok(state)
        }
        _ => Ok(state),
    };
    done.expect("people may");
}

/// A filter, and what it selects, in SQL on a fault `f`, and on an occurrence `o` with its run `r` and step `s`.
type Case = (FaultFilter, &'static str, &'static str);

/// Filters on the properties of faults.
fn of_faults() -> Vec<Case> {
    let any = FaultFilter::default;
    let text = |text: &str| Some(text.to_owned());
    let states = |states: &[FaultState]| FaultFilter {
        states: states.to_vec(),
        ..any()
    };
    vec![
        (any(), "1", "1"),
        (filter(|f| f.unit = text("ATC-1")), "f.unit = (SELECT seq FROM unit WHERE serial = 'ATC-1')", "1"),
        (filter(|f| f.severity = text("CRITICAL")), "f.severity = 'critical'", "1"),
        (states(&[FaultState::Open]), "f.state = 'open'", "1"),
        (
            states(&[FaultState::Closed, FaultState::Repaired]),
            "f.state IN ('closed', 'repaired')",
            "1",
        ),
        (filter(|f| f.code = text("1,3")), "f.code IN (1, 3)", "1"),
        (filter(|f| f.lru = text("tra")), "f.lru IN ('tra', 'TRA')", "1"),
        (filter(|f| f.lru = text("eb_relay")), "f.lru = 'eb_relay'", "1"),
        (
            filter(|f| (f.code, f.severity) = (text("2"), text("major"))),
            "f.code = 2 AND f.severity = 'major'",
            "1",
        ),
        (
            filter(|f| (f.unit, f.severity) = (text("ATC-1"), text("minor"))),
            "f.unit = (SELECT seq FROM unit WHERE serial = 'ATC-1') AND f.severity = 'minor'",
            "1",
        ),
        (
            filter(|f| (f.unit, f.lru) = (text("ATC-2"), text("tra"))),
            "f.unit = (SELECT seq FROM unit WHERE serial = 'ATC-2') AND f.lru IN ('tra', 'TRA')",
            "1",
        ),
        (
            filter(|f| f.note = text("replaced")),
            "EXISTS (SELECT 1 FROM fault_event e WHERE e.fault = f.seq AND e.body LIKE '%replaced%')",
            "1",
        ),
        (
            filter(|f| f.serial = text("SN-3")),
            "EXISTS (SELECT 1 FROM fault_event e WHERE e.fault = f.seq AND e.body LIKE '%\"SN-3\"%')",
            "1",
        ),
        (
            filter(|f| (f.serial, f.note) = (text("SN-3"), text("replaced"))),
            "EXISTS (SELECT 1 FROM fault_event e WHERE e.fault = f.seq AND e.body LIKE '%\"SN-3\"%')
             AND EXISTS (SELECT 1 FROM fault_event e WHERE e.fault = f.seq AND e.body LIKE '%replaced%')",
            "1",
        ),
    ]
}

/// Filters on the properties of occurrences, alone and with others.
fn of_occurrences() -> Vec<Case> {
    let text = |text: &str| Some(text.to_owned());
    let overspeed = "s.procedure = 'atp/overspeed'";
    vec![
        (filter(|f| f.procedure = text("atp/overspeed")), "1", overspeed),
        (filter(|f| f.procedure = text("atp/none")), "1", "0"),
        (filter(|f| f.train = text("T1")), "1", "r.train = 'T1'"),
        (
            filter(|f| (f.train, f.procedure) = (text("T0"), text("atp/overspeed"))),
            "1",
            "r.train = 'T0' AND s.procedure = 'atp/overspeed'",
        ),
        (
            filter(|f| (f.procedure, f.line) = (text("atp/overspeed"), text("line-1"))),
            "1",
            overspeed,
        ),
        (
            filter(|f| (f.lru, f.line) = (text("eb_relay"), text("line-1"))),
            "f.lru = 'eb_relay'",
            "1",
        ),
        (
            filter(|f| {
                (f.note, f.procedure) = (text("replaced"), text("door/interlocks"));
                f.states = vec![FaultState::Open];
            }),
            "f.state = 'open'
             AND EXISTS (SELECT 1 FROM fault_event e WHERE e.fault = f.seq AND e.body LIKE '%replaced%')",
            "s.procedure = 'door/interlocks'",
        ),
    ]
}

/// Counts of one key.
#[derive(Debug, Default, PartialEq)]
struct Sum {
    /// Opened, not closed, closed, of these without repair; repairs, too young, back.
    counts: [u32; 7],
    occurrences: u64,
    units: BTreeSet<i64>,
    last_at_us: Option<i64>,
    repair_us: i64,
}

/// Counts in plain SQL.
fn sums(conn: &Connection, case: &Case, query: &StatQuery) -> BTreeMap<String, Sum> {
    let (filter, of_fault, of_occurrence) = case;
    let column = |table: &str| match query.by {
        StatKey::Code => format!("{table}.code"),
        StatKey::Lru => format!("{table}.lru"),
        StatKey::Cause => "coalesce(f.cause, f.lru)".to_owned(),
        StatKey::Unit => format!("(SELECT serial FROM unit u WHERE u.seq = {table}.unit)"),
        StatKey::Line => format!("{table}.line"),
        StatKey::All => "''".to_owned(),
    };
    let line = |table: &str| match &filter.line {
        Some(line) => format!("{table}.line = '{line}'"),
        None => "1".to_owned(),
    };
    let seen = "fault_occurrence o JOIN run r ON r.seq = o.run
        LEFT JOIN step s ON s.run = o.run AND s.step_index = o.step_index";
    let fault = format!(
        "{of_fault} AND EXISTS (SELECT 1 FROM {seen} WHERE o.fault = f.seq AND {of_occurrence})"
    );
    let (since_us, until_us) = (query.filter.since_us, query.filter.until_us);
    let within = |at_us: i64| {
        since_us.is_none_or(|since| at_us >= since) && until_us.is_none_or(|until| at_us < until)
    };
    let within_us = i64::from(query.back_within_days) * DAY_US;
    let mut sums = BTreeMap::<String, Sum>::new();
    let each = |sql: String, take: &mut dyn FnMut(&rusqlite::Row<'_>)| {
        let mut select = conn.prepare(&sql).expect(&sql);
        let mut rows = select.query([]).expect("asked");
        while let Some(row) = rows.next().expect("read") {
            take(row);
        }
    };
    each(
        format!(
            "SELECT CAST({} AS TEXT), o.at_us, o.unit FROM fault f JOIN {seen}
             WHERE o.fault = f.seq AND {of_fault} AND {of_occurrence} AND {}",
            column("o"),
            line("o")
        ),
        &mut |row| {
            let at_us: i64 = row.get(1).expect("a time");
            if within(at_us) {
                let sum = sums.entry(row.get(0).expect("a key")).or_default();
                sum.occurrences += 1;
                sum.last_at_us = sum.last_at_us.max(Some(at_us));
                sum.units.insert(row.get(2).expect("a unit"));
            }
        },
    );
    each(
        format!(
            "SELECT CAST({} AS TEXT), f.first_at_us, f.last_at_us, f.closed_at_us, f.state, f.repairs
             FROM fault f WHERE {fault} AND {}",
            column("f"),
            line("f")
        ),
        &mut |row| {
            let at = |column| row.get::<_, Option<i64>>(column).expect("a time");
            let is_in = |column| at(column).is_some_and(within);
            let state: String = row.get(4).expect("a state");
            let bare = row.get::<_, i64>(5).expect("a number") == 0;
            let is = [
                is_in(1),
                is_in(2) && state != "closed",
                is_in(3),
                is_in(3) && bare,
            ];
            if is.contains(&true) {
                let sum = sums.entry(row.get(0).expect("a key")).or_default();
                for (count, is) in sum.counts.iter_mut().zip(is) {
                    *count += u32::from(is);
                }
            }
        },
    );
    each(
        format!(
            "SELECT CAST({} AS TEXT), p.at_us, p.opened_at_us, p.back_at_us
             FROM repair p JOIN fault f ON f.seq = p.fault WHERE {fault} AND {}",
            column("p"),
            line("p")
        ),
        &mut |row| {
            let at_us: i64 = row.get(1).expect("a time");
            if within(at_us) {
                let back: Option<i64> = row.get(3).expect("a time");
                let is_back = back.is_some_and(|back| back - at_us < within_us);
                let is_young = !is_back && query.now_us - at_us < within_us;
                let sum = sums.entry(row.get(0).expect("a key")).or_default();
                sum.repair_us += at_us - row.get::<_, i64>(2).expect("a time");
                for (count, is) in sum.counts[4..].iter_mut().zip([true, is_young, is_back]) {
                    *count += u32::from(is);
                }
            }
        },
    );
    sums
}

fn agree(stat: &FaultStat, sum: &Sum) -> bool {
    let [opened, not_closed, closed, bare, repairs, young, back] = sum.counts;
    let hours = sum.repair_us as f64 / f64::from(repairs) / 3.6e9;
    let expected = FaultStat {
        key: stat.key.clone(),
        name: stat.name.clone(),
        faults: opened,
        not_closed,
        occurrences: sum.occurrences,
        units: sum.units.len() as u32,
        last_at_us: sum.last_at_us,
        closed,
        no_fault_found: bare,
        repairs,
        repairs_judged: repairs - young,
        repairs_back: back,
        mtbf_days: stat.mtbf_days,
        mttr_hours: (repairs > 0).then_some(hours),
        course: stat.course.clone(),
    };
    *stat == expected && stat.course.iter().sum::<u64>() == sum.occurrences
}

/// Each filter with each key and each span, but not with each pair of both: which span a key has differs from
/// filter to filter and from turn to turn. The counts that are kept are asked for with all of them.
fn compare(store: &Store, path: &Path, what: &str, turn: usize) {
    let conn = Connection::open(path).expect("opens");
    let month = T0_US + 40 * DAY_US + 3;
    let spans = [
        (None, None),
        (Some(T0_US + 9 * DAY_US + 5), Some(T0_US + 70 * DAY_US + 7)),
        (Some(T0_US + 80 * DAY_US - 1), None),
        (None, Some(month)),
        (Some(T0_US + 5 * HOUR_US), Some(T0_US + 7 * HOUR_US)),
        (
            Some(T0_US + 31 * DAY_US - HOUR_US),
            Some(T0_US + 61 * DAY_US + HOUR_US),
        ),
    ];
    let cases = of_faults().into_iter().chain(of_occurrences());
    for (at, case) in cases.enumerate() {
        let query = |by, (since_us, until_us)| StatQuery {
            by,
            filter: FaultFilter {
                since_us,
                until_us,
                ..case.0.clone()
            },
            now_us: T0_US + DAYS * DAY_US,
            back_within_days: [20, 5][turn % 2],
        };
        for (key, by) in STAT_KEYS.into_iter().enumerate() {
            let one = (turn + at + key) % spans.len();
            // What is kept is added up where nothing, or a unit alone, is asked for.
            let some = &spans[if at < 2 { 0..spans.len() } else { one..one + 1 }];
            for span in some {
                let query = query(by, *span);
                let (stats, total) = store.stats_and_total(&query).expect("counted");
                let expected = sums(&conn, &case, &query);
                assert_eq!(stats.len(), expected.len(), "{what} {query:?}: {stats:#?}");
                for stat in &stats {
                    let sum = &expected[&stat.key];
                    assert!(
                        agree(stat, sum),
                        "{what} {query:?}: {stat:#?}, not {sum:#?}"
                    );
                }
                let by = StatKey::All;
                let all = store.stats(&StatQuery { by, ..query }).expect("counted");
                assert_eq!(all.first().unwrap_or(&total), &total, "{what} {by:?}");
            }
        }
        let by = STAT_KEYS[(turn + at) % STAT_KEYS.len()];
        let adjacent = [T0_US..month, month..month, month..month + 35 * DAY_US];
        let together = store.stats_of_spans(&query(by, (None, None)), &adjacent);
        let alone = adjacent.map(|span| {
            let query = query(by, (Some(span.start), Some(span.end)));
            store.stats(&query).expect("counted")
        });
        assert_eq!(together.expect("counted"), alone, "{what} {by:?}");
    }
}

/// Goal: the same is counted whether faults are packed or not, of whatever they came from, and by a reader
/// that may not write.
#[test]
fn counts_with_any_filter_are_those_of_the_rows() {
    let (dir, path, store) = new_history();
    history(&store, &mut Random::new(1));
    assert!(empty(&path) > 0);
    let reader = Store::open_read_only(&path).expect("opens");
    compare(&reader, &path, "recorded", 0);
    assert_eq!(store.rebuild(T0_US).expect("made anew"), [""; 0]);
    assert_eq!(empty(&path), 0);
    compare(&store, &path, "packed", 1);
    history(&store, &mut Random::new(10));
    assert!(empty(&path) > 0);
    compare(&store, &path, "recorded on", 2);
    assert_eq!(problems(&store), []);
    let to = dir.path().join("b.db");
    let copy = Store::open(&to, OpenOptions::new(ids(7))).expect("opens");
    copy.merge_from(&store).expect("merged");
    compare(&copy, &to, "merged", 3);
    assert_eq!(problems(&copy), []);
}

/// Blocks of packed faults that are empty.
fn empty(path: &Path) -> i64 {
    let conn = Connection::open(path).expect("opens");
    let sql = "SELECT count(*) FROM packed WHERE faults IS NULL";
    let empty = conn.query_row(sql, [], |row| row.get(0));
    empty.expect("counted")
}

/// Goal: a reader that reads while another writes counts what was committed; a run that leaves many blocks
/// empty packs them, one that leaves few does not.
#[test]
fn readers_count_what_is_committed_and_many_empty_blocks_are_packed() {
    let (_dir, path, store) = new_history();
    let reader = Store::open_read_only(&path).expect("opens");
    let query = StatQuery {
        by: StatKey::All,
        filter: filter(|it| it.severity = Some("major".into())),
        now_us: T0_US + DAY_US,
        back_within_days: 30,
    };
    let faults = |store: &Store| {
        let stats = store.stats(&query).expect("counted");
        stats.first().map_or(0, |all| all.faults)
    };
    let run = |codes: std::ops::Range<i64>| {
        let mut writer = RunWriter::begin(&store, &run_record("ATC-7"))?;
        for code in codes {
            writer.fault(&fault(code, T0_US))?;
        }
        writer.finish(&end(Verdict::Failed))
    };
    store.transaction(|| run(0..40)).expect("written");
    assert_eq!((faults(&reader), empty(&path)), (40, 2));
    let many = || {
        run(40..2200)?;
        assert_eq!((faults(&store), faults(&reader)), (2200, 40));
        Ok(())
    };
    store.transaction(many).expect("written");
    assert_eq!((faults(&reader), empty(&path)), (2200, 0));
    run(0..5).expect("written");
    assert_eq!((faults(&reader), empty(&path)), (2200, 1));
}
