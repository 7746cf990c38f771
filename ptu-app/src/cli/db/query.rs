//! `ptu db query`: runs one SQL query.

use ptu_report::words::{Words, fill};
use std::time::Duration;

use clap::Args;
use fault_db::{MOST_RESULT_BYTES, QueryBounds, QueryLimit, QueryResult, SqlValue, StoreError};
use serde_json::{Map, Value, json};

use super::watch::Watch;
use crate::cli::output::Output;
use crate::cli::{Database, print_json};
use ptu_runs::failure::{Exit, Failure, KeepTrouble};
use ptu_runs::stdio;
use ptu_runs::table::Table;

/// Bytes of a megabyte.
const MEGABYTE: u64 = 1_000_000;

/// Ask the database in SQL, which may only read; `ptu db schema` lists the views
///
/// Examples:
///   ptu db query "SELECT unit, count(*) FROM faults WHERE state = 'open' GROUP BY unit"
///   ptu db query --max-time 600 "SELECT …"    a question that takes long
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct QueryArguments {
    /// The question
    #[arg(value_name = "SELECT …")]
    sql: String,
    /// Stop the question after this time, s
    #[arg(long, value_name = "SECONDS", default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=86_400))]
    max_time: u32,
    /// Memory that a question to a database file may take, MB
    #[arg(long, value_name = "MB", default_value_t = 256, value_parser = clap::value_parser!(u32).range(32..=1_000_000))]
    max_memory: u32,
    /// Temporary disk space that a question to a database file may take, MB
    #[arg(long, value_name = "MB", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    max_disk: u32,
    /// Print at most so many rows, whatever LIMIT says
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    max_rows: u32,
    #[command(flatten)]
    output: Output,
}

impl QueryArguments {
    pub fn query(&self, database: &Database) -> Result<Exit, Failure> {
        let store = database.open_read_only()?;
        let watch = Watch::begin(
            Duration::from_secs(self.max_time.into()),
            u64::from(self.max_disk) * MEGABYTE,
        );
        let bounds = QueryBounds {
            rows: self.max_rows as usize,
            memory_bytes: Some(u64::from(self.max_memory) * MEGABYTE),
            server_ms: Some(self.max_time * 1000),
        };
        let answer = watch.over(|goes_on| store.query_within(&self.sql, bounds, goes_on));
        let answer = answer.map_err(|error| match error {
            StoreError::QueryExceeds(limit) => self.exceeded(limit, watch.stopped_by_disk()),
            other => other.into(),
        })?;
        self.output.save()?;
        if answer.truncated {
            let most = self.max_rows;
            stdio::note(&fill(Words::shown().terminal.first_rows, &[("n", &most)]));
        }
        if self.output.form.is_json() {
            return print_json(&answer);
        }
        let columns = columns(&answer);
        let columns: Vec<_> = columns.iter().map(String::as_str).collect();
        self.output
            .form
            .print_columns(&columns, &rows(&answer, &columns), || table(&answer))
    }
}

impl QueryArguments {
    /// Failure that says which bound the query exceeded, and how to allow more.
    fn exceeded(&self, limit: QueryLimit, disk: bool) -> Failure {
        let Self {
            max_time,
            max_memory,
            max_disk,
            ..
        } = self;
        Failure::usage(match limit {
            QueryLimit::Stopped if disk => KeepTrouble::Disk((*max_disk).into()),
            QueryLimit::Stopped => KeepTrouble::Time((*max_time).into()),
            QueryLimit::Memory => KeepTrouble::Memory((*max_memory).into()),
            QueryLimit::Row => KeepTrouble::Row(MOST_RESULT_BYTES),
        })
    }
}

/// Names of the columns; of columns with one name, the later ones get `_` added.
fn columns(answer: &QueryResult) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for column in &answer.columns {
        let mut name = column.clone();
        while names.contains(&name) {
            name.push('_');
        }
        names.push(name);
    }
    names
}

/// Rows as JSON objects whose keys are the names of the columns.
fn rows(answer: &QueryResult, columns: &[&str]) -> Vec<Value> {
    let row = |row: &Vec<SqlValue>| {
        let cells = columns.iter().zip(row);
        Value::Object(
            cells
                .map(|(name, value)| ((*name).to_owned(), json!(value)))
                .collect::<Map<_, _>>(),
        )
    };
    answer.rows.iter().map(row).collect()
}

fn table(answer: &QueryResult) -> String {
    let headings: Vec<_> = answer.columns.iter().map(String::as_str).collect();
    let is_number =
        |value: Option<&SqlValue>| matches!(value, Some(SqlValue::Integer(_) | SqlValue::Real(_)));
    let numbers = (0..headings.len()).filter(|column| {
        answer
            .rows
            .first()
            .is_some_and(|row| is_number(row.get(*column)))
    });
    let mut table = Table::new(&headings).right(numbers);
    for row in &answer.rows {
        table.row(row.iter().map(|value| match value {
            SqlValue::Null => String::new(),
            SqlValue::Integer(number) => number.to_string(),
            SqlValue::Real(number) => real(*number),
            SqlValue::Text(text) => text.clone(),
        }));
    }
    table.render()
}

/// The number in as few digits as distinguish it from all others; very small and very large numbers have an exponent.
fn real(number: f64) -> String {
    let size = number.abs();
    if size > 0.0 && size.is_finite() && !(1e-5..=1e15).contains(&size) {
        return format!("{number:e}");
    }
    number.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_an_exponent_only_where_they_need_one() {
        for (number, text) in [
            (0.0, "0"),
            (-2.5, "-2.5"),
            (0.1 + 0.2, "0.30000000000000004"),
            (1e15, "1000000000000000"),
            (1e300, "1e300"),
            (-1.25e-7, "-1.25e-7"),
            (0.00001, "0.00001"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(real(number), text);
        }
    }
}
