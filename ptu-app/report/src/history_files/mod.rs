//! The history as Parquet partitions, for DuckDB, Polars and Spark: the documented views, a folder each, a file for each
//! month. A month that has not changed is not written again.
//!
//! ```text
//! DIR/views.sql                        the views for DuckDB
//! DIR/steps/month=2026-03/part.parquet
//! DIR/units/part.parquet
//! ```

mod partition;
mod views;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::Path;

use fault_db::{QueryBounds, QueryResult, SqlValue, Store};
use serde::{Deserialize, Serialize};

use partition::Partition;
use ptu_runs::failure::{Failure, FileTrouble, Why};
use ptu_runs::new_file::kind;
use ptu_runs::whole_file;
use views::{VIEWS, View};

/// File that lists the content of a folder's partitions, so that the next export need not read
/// them.
const KNOWN: &str = "export.json";
/// Name of each partition's file.
const PART: &str = "part.parquet";
/// Folder of the partition of a month.
const MONTH: &str = "month=";
/// Month of a view without rows: its file has the columns alone.
const NO_MONTH: &str = "none";
/// Rows asked for at once.
const ROWS: usize = 50_000;
/// Most months of a view that are read.
const MOST_MONTHS: usize = 10_000;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Exported {
    /// Partitions written.
    pub written: usize,
    /// Partitions that were up to date and stay as they are.
    pub unchanged: usize,
    /// Partitions that have no rows any more.
    pub removed: usize,
}

/// For views whose rows never change: by view and month, the text of `months` for the rows that were exported.
#[derive(Default, Deserialize, PartialEq, Serialize)]
struct Known(BTreeMap<String, BTreeMap<String, String>>);

/// Writes all views below a folder, which is made if need be.
///
/// # Errors
/// The history cannot be read, or the folder not be written.
pub fn export_history(store: &Store, to: &Path) -> Result<Exported, Failure> {
    let cannot = |error: std::io::Error| {
        Failure::usage(FileTrouble::Unwritten(
            to.display().to_string(),
            Why::of(error),
        ))
    };
    std::fs::create_dir_all(to).map_err(cannot)?;
    let mut known: Known = (std::fs::read(to.join(KNOWN)).ok())
        .and_then(|text| serde_json::from_slice(&text).ok())
        .unwrap_or_default();
    let mut done = Exported::default();
    for view in VIEWS {
        let folder = to.join(view.name);
        let months = months(store, view)?;
        let known = known.0.entry(view.name.to_owned()).or_default();
        for (month, rows) in &months {
            let file = match view.time {
                Some(_) => folder.join(format!("{MONTH}{month}")).join(PART),
                None => folder.join(PART),
            };
            if view.is_final && known.get(month) == Some(rows) && file.is_file() {
                done.unchanged += 1;
                continue;
            }
            let bytes = partition(store, view, month)?;
            if std::fs::read(&file).is_ok_and(|there| there == bytes) {
                done.unchanged += 1;
            } else {
                if let Some(folder) = file.parent() {
                    std::fs::create_dir_all(folder).map_err(cannot)?;
                }
                whole_file::write(&file, kind::PARQUET, bytes)?;
                done.written += 1;
            }
            if view.is_final {
                known.insert(month.clone(), rows.clone());
            }
        }
        let there: BTreeSet<_> = months.keys().cloned().collect();
        known.retain(|month, _| there.contains(month));
        done.removed += remove_others(&folder, &there).map_err(cannot)?;
    }
    whole_file::write_text(&to.join("views.sql"), views_sql())?;
    let known = serde_json::to_string_pretty(&known).unwrap_or_default();
    whole_file::write(&to.join(KNOWN), &["{"], known)?;
    Ok(done)
}

/// Months that have rows of a view, each with a text that differs if its rows differ; one month without a name if the view has
/// no time.
fn months(store: &Store, view: &View) -> Result<BTreeMap<String, String>, Failure> {
    let Some(time) = view.time else {
        return Ok(BTreeMap::from([(String::new(), String::new())]));
    };
    let key = view.order.split(',').next().unwrap_or_default();
    let months = format!(
        "SELECT substr({time}, 1, 7), count(*), min({key}), max({key}) FROM {} GROUP BY substr({time}, 1, 7)",
        view.name
    );
    let found = ask(store, &months, MOST_MONTHS)?;
    let row = |row: Vec<SqlValue>| {
        let words: Vec<_> = row.iter().map(word).collect();
        let (month, rows) = words.split_first()?;
        Some((month.clone(), rows.join(" ")))
    };
    let mut months: BTreeMap<_, _> = found.rows.into_iter().filter_map(row).collect();
    if months.is_empty() {
        months.insert(NO_MONTH.to_owned(), String::new());
    }
    Ok(months)
}

fn word(value: &SqlValue) -> String {
    match value {
        SqlValue::Null => String::new(),
        SqlValue::Integer(number) => number.to_string(),
        SqlValue::Real(number) => number.to_string(),
        SqlValue::Text(text) => text.clone(),
    }
}

/// The bytes of a month's file.
fn partition(store: &Store, view: &View, month: &str) -> Result<Vec<u8>, Failure> {
    let of_month = view.time.map_or_else(String::new, |time| {
        format!("WHERE substr({time}, 1, 7) = '{month}'")
    });
    let question = format!(
        "SELECT {} FROM {} {of_month} ORDER BY {}",
        view.columns, view.name, view.order
    );
    let mut file = Partition::begin(view)?;
    let mut from = 0;
    loop {
        let page = format!("{question} LIMIT {ROWS} OFFSET {from}");
        let found = ask(store, &page, ROWS)?;
        from += found.rows.len();
        let is_last = found.rows.len() < ROWS && !found.truncated;
        if found.rows.is_empty() && found.truncated {
            return Err(Failure::bench(FileTrouble::LongRow(view.name.to_owned())));
        }
        file.put(&found.rows)?;
        if is_last {
            return file.finish();
        }
    }
}

fn ask(store: &Store, sql: &str, rows: usize) -> Result<QueryResult, Failure> {
    let bounds = QueryBounds {
        rows,
        ..QueryBounds::default()
    };
    Ok(store.query_within(sql, bounds, || true)?)
}

/// Removes the partitions of months that have no rows any more.
fn remove_others(folder: &Path, months: &BTreeSet<String>) -> std::io::Result<usize> {
    let mut removed = 0;
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        let month = name.to_str().and_then(|name| name.strip_prefix(MONTH));
        if month.is_some_and(|month| !months.contains(month)) {
            let file = entry.path().join(PART);
            if file.is_file() {
                std::fs::remove_file(file)?;
                removed += 1;
            }
            // A folder with other files, which are not ours, stays.
            let _ = std::fs::remove_dir(entry.path());
        }
    }
    Ok(removed)
}

/// SQL that makes the views in DuckDB, started in the folder.
fn views_sql() -> String {
    let mut sql = String::from("-- In this folder: duckdb -init views.sql\n");
    for view in VIEWS {
        let place = match view.time {
            Some(_) => format!("{}/*/{PART}", view.name),
            None => format!("{}/{PART}", view.name),
        };
        let _ = writeln!(
            sql,
            "CREATE VIEW {} AS SELECT {} FROM read_parquet('{place}');",
            view.name, view.columns
        );
    }
    sql
}
