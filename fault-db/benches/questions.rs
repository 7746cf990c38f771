//! What questions about a long history cost: `cargo bench -p fault-db --bench questions -- FILE`.
//!
//! FILE is a history as `cargo run --release -p fault-db --example history -- FILE --faults 1000000 --runs
//! 100000` makes it. Each question is asked of another unit or another year each time; median and 99th
//! percentile are printed, or with `--json` for `benches/against_duckdb.py`.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "what a benchmark or an example is for"
)]

use std::path::Path;
use std::time::Instant;

use fault_db::{FaultFilter, FaultState, StatKey, StatQuery, Store, StoreError, TrendQuery};

const DAY_US: i64 = 86_400_000_000;
const YEAR_US: i64 = 365 * DAY_US;
const TIMES: usize = 200;
const MEASUREMENT: &str = "eb_reaction";

/// What is asked, and how.
struct Question {
    name: &'static str,
    ask: fn(&Store, &Asked) -> Result<usize, StoreError>,
}

/// What differs from one time to the next.
struct Asked {
    unit: String,
    since_us: i64,
    now_us: i64,
}

const QUESTIONS: [Question; 26] = [
    question("unit: last 50 faults", |store, asked| {
        list(
            store,
            FaultFilter {
                unit: Some(asked.unit.clone()),
                ..FaultFilter::default()
            },
        )
    }),
    question("unit: one fault whole", |store, asked| {
        let filter = FaultFilter {
            unit: Some(asked.unit.clone()),
            limit: Some(1),
            ..FaultFilter::default()
        };
        let fault = store.faults(&filter)?;
        Ok(fault
            .first()
            .map(|fault| store.fault(fault.id))
            .transpose()?
            .map_or(0, |_| 1))
    }),
    question("unit: a year by code", |store, asked| {
        stats(store, asked, StatKey::Code, Some(&asked.unit))
    }),
    question("unit: a year by part", |store, asked| {
        stats(store, asked, StatKey::Lru, Some(&asked.unit))
    }),
    question("unit: eb_reaction", |store, asked| {
        Ok(store
            .trend(&TrendQuery {
                unit: Some(asked.unit.clone()),
                ..measurement()
            })?
            .len())
    }),
    question("fleet: a year by code", |store, asked| {
        stats(store, asked, StatKey::Code, None)
    }),
    question("fleet: a year by part", |store, asked| {
        stats(store, asked, StatKey::Lru, None)
    }),
    question("fleet: a year by unit", |store, asked| {
        stats(store, asked, StatKey::Unit, None)
    }),
    question("fleet: a year by line", |store, asked| {
        stats(store, asked, StatKey::Line, None)
    }),
    question("fleet: a month by code", |store, asked| {
        let asked = Asked {
            since_us: asked.since_us,
            now_us: asked.since_us + 30 * DAY_US,
            unit: String::new(),
        };
        stats(store, &asked, StatKey::Code, None)
    }),
    question("fleet: eb_reaction in a year by day", |store, asked| {
        Ok(store.trend_by_day(&in_year(asked))?.len())
    }),
    question("fleet: eb_reaction in a year by unit", |store, asked| {
        Ok(store.trend_by_unit(&in_year(asked))?.len())
    }),
    question("fleet: last 50 open faults", |store, _| {
        list(
            store,
            FaultFilter {
                states: vec![FaultState::Open],
                ..FaultFilter::default()
            },
        )
    }),
    question("fleet: last 50 with 교체 in a note", |store, _| {
        list(
            store,
            FaultFilter {
                note: Some("교체".into()),
                ..FaultFilter::default()
            },
        )
    }),
    question("fleet: a year, critical, by part", |store, asked| {
        filtered(
            store,
            asked,
            StatKey::Lru,
            FaultFilter {
                severity: Some("critical".into()),
                ..FaultFilter::default()
            },
        )
    }),
    question("fleet: a year, critical, by unit", |store, asked| {
        filtered(
            store,
            asked,
            StatKey::Unit,
            FaultFilter {
                severity: Some("critical".into()),
                ..FaultFilter::default()
            },
        )
    }),
    question("fleet: a year, open, by code", |store, asked| {
        filtered(
            store,
            asked,
            StatKey::Code,
            FaultFilter {
                states: vec![FaultState::Open],
                ..FaultFilter::default()
            },
        )
    }),
    question("fleet: a year, closed, by line", |store, asked| {
        filtered(
            store,
            asked,
            StatKey::Line,
            FaultFilter {
                states: vec![FaultState::Closed],
                ..FaultFilter::default()
            },
        )
    }),
    question("fleet: critical by part", |store, asked| {
        filtered_whole(
            store,
            asked,
            StatKey::Lru,
            FaultFilter {
                severity: Some("critical".into()),
                ..FaultFilter::default()
            },
        )
    }),
    question("fleet: minor by unit", |store, asked| {
        filtered_whole(
            store,
            asked,
            StatKey::Unit,
            FaultFilter {
                severity: Some("minor".into()),
                ..FaultFilter::default()
            },
        )
    }),
    question("fleet: open by code", |store, asked| {
        filtered_whole(
            store,
            asked,
            StatKey::Code,
            FaultFilter {
                states: vec![FaultState::Open],
                ..FaultFilter::default()
            },
        )
    }),
    question("fleet: closed by line", |store, asked| {
        filtered_whole(
            store,
            asked,
            StatKey::Line,
            FaultFilter {
                states: vec![FaultState::Closed],
                ..FaultFilter::default()
            },
        )
    }),
    question("fleet: atp/overspeed by code", |store, asked| {
        filtered_whole(
            store,
            asked,
            StatKey::Code,
            FaultFilter {
                procedure: Some("atp/overspeed".into()),
                ..FaultFilter::default()
            },
        )
    }),
    question("fleet: eb_relay by unit", |store, asked| {
        filtered_whole(
            store,
            asked,
            StatKey::Unit,
            FaultFilter {
                lru: Some("eb_relay".into()),
                ..FaultFilter::default()
            },
        )
    }),
    question("fleet: 교체 in a note, by part", |store, asked| {
        filtered_whole(
            store,
            asked,
            StatKey::Lru,
            FaultFilter {
                note: Some("교체".into()),
                ..FaultFilter::default()
            },
        )
    }),
    question(
        "fleet: closed, minor, on a line, by part",
        |store, asked| {
            filtered_whole(
                store,
                asked,
                StatKey::Lru,
                FaultFilter {
                    states: vec![FaultState::Closed],
                    severity: Some("minor".into()),
                    line: Some("line5".into()),
                    ..FaultFilter::default()
                },
            )
        },
    ),
];

const fn question(
    name: &'static str,
    ask: fn(&Store, &Asked) -> Result<usize, StoreError>,
) -> Question {
    Question { name, ask }
}

fn list(store: &Store, filter: FaultFilter) -> Result<usize, StoreError> {
    let limit = filter.limit.or(Some(50));
    Ok(store.faults(&FaultFilter { limit, ..filter })?.len())
}

fn stats(
    store: &Store,
    asked: &Asked,
    by: StatKey,
    unit: Option<&String>,
) -> Result<usize, StoreError> {
    let query = StatQuery {
        by,
        filter: FaultFilter {
            unit: unit.cloned(),
            since_us: Some(asked.since_us),
            until_us: Some((asked.since_us + YEAR_US).min(asked.now_us)),
            ..FaultFilter::default()
        },
        now_us: asked.now_us,
        back_within_days: 30,
    };
    Ok(store.stats(&query)?.len())
}

/// Counts with a filter, in a year.
fn filtered(
    store: &Store,
    asked: &Asked,
    by: StatKey,
    filter: FaultFilter,
) -> Result<usize, StoreError> {
    let filter = FaultFilter {
        since_us: Some(asked.since_us),
        until_us: Some((asked.since_us + YEAR_US).min(asked.now_us)),
        ..filter
    };
    filtered_whole(store, asked, by, filter)
}

/// Counts with a filter, in the whole history.
fn filtered_whole(
    store: &Store,
    asked: &Asked,
    by: StatKey,
    filter: FaultFilter,
) -> Result<usize, StoreError> {
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
    let arguments: Vec<_> = std::env::args()
        .skip(1)
        .filter(|argument| argument != "--bench")
        .collect();
    let Some(file) = arguments
        .iter()
        .find(|argument| !argument.starts_with("--"))
    else {
        println!("no history given: cargo bench -p fault-db --bench questions -- FILE");
        return Ok(());
    };
    let as_json = arguments.iter().any(|argument| argument == "--json");
    let store = Store::open_read_only(Path::new(file))?;
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
    if !as_json {
        println!(
            "{:40} {:>9} {:>9} {:>7}",
            "question", "p50 ms", "p99 ms", "rows"
        );
    }
    let mut results = Vec::new();
    for question in &QUESTIONS {
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
                rows = (question.ask)(&store, &asked)?;
                Ok(began.elapsed().as_secs_f64() * 1e3)
            })
            .collect::<Result<_, StoreError>>()?;
        times.sort_by(f64::total_cmp);
        let (p50, p99) = (times[TIMES / 2], times[TIMES * 99 / 100]);
        if as_json {
            results.push(format!(
                "{{\"question\": \"{}\", \"p50_ms\": {p50:.4}, \"p99_ms\": {p99:.4}}}",
                question.name
            ));
        } else {
            println!("{:40} {p50:9.3} {p99:9.3} {rows:7}", question.name);
        }
    }
    if as_json {
        println!("[{}]", results.join(",\n "));
    }
    Ok(())
}
