//! Time of queries about a long history: `cargo bench -p fault-db --bench questions -- FILE`.
//!
//! FILE is a history as `cargo run --release -p fault-db --example history -- FILE --faults 1000000 --runs
//! 100000` makes it. Each question is asked of another unit or another year each time; median and 99th
//! percentile are printed.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "what a benchmark or an example is for"
)]

use std::path::Path;
use std::time::Instant;

use fault_db::{
    FaultFilter, FaultState, FaultSummary, StatKey, StatQuery, Store, StoreError, TrendQuery,
};

const DAY_US: i64 = 86_400_000_000;
const YEAR_US: i64 = 365 * DAY_US;
const TIMES: usize = 200;
const MEASUREMENT: &str = "eb_reaction";

/// Asks a question; returns the number of rows.
type Ask = Box<dyn Fn(&Store, &Asked) -> Result<usize, StoreError>>;

/// Values that differ from one query to the next.
struct Asked {
    unit: String,
    since_us: i64,
    now_us: i64,
}

/// Changes the filter that selects what is counted.
type Select = fn(&mut FaultFilter, &Asked);

const UNIT: Select = |filter, asked| filter.unit = Some(asked.unit.clone());
const ALL: Select = |_, _| {};
const CRITICAL: Select = |filter, _| filter.severity = Some("critical".into());
const OPEN: Select = |filter, _| filter.states = vec![FaultState::Open];
const REPLACED: Select = |filter, _| filter.note = Some("교체".into());
const CLOSED_MINOR_ON_A_LINE: Select = |filter, _| {
    filter.states = vec![FaultState::Closed];
    filter.severity = Some("minor".into());
    filter.line = Some("line5".into());
};

/// Questions for counts: name, whether of a year or of all, key and filter.
const COUNTS: [(&str, bool, StatKey, Select); 5] = [
    ("unit: a year by code", true, StatKey::Code, UNIT),
    ("fleet: a year by code", true, StatKey::Code, ALL),
    ("fleet: critical by part", false, StatKey::Lru, CRITICAL),
    (
        "fleet: 교체 in a note, by part",
        false,
        StatKey::Lru,
        REPLACED,
    ),
    (
        "fleet: closed, minor, on a line, by part",
        false,
        StatKey::Lru,
        CLOSED_MINOR_ON_A_LINE,
    ),
];

fn questions() -> Vec<(&'static str, Ask)> {
    let lists = [
        ("unit: last 50 faults", UNIT),
        ("fleet: last 50 open faults", OPEN),
        ("fleet: last 50 with 교체 in a note", REPLACED),
    ];
    let lists = lists.map(|(name, select)| {
        let ask: Ask = Box::new(move |store, asked| Ok(list(store, asked, select, 50)?.len()));
        (name, ask)
    });
    let others: [(_, Ask); 4] = [
        (
            "unit: one fault whole",
            Box::new(|store, asked| {
                let found = list(store, asked, UNIT, 1)?;
                let whole = found.first().map(|fault| store.fault(fault.id));
                Ok(whole.transpose()?.map_or(0, |_| 1))
            }),
        ),
        (
            "unit: eb_reaction",
            Box::new(|store, asked| {
                let unit = Some(asked.unit.clone());
                let query = TrendQuery {
                    unit,
                    ..measurement()
                };
                Ok(store.trend(&query)?.len())
            }),
        ),
        (
            "fleet: eb_reaction in a year by day",
            Box::new(|store, asked| Ok(store.trend_by_day(&in_year(asked))?.len())),
        ),
        (
            "fleet: eb_reaction in a year by unit",
            Box::new(|store, asked| Ok(store.trend_by_unit(&in_year(asked))?.len())),
        ),
    ];
    let counts = COUNTS.map(|(name, is_year, by, select)| {
        let ask: Ask = Box::new(move |store, asked| count(store, asked, is_year, by, select));
        (name, ask)
    });
    lists.into_iter().chain(others).chain(counts).collect()
}

fn list(
    store: &Store,
    asked: &Asked,
    select: Select,
    limit: u32,
) -> Result<Vec<FaultSummary>, StoreError> {
    let mut filter = FaultFilter {
        limit: Some(limit),
        ..FaultFilter::default()
    };
    select(&mut filter, asked);
    store.faults(&filter)
}

fn count(
    store: &Store,
    asked: &Asked,
    is_year: bool,
    by: StatKey,
    select: Select,
) -> Result<usize, StoreError> {
    let until_us = is_year.then(|| (asked.since_us + YEAR_US).min(asked.now_us));
    let mut filter = FaultFilter {
        since_us: until_us.map(|_| asked.since_us),
        until_us,
        ..FaultFilter::default()
    };
    select(&mut filter, asked);
    let query = StatQuery {
        by,
        filter,
        now_us: asked.now_us,
        back_within_days: 30,
    };
    Ok(store.stats(&query)?.len())
}

fn measurement() -> TrendQuery {
    TrendQuery {
        measurement: MEASUREMENT.to_owned(),
        ..TrendQuery::default()
    }
}

fn in_year(asked: &Asked) -> TrendQuery {
    TrendQuery {
        since_us: Some(asked.since_us),
        until_us: Some(asked.since_us + YEAR_US),
        ..measurement()
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let Some(file) = std::env::args()
        .skip(1)
        .find(|argument| !argument.starts_with("--"))
    else {
        println!("no history given: cargo bench -p fault-db --bench questions -- FILE");
        return Ok(());
    };
    let store = Store::open_read_only(Path::new(&file))?;
    let (first_us, last_us) = store.history_span()?.ok_or("an empty history")?;
    let units = store.query_read_only("SELECT serial FROM unit ORDER BY serial", 10_000)?;
    let units: Vec<_> = units
        .rows
        .iter()
        .filter_map(|row| match row.first() {
            Some(fault_db::SqlValue::Text(serial)) => Some(serial.clone()),
            _ => None,
        })
        .collect();
    println!(
        "{:40} {:>9} {:>9} {:>7}",
        "question", "p50 ms", "p99 ms", "rows"
    );
    for (name, ask) in questions() {
        let mut rows = 0;
        let mut times: Vec<f64> = (0..TIMES)
            .map(|time| {
                // Another unit and another beginning each time, none at midnight.
                let last_beginning = (last_us - YEAR_US).max(first_us);
                let step = (last_beginning - first_us) / TIMES as i64;
                let asked = Asked {
                    unit: units[time * 7 % units.len()].clone(),
                    since_us: first_us + step * time as i64,
                    now_us: last_us,
                };
                let began = Instant::now();
                rows = ask(&store, &asked)?;
                Ok(began.elapsed().as_secs_f64() * 1e3)
            })
            .collect::<Result<_, StoreError>>()?;
        times.sort_by(f64::total_cmp);
        let (p50, p99) = (times[TIMES / 2], times[TIMES * 99 / 100]);
        println!("{name:40} {p50:9.3} {p99:9.3} {rows:7}");
    }
    Ok(())
}
